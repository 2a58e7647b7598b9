"""A flight's load as a machine makes it: its peaks, the stretches not followed, and loads beyond it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.constants import ToleranceOf
from gbeam.guards.checks import choice, positive
from gbeam.motion.rigid import shift_base
from gbeam.numerics.samples import separate_peaks, true_runs
from gbeam.results.accounting import TOLERANCE_OF, Accounting, LoadPeak, NotFollowed, Overload, PeakPair
from gbeam.results.machine import Imitated, used_up
from gbeam.results.parts import Base

_DIP = 0.9  # of the lower of two maxima: a load that falls further between them makes them two peaks
_SLACK = 1e-9  # of idle: a load held at it is not above it
_NAMED = 2  # limits named at most
_MARGIN_TIME = 0.25  # s around a stretch in which a limit may be used up because of it
_CORNER, _BELOW = "corner", "below idle"
_NAMES = (_CORNER, _BELOW, "gimbals", "left out")

Codes = Indices


@dataclass(frozen=True)
class History:
    """Loads (t, 3) m/s² of an environment on a rigid specimen: `load` at the control point, in flight at the root.

    The load at the `root` and its gradient `growth` (t, 3, 3) 1/s² give the loads at the other `ends` (p, 3) m.
    """

    load: Floats
    root: Floats
    growth: Floats
    ends: Floats

    @property
    def size(self) -> Floats:
        """Size of the load, (t,) m/s²."""
        return np.asarray(np.linalg.norm(self.load, axis=1))

    def spread(self, i: int) -> tuple[float, float]:
        """Relative differences of the load's size, at sample i, from that at the control point: at the root, and at the
        end where it differs most. They are NaN without load.
        """
        control, root = float(np.linalg.norm(self.load[i])), float(np.linalg.norm(self.root[i]))
        if not control > 0:
            return np.nan, np.nan
        ends = np.linalg.norm(self.root[i] + self.ends @ self.growth[i].T, axis=1) / control - 1
        return root / control - 1, float(ends[np.abs(ends).argmax()])


def judge(
    run: Imitated,
    span: tuple[float, float],
    ends: Mapping[str, Floats],
    *,
    tolerance: float,
    tolerance_of: ToleranceOf,
) -> tuple[Accounting, PeakPair]:
    """Account for a flight on a machine over a `span` of the flight's times, s, and compare the largest loads.

    These are the largest at the `ends` of a specimen, on the machine over all of its run, or NaN without ends.
    """
    positive("tolerance", tolerance, "of the flight's load")
    choice("tolerance_of", tolerance_of, TOLERANCE_OF)
    during = slice(*np.searchsorted(run.time, (span[0], np.nextafter(span[1], np.inf))))
    flown, machine = _part(run.flight, during), _part(run.machine, during)
    largest = PeakPair()
    if ends:
        largest = largest_pair(largest_load(run.time[during], flown, ends), largest_load(run.time, run.machine, ends))
    span = max(span[0], float(run.time[0])), min(span[1], float(run.time[-1]))
    axes, time, places = run.axes, run.time[during], far_ends(ends)
    load = machine.a_WO_B if axes is None else axes.actual[during]
    histories = (
        History(flown.a_WO_B, flown.a_WO_B, gradients(flown.w_WB_B, flown.alpha_WB_B), places),
        History(load, machine.a_WO_B, gradients(machine.w_WB_B, machine.alpha_WB_B), places),
    )
    if axes is None:
        return account(time, *histories, span=span, tolerance=tolerance, tolerance_of=tolerance_of), largest
    accounting = account(
        time,
        *histories,
        span=span,
        tolerance=tolerance,
        tolerance_of=tolerance_of,
        idle=axes.idle,
        target=axes.reference[during],
        episodes=axes.episodes,
        shares={name: share[during] for name, share in axes.limit_shares.items()},
    )
    return accounting, largest


def _part(base: Base, during: slice) -> Base:
    """Part of a base's motion over time."""
    return Base(base.a_WO_B[during], base.w_WB_B[during], base.alpha_WB_B[during])


def account(
    time: Floats,
    flight: History,
    machine: History,
    *,
    tolerance: float,
    tolerance_of: ToleranceOf = "peak",
    idle: float = 0.0,
    target: Floats | None = None,
    episodes: tuple[tuple[float, float, str], ...] = (),
    shares: Mapping[str, Floats] | None = None,
    span: tuple[float, float] | None = None,
) -> Accounting:
    """Account for a flight's load over times (t,): its peaks, the stretches in which the machine does not follow, and
    loads beyond the flight's.

    The machine does not follow where its load differs by more than the tolerance. The reasons come from its `episodes`
    and from the `shares` of its limits that are used. The account lasts from the first time to the last, or over a
    `span` that ends nearby, s.
    """
    size, machine_size = flight.size, machine.size
    instant = tolerance_of == "instant"
    slack = _SLACK * float(size.max())
    allowed = np.maximum(tolerance * size, slack) if instant else np.full(len(time), tolerance * float(size.max()))
    above_idle = idle * (1 + _SLACK)
    begin, end = (float(time[0]), float(time[-1])) if span is None else span
    edges = np.concatenate([[begin], (time[1:] + time[:-1]) / 2, [end]])
    low = (size < above_idle) & (idle > 0)
    limits = {} if shares is None else shares
    missed = _distance(machine.load, flight.load) > allowed
    is_held = np.zeros(len(time), bool) if target is None else _distance(target, flight.load) > allowed
    reasons = _reasons(time, low, is_held, episodes)
    for run in true_runs(missed & ~low):  # a stretch without a break has one reason
        kinds, counts = np.unique(reasons[run], return_counts=True)
        reasons[run] = kinds[counts.argmax()]
    stretches = tuple(
        NotFollowed(
            float(edges[run.start]),
            float(edges[run.stop]),
            _named(_NAMES[reasons[run.start]], limits, _widened(time, run)),
            float(size[run].max()),
        )
        for run in _runs(np.where(missed, reasons, -1))
    )
    duration = end - begin
    lost_time = sum(stretch.end - stretch.start for stretch in stretches)
    floor = max(above_idle, slack)
    needed = np.maximum(size, idle)  # a machine cannot make less than idle
    upper_limit = needed + (tolerance * needed if instant else allowed)
    return Accounting(
        tolerance=tolerance,
        tolerance_of=tolerance_of,
        allowed=float(allowed.max()),
        idle=idle,
        span=(begin, end),
        followed_share=1 - lost_time / duration if duration > 0 else float(not missed.any()),
        peaks=tuple(
            _peak(time, flight, machine, top, basin, tolerance, _NAMES[reasons[top]], limits)
            for top, basin in separate_peaks(size, floor, _DIP)
        ),
        not_followed=stretches,
        overloads=tuple(_overloads(edges, time, size, machine_size, upper_limit)),
    )


def _distance(load: Floats, other: Floats) -> Floats:
    """Sizes (t,) of the difference of two loads (t, 3)."""
    return np.asarray(np.linalg.norm(load - other, axis=1))


def _reasons(time: Floats, is_low: Flags, is_held: Flags, episodes: tuple[tuple[float, float, str], ...]) -> Codes:
    """Codes (t,) of the reason for which the load is not followed at each time, if it is not: indices of `_NAMES`."""
    codes = np.full(len(time), _NAMES.index(_CORNER))
    for start, end, why in episodes:
        inside = (time >= start) & (time <= end)
        if why == _BELOW:  # a load above idle that the target holds is left out, not below idle
            codes[inside & is_held] = _NAMES.index("left out")
        else:
            codes[inside] = _NAMES.index(why)
    codes[is_low] = _NAMES.index(_BELOW)
    return codes


def _runs(codes: Codes) -> Iterator[slice]:
    """Yield the runs of equal codes, but for negative ones."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(codes)) + 1, [len(codes)]])
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if codes[start] >= 0:
            yield slice(start, stop)


def _widened(time: Floats, run: slice) -> slice:
    """Extend a run of samples to those up to `_MARGIN_TIME` before and after it."""
    first, last = time[run.start] - _MARGIN_TIME, time[run.stop - 1] + _MARGIN_TIME
    return slice(int(np.searchsorted(time, first)), int(np.searchsorted(time, last, side="right")))


def _named(reason: str, shares: Mapping[str, Floats], window: slice) -> str:
    """The reason in words: for a corner the limits used up around it, those for the longest time first."""
    if reason != _CORNER:
        return reason
    return ", ".join(used_up(shares, window)[:_NAMED]) or _CORNER


def _peak(
    time: Floats,
    flight: History,
    machine: History,
    top: int,
    basin: slice,
    tolerance: float,
    reason: str,
    shares: Mapping[str, Floats],
) -> LoadPeak:
    """Compare the flight's peak at sample `top`, in the samples `basin`, with the machine's largest load near it."""
    size, machine_size = flight.size[basin], machine.size[basin]
    peak = top - basin.start
    (stretch,) = (run for run in true_runs(size >= _DIP * size[peak]) if run.start <= peak < run.stop)
    i = stretch.start + int(np.argmax(machine_size[stretch]))
    load, reproduced = float(size[peak]), float(machine_size[i])
    # Sizes at the times of either peak, directions at that of the machine's.
    aim = flight.load[basin.start + i] * (load / size[i])
    error = float(np.linalg.norm(machine.load[basin.start + i] - aim)) / load
    return LoadPeak(
        time=float(time[top]),
        load=load,
        time_machine=float(time[basin.start + i]),
        reproduced=reproduced,
        error=error,
        spread=machine.spread(basin.start + i),
        spread_flight=flight.spread(top),
        reason=_named(reason, shares, basin) if error > tolerance else "",
        instant_error=float(np.linalg.norm(machine.load[top] - flight.load[top])) / load,
    )


def _overloads(
    edges: Floats, time: Floats, size: Floats, machine_size: Floats, upper_limit: Floats
) -> Iterator[Overload]:
    """Yield the stretches in which the machine's load exceeds `upper_limit` (t,), each with its largest excess."""
    for run in true_runs(machine_size > upper_limit):
        i = run.start + int(np.argmax((machine_size - upper_limit)[run]))
        ends = float(edges[run.start]), float(edges[run.stop])
        yield Overload(*ends, float(time[i]), float(machine_size[i]), float(size[i]))


_ALIKE = 1e-9  # of the load: points whose loads differ by less have the same

Largest = tuple[float, float, str]  # m/s², s, place; "" if every point has the same load


def far_ends(ends: Mapping[str, Floats]) -> Floats:
    """Places (p, 3) m of the ends of a specimen other than "the root"; one of NaN if there is no other."""
    places = np.array([place for name, place in ends.items() if name != "the root"]).reshape(-1, 3)
    return places if len(places) else np.full((1, 3), np.nan)


def largest_load(time: Floats, base: Any, points: Mapping[str, Floats], origin: float = 0.0) -> Largest:
    """Largest size of a base's load over time (t,) at points from the root, whose x is `origin`, m, in the base."""
    away = np.array([-origin, 0.0, 0.0])
    loads = np.array([np.linalg.norm(shift_base(base, place + away).a_WO_B, axis=-1) for place in points.values()])
    place, i = np.unravel_index(int(np.argmax(loads)), loads.shape)
    same_everywhere = np.ptp(loads[:, i]) <= _ALIKE * loads[place, i]
    return float(loads[place, i]), float(time[i]), "" if same_everywhere else list(points)[place]


def largest_pair(flight: Largest, machine: Largest) -> PeakPair:
    """Pair of the largest loads in flight and on the machine."""
    return PeakPair(flight[0], machine[0], flight[1], machine[1], flight[2], machine[2])


def gradients(w_WB_B: Any, alpha_WB_B: Any) -> Any:
    """Gradient G (..., 3, 3) 1/s² of the acceleration of a rigid body: a(r) = a(0) + G r, G = α× + ω× ω×.

    Its first column is 2020 (4).
    """
    xp = namespace(w_WB_B, alpha_WB_B)
    (wx, wy, wz), (alx, aly, alz) = (xp.moveaxis(vector, -1, 0) for vector in (w_WB_B, alpha_WB_B))
    along_x = xp.stack([-(wy**2 + wz**2), wx * wy + alz, wx * wz - aly], axis=-1)
    along_y = xp.stack([wx * wy - alz, -(wz**2 + wx**2), wy * wz + alx], axis=-1)
    along_z = xp.stack([wx * wz + aly, wy * wz - alx, -(wx**2 + wy**2)], axis=-1)
    return xp.stack([along_x, along_y, along_z], axis=-1)
