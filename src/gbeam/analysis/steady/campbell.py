"""Campbell diagram: frequencies against hub speed, each mode followed through crossings and veering."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import groupby, pairwise
from typing import Annotated, Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.estimate import LIMIT, error_warning, percent, reference_model, relative_difference
from gbeam.analysis.steady.frequency_errors import RicherModels, doubtful, unknown_errors
from gbeam.analysis.steady.stability import first_lost_speed, turned
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats, Indices, Numbers
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import OfKind, Quantity, Seconds
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.profiles.profile import Profile
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.eigen import mac, matched
from gbeam.progress import Progress, tell
from gbeam.results.errors import PARTS, ErrorEstimate, FrequencyErrors
from gbeam.results.modal import Campbell, Crossing, Unstable

NEARNESS = 0.2  # of a MAC: modes that are alike are told apart by their frequencies
MARGIN = 1e-3  # of a critical speed: so near to it the equilibrium is looked at
ENDS = 14  # halvings of a step in which a stretch of speed ends
CONFIDENT = 0.9  # MAC: a mode less like itself from one speed to the next is looked at in between
SURE = 0.95  # of a critical speed: nearer, a frequency goes to zero and has no relative error
DEPTH = 8  # halvings of a step at most: faster veering looks like a crossing


class _Speed(NamedTuple):
    """Oscillating modes at one speed, rad/s: frequencies, Hz, damping ratios, coordinates (k, n), and M."""

    rate: float
    frequency: Floats
    damping_ratio: Floats
    coordinates: Complex
    mass: Floats
    state: SteadySystem
    modes: Complex
    subject: Subject

    def direction(self, index: Any) -> tuple[str, ...]:
        """Directions in which the modes chosen by an index move most."""
        return self.subject.directions(self.state, self.modes[:, index])


def _likeness(before: _Speed, after: _Speed) -> tuple[Floats, Floats]:
    """MACs (k, l) of modes at two speeds, and scores of the pairs: the MACs, less a penalty for frequencies that differ
    by more than the speeds.

    A whirl may have changed its sense in between: then the conjugate mode is like the one before.
    """
    scores, macs = [], []
    step = abs(after.rate - before.rate) / (2 * np.pi) or 1.0
    for coordinates, frequency in ((after.coordinates, after.frequency), (after.coordinates.conj(), -after.frequency)):
        difference = np.abs(before.frequency[:, None] - frequency) / step
        macs.append(mac(before.coordinates, coordinates, after.mass))
        scores.append(macs[-1] - NEARNESS * difference / (1 + difference))
    return np.where(scores[0] >= scores[1], *macs), np.maximum(*scores)


def _paired(before: _Speed, after: _Speed) -> tuple[np.ndarray, Floats]:
    """For each mode of `before` the index of the most similar one of `after`, or −1 if none is left, and their MAC."""
    macs, scores = _likeness(before, after)
    match, value = matched(scores)[0], np.full(len(scores), np.nan)
    value[match >= 0] = macs[match >= 0, match[match >= 0]]
    return match, value


def _fill(modes_at: Callable[[float], _Speed], low: _Speed, high: _Speed, count: int, depth: int) -> list[_Speed]:
    """Modes at speeds between two, by halving until the first `count` are recognised from each to the next."""
    _, alike = _paired(low, high)
    if depth == 0 or np.nanmin(alike[:count], initial=1.0) > CONFIDENT:
        return []
    middle = modes_at((low.rate + high.rate) / 2)
    return [*_fill(modes_at, low, middle, count, depth - 1), middle, *_fill(modes_at, middle, high, count, depth - 1)]


def _tracked(speeds: Sequence[_Speed], followed: int) -> tuple[Floats, list[np.ndarray]]:
    """Follow the first modes from speed to speed: frequency, damping ratio and MAC, (3, v, k), and their numbers at
    each speed, −1 where none resembles them.

    A mode that has ceased to oscillate goes on with one that begins to.
    """
    values, track = np.full((3, len(speeds), followed), np.nan), np.arange(followed)
    values[2, 0], index = 1.0, [track]
    for before, after in pairwise(speeds):
        match, likeness = _paired(before, after)
        values[2, len(index)] = np.where(track >= 0, likeness[track], np.nan)
        track = np.where(track >= 0, match[track], -1)
        ended, begun = np.flatnonzero(track < 0), np.setdiff1d(np.arange(len(after.frequency)), match)
        count = min(len(ended), len(begun))
        track[ended[:count]] = begun[:count]
        index.append(track)
    for value, speed, track in zip(np.swapaxes(values, 0, 1), speeds, index, strict=True):
        valid = track >= 0
        value[:2, valid] = speed.frequency[track[valid]], speed.damping_ratio[track[valid]]
    return values, index


@typed
def campbell(
    structure: Structure | System,
    motion: Motion | None = None,
    *,
    turning: str | None = None,
    speeds: Annotated[Numbers | None, OfKind("angular rate")] = None,
    start: Annotated[float, Quantity("angular rate")] = 0.0,
    end: Annotated[float, Quantity("angular rate")] | None = None,
    count: int = 60,
    modes: int = 8,
    orders: Sequence[int] | Indices = (1, 2, 3, 4),
    time: Seconds = 0.0,
    name: str = "",
    progress: Progress = None,
) -> Campbell:
    """Frequencies about the relative equilibrium against the speed of a hub, or of a system's joint that turns.

    Parameters
    ----------
    structure : Structure or System
    motion : Hub, optional
        Its own rate or torque is not used; a free hub turns with the beam. A system needs none where one of its joints
        turns.
    turning : str, optional
        Of a system: the joint's angle that turns, ``joint.angle``; without a hub by default the only prescribed one,
        or the only one. An angle that is not prescribed turns with the bodies, as a free hub does.
    speeds : (v,), optional
        Rates of the hub to begin with, ascending, rad/s; in their place `start`, `end` and `count`.
    start, end : float
        Range of the hub's rate, rad/s; the end by default the largest rate of the motion.
    count : int
        Number of intervals; the steps are halved where a mode is hard to recognise.
    modes : int
        How many to follow, the lowest at the start.
    orders : sequence of int
        Engine orders: a crossing is where frequency = order × speed.
    time : float
        Of a system: when its loads and other joints are frozen, s.
    name : str
        For the result.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    Campbell
        Up to the critical speed, if there is one in the range and no speed beyond it is stable; else beyond it, with
        the stretches of speed that are not.

    Raises
    ------
    InputError
        If the motion has no hub, the range is empty, no mode is to be followed, or the equations of a system change as
        it turns: gravity across the axis, or a rotor that is not alike about its axis on a tower that gives way.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> hub = gb.Hub(radius=0.5)
    >>> diagram = gb.campbell(structure, hub, end=20.0, count=10, modes=2)
    >>> print(diagram.frequency[[0, -1]].round(2))
    [[ 36.56 182.63]
     [ 37.08 182.7 ]]
    """
    instead = "ask `gbeam modes` for its frequencies at a time"
    subject = subject_of(structure, motion)
    system = subject.system
    path, history = turned(subject, turning, time, "a Campbell diagram", instead, name)
    if speeds is None:
        speeds = np.linspace(start, _largest(history) if end is None else end, count + 1)
    grid = np.asarray(speeds, dtype=float)
    start, end = float(grid[0]), float(grid[-1])
    if grid.ndim != 1 or len(grid) < 2 or not start >= 0 or not (np.diff(grid) > 0).all():
        raise InputError("to", f"is {end:g} rad/s, from {start:g} rad/s", "give a range of speeds that ascends from 0")
    if modes < 1:
        raise InputError("modes", f"is {modes}", "give 1 or more")
    loss = first_lost_speed(subject, replace(path, held=True), end, progress)  # which knows the states

    @cache
    def point_at(rate: float) -> SteadySystem:
        return path(system, rate)

    @cache
    def growth_at(rate: float) -> float:
        """Rate of growth, 1/s, or NaN without an equilibrium, zero of one that is stable."""
        try:
            return float(point_at(rate).moving.growing.real.max(initial=0.0))
        except (ComputationError, np.linalg.LinAlgError):
            return math.nan

    decided = loss.outcome == "done"
    limit = loss.value if decided else loss.searched_to
    critical = limit if limit is not None and limit > start else math.inf
    faster = grid[grid > critical]
    path.prepare(system, faster.tolist())
    # Short of a critical speed, where a frequency is zero, unless a speed beyond it is known and stable.
    ends = len(faster) > 0 and (not decided or all(growth_at(rate) != 0.0 for rate in faster.tolist()))
    last = start + (critical - start) * (1 - 1e-6) if ends else end

    @cache  # crossings ask again for speeds beside them
    def modes_at(rate: float) -> _Speed:
        tell(progress, f"frequencies at {rate:.4g} rad/s", (rate - start) / (end - start))
        state = point_at(rate)
        vibrations = state.moving.oscillating(slice(subject.resolved))
        damping, modes = -vibrations.value.real / vibrations.frequency, vibrations.modes
        frequency = vibrations.frequency / (2 * np.pi)
        return _Speed(rate, frequency, damping, modes.T, state.linear.mass, state, modes, subject)

    rates = start + (grid - start) * (last - start) / (end - start)
    if critical < last:
        rates = np.sort(np.append(rates, critical * (1 + MARGIN * np.array([-1.0, 1.0]))))
    path.prepare(system, rates.tolist())
    coarse = [modes_at(rate) for rate in rates.tolist() if not math.isnan(growth_at(rate))]
    kept = min(modes, len(coarse[0].frequency))
    if not kept:
        held = "; ".join(loss.warnings) or "ask `gbeam modes` what holds or damps it"
        raise InputError("modes", f"have nothing to follow: nothing oscillates at {start:g} rad/s", held)
    followed = coarse[:1]
    for low, high in pairwise(coarse):
        followed += [*_fill(modes_at, low, high, kept, DEPTH), high]
    (frequency, damping, alike), index = _tracked(followed, kept)
    unstable = _stretches(np.union1d(rates, [speed.rate for speed in followed]).tolist(), growth_at)
    rates = np.array([speed.rate for speed in followed])
    met = [
        crossing
        for k in range(kept)
        for order in orders
        for crossing in _crossings(modes_at, followed, index, rates, frequency[:, k], k, order)
    ]
    crossings, errors = [crossing for crossing, _, _ in met], unknown_errors(system, kept)
    if judged_bodies(system):
        sound = np.flatnonzero(np.abs(rates / critical - 1) > 1 - SURE).tolist() or [0]
        richer = RicherModels(followed[sound[-1]].state)
        chosen = sorted({sound[0], sound[(len(sound) - 1) // 2], sound[-1]})
        judged = [_errors(richer, followed[i].state, followed[i], index[i]) for i in chosen]
        parts: dict[str, Any] = {part: np.fmax.reduce([e.parts[part] for e in judged]) for part in PARTS}
        errors = replace(judged[0], **parts, theory=judged[-1].theory, growth=max(e.growth for e in judged))
        crossings = [
            replace(crossing, errors=crossing_errors(crossing, mode, slope, richer, point_at))
            for crossing, mode, slope in met
        ]
    fast = subject.unstiffened and subject.base(point_at(last))  # where the missing stiffness is largest
    doubts = subject.doubts(name, fast or None) if subject.body else loss.warnings
    warnings = doubts + (() if errors is None else doubtful(errors))
    warnings += doubtful_crossings(crossings, "" if errors is None else errors.theory)
    added = len(coarse[-1].frequency) - len(coarse[0].frequency)
    if added > 0:
        begun = "a motion begins" if added == 1 else f"{added} motions begin"
        warnings += (f"{begun} to oscillate as it turns faster, and is not followed from {start:g} rad/s: begin later",)
    if loss.message:
        warnings += (loss.message,)
    if loss.value is not None:
        warnings += tuple(warning for warning in loss.warnings if warning not in warnings)
    return Campbell(
        motion=name,
        model=subject.kind,
        speed=rates,
        frequency=frequency,
        damping_ratio=damping,
        mac=alike,
        direction=coarse[0].direction(slice(kept)),
        orders=tuple(orders),
        crossings=tuple(sorted(crossings, key=lambda crossing: crossing.speed)),
        critical=loss if loss.value is not None else None,
        unstable=unstable,
        **_framed(followed, index),
        errors=errors,
        warnings=warnings,
        notes=notes_on({name: motion}),
    )


def _stretches(rates: Sequence[float], growth_at: Callable[[float], float]) -> tuple[Unstable, ...]:
    """Stretches of ascending speeds, rad/s, where something grows or there is no equilibrium, with ends by halving."""

    def end(low: float, high: float) -> float:
        """Speed between two at which stability begins or ends."""
        stable = growth_at(low) == 0.0
        for _ in range(ENDS):
            middle = (low + high) / 2
            low, high = (middle, high) if (growth_at(middle) == 0.0) == stable else (low, middle)
        return (low + high) / 2

    stretches = []
    for stable, group in groupby(range(len(rates)), key=lambda i: growth_at(rates[i]) == 0.0):
        if not stable:
            indices = [*group]
            first, last = indices[0], indices[-1]
            start = rates[0] if first == 0 else end(rates[first - 1], rates[first])
            stop = rates[-1] if last == len(rates) - 1 else end(rates[last], rates[last + 1])
            growth = np.array([growth_at(rates[i]) for i in range(first, last + 1)])
            stretches.append(Unstable(start, stop, float(np.fmax.reduce(growth))))
    return tuple(stretches)


def _framed(speeds: Sequence[_Speed], index: Sequence[np.ndarray]) -> dict[str, Any]:
    """Fields that say in which frame the followed frequencies are, with those in the ground frame where any is known.

    They are empty for frequencies in the ground frame.
    """
    whirl, in_ground = speeds[-1].state.whirl, np.full((len(speeds), len(index[0])), np.nan)
    if whirl is None or not whirl.turning:
        return {}
    if np.isfinite(whirl.in_ground(speeds[-1].frequency, speeds[-1].modes)).any():
        for row, speed, track in zip(in_ground, speeds, index, strict=True):
            modes, frequency, whirl = speed.modes[:, track], speed.frequency[track], speed.state.whirl
            values = frequency if whirl is None else whirl.in_ground(frequency, modes)
            row[:] = np.where(track >= 0, values, np.nan)
    is_known = np.isfinite(in_ground).any()
    return {"frame": "turning", "ground_frequency": in_ground if is_known else np.zeros((0, 0))}


def _errors(richer: RicherModels, point: Any, speed: _Speed, track: np.ndarray) -> FrequencyErrors:
    """Errors of the followed modes at one speed, by their indices `track`, or NaN if they no longer oscillate."""
    oscillating = track >= 0
    chosen = track[oscillating]
    value = 2j * np.pi * speed.frequency[chosen]
    errors = richer.errors(point, value, speed.coordinates[chosen])
    table = np.full((len(PARTS), len(track)), np.nan)
    table[:, oscillating] = [*errors.parts.values()]
    parts: dict[str, Any] = dict(zip(PARTS, table, strict=True))
    return replace(errors, **parts)


def _crossings(
    modes_at: Callable[[float], _Speed],
    speeds: list[_Speed],
    index: list[np.ndarray],
    rates: Floats,
    frequency: Floats,
    track: int,
    order: int,
) -> list[tuple[Crossing, Complex, float]]:
    """Crossings of a followed mode with an engine order, each with the mode (n,) and its frequency's slope there."""
    from scipy.optimize import brentq

    gap = frequency - order * rates / (2 * np.pi)
    crossings = []
    for i in np.flatnonzero((gap[:-1] > 0) & (gap[1:] <= 0) | (gap[:-1] < 0) & (gap[1:] >= 0)):
        k = [index[i][track]]
        mode = speeds[i]._replace(coordinates=speeds[i].coordinates[k], frequency=speeds[i].frequency[k])

        def difference(rate: float, mode: _Speed = mode) -> float:
            """Frequency of the mode most like this one, minus that of the order, Hz."""
            speed = modes_at(rate)
            like = int(_likeness(mode, speed)[1].argmax())
            return float(speed.frequency[like] - order * rate / (2 * np.pi))

        ends = difference(rates[i]), difference(rates[i + 1])
        if ends[0] * ends[1] <= 0:
            rate = brentq(difference, float(rates[i]), float(rates[i + 1]), xtol=1e-10, maxiter=200)
        else:  # the mode veers within the step: interpolate the curve
            rate = rates[i] - gap[i] * (rates[i + 1] - rates[i]) / (gap[i + 1] - gap[i])
        speed = modes_at(rate)
        like = int(_likeness(mode, speed)[1].argmax())
        crossing = Crossing(track, order, float(rate), order * float(rate) / (2 * np.pi), speed.direction([like])[0])
        slope = 2 * np.pi * (frequency[i + 1] - frequency[i]) / (rates[i + 1] - rates[i])
        crossings.append((crossing, speed.coordinates[like], float(slope)))
    return crossings


def crossing_errors(
    crossing: Crossing, mode: Complex, slope: float, richer: RicherModels, point_at: Callable[[float], Any]
) -> ErrorEstimate:
    """Errors of a crossing's speed, from the speeds at which richer models' modes most like `mode` (n,) meet the same
    order.

    They are infinite if the modes do not meet it nearby.
    """
    speed, order = crossing.speed, crossing.order

    def gaps(rate: float) -> list[float]:
        """Frequency minus order × rate, rad/s: of this model with more shapes, the exact one, and a coarser mesh."""
        return [float(frequency[0]) - order * rate for frequency in richer.references(point_at(rate), mode[None])[:3]]

    first = gaps(speed)

    def root(index: int) -> float:
        """Speed of the crossing in a model: a Newton step with the judged slope and, if long, a secant step."""
        newton = speed - first[index] / (slope - order)
        if not 0 < newton < math.inf or abs(newton / speed - 1) < LIMIT:
            return newton if newton > 0 else math.inf
        try:
            second = gaps(newton)[index]
        except ComputationError:
            return math.inf
        secant = newton - second * (newton - speed) / (second - first[index])
        return secant if 0 < secant < math.inf else math.inf

    exact = root(1)
    same = exact if richer.same is richer.exact else root(0)
    model = richer.model_share(relative_difference(same, exact))
    estimate = ErrorEstimate(0.0, relative_difference(speed, same), model, total=relative_difference(speed, exact))
    share = float(richer.theory_errors(point_at(speed), mode[None]).shares[0])
    mesh = math.nan if richer.rough is None else relative_difference(root(2), speed)
    return estimate.adding(beam_theory=share * order / abs(slope - order), mesh=mesh)


def doubtful_crossings(crossings: Sequence[Crossing], theory: str) -> tuple[str, ...]:
    """Warn of crossings whose speeds are wrong by more than 1 %."""
    doubtful = [crossing for crossing in crossings if crossing.errors.total > LIMIT]
    if not doubtful:
        return ()
    largest = max(doubtful, key=lambda crossing: crossing.errors.total)
    where = f"mode {largest.track + 1} meets {largest.order} × speed"
    if len(doubtful) > 1:
        where += f", and {len(doubtful) - 1} more where modes meet multiples,"
    if math.isinf(largest.errors.total):
        whose = reference_model(largest.errors)
        return (f"the speed at which {where} is {'not' if len(doubtful) == 1 else 'in part not'} one of {whose}'s",)
    size = percent(largest.errors.total) + (" at most" if len(doubtful) > 1 else "")
    return (error_warning(f"the speed at which {where}", size, largest.errors, theory),)


_SAMPLES = 501


def _largest(rate: Profile | None) -> float:
    """Largest absolute value of a rate's history, rad/s; InputError without one."""
    if rate is None:
        raise InputError("to", "is missing, and no rate is prescribed", "give the largest speed, such as 60 rpm")
    ends = np.append(np.asarray(rate.breaks), 0.0)
    return float(np.abs(np.asarray(rate(np.linspace(ends.min(), ends.max(), _SAMPLES)))).max())
