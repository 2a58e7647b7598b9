"""The outcome of a run and warnings of its result, in words; when its frozen equations stop being stable.

The straight beam (of a complete model, the bent one) is stable while its stiffness, with the terms of the base's motion
and of the loads, is positive definite; where loads follow the beam the eigenvalues decide. A disturbance grows by
exp ∫ Re λ dt: a load that acts for a moment does nothing, whatever its size.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.estimate import BENT_FAR, FEW_MODES, ROUGH_MESH, cure_of_theory, percent
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.steady.equilibrium import expanded
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.guards.limits import BOUNDLESS
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.plausibility import bent_far, elastic_bend, of_first_order
from gbeam.mechanics.structure import Structure
from gbeam.numerics.eigen import eigenvalues, growth_rate, stability_margin, symmetric, unsymmetric
from gbeam.results.errors import Errors
from gbeam.results.parts import Base, LoadPeaks, Peaks
from gbeam.results.result import NOT_KNOWN

_BLOCK = 2000  # times whose stiffness is computed together
_STRETCHES, _MOST = 4, 32  # stretches whose growth is computed, and times of each, at most
_SHARE = 0.01  # of the elastic stiffness: a term that takes less of it is no cause
_ROW, _COLUMN = np.tril_indices(3, -1)


class Loss(NamedTuple):
    """A stretch of time, s, in which a disturbance grows by exp(`growth`), and its causes at the start, in words."""

    start: float
    end: float
    growth: float
    flutter: bool
    causes: tuple[str, ...]


class Drive(NamedTuple):
    """Motion of the base (t, 3) and components of the loads (t, loads, 6), or those of one time."""

    a_WO_B: Array
    w_WB_B: Array
    alpha_WB_B: Array
    loads: Array | None = None

    def at(self, times: Any) -> Drive:
        """Base and loads at an index, slice or array of the times."""
        return Drive(*(None if values is None else values[times] for values in self))

    def between(self, before: int, after: int, share: float) -> Drive:
        """Base and loads interpolated a share of the way between two times, given by their indices."""
        ends = zip(self.at(before), self.at(after), strict=True)
        return Drive(*(None if a is None else a + share * (b - a) for a, b in ends))


def worst_loss(structure: Structure, time: Array, base: Base, q: Array) -> Loss | None:
    """Stretch of time in which a disturbance grows most, or None; about q (t, n) of a complete model, of which growth
    that ends within a stretch does not count: there it is on its way to a stable shape.
    """
    c = structure.coefficients
    loads = None if c.loads is None or structure.history is None else structure.history(time)
    drive = Drive(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)

    def matrices(i: int) -> tuple[Array, Array, Array]:
        about = c if structure.linear else expanded(structure, q[i])[0]
        return about.mass, *about.frozen(*drive.at(i))

    def loss(part: Array) -> Loss | None:
        """Loss over a stretch of indices, by growth rates at some of them."""
        some = part[:: -(-len(part) // _MOST)]
        until = np.append(some[1:], min(part[-1] + 1, len(time) - 1))
        rate = np.array([growth_rate(*matrices(i)) for i in some])
        run = np.cumsum(np.diff(rate > 0, prepend=False))  # numbers of runs of growth and of decay
        growth = np.bincount(run, rate * (time[until] - time[some]))
        if not structure.linear:
            growth[: run[-1]] = 0.0
        if not growth.any():
            return None
        worst = np.flatnonzero(run == growth.argmax())
        first = int(some[worst[0]])
        before = int(some[worst[0] - 1]) if worst[0] else max(first - 1, 0)
        margins = stability_margin(*matrices(before)), stability_margin(*matrices(first))
        share = margins[0] / (margins[0] - margins[1]) if margins[0] > 0 > margins[1] else 1.0
        return Loss(
            start=float(time[before] + share * (time[first] - time[before])),
            end=float(time[until[worst[-1]]]),
            growth=float(growth.max()),
            flutter=unsymmetric(matrices(first)[2]),
            causes=_causes(structure, drive.between(before, first, share), matrices(first)),
        )

    if not c.size:
        return None
    doubtful, most = _doubtful(c, drive)
    stretches = np.split(doubtful, np.flatnonzero(np.diff(doubtful) > 1) + 1) if len(doubtful) else []
    stretches.sort(key=lambda part: -most[part].sum())
    losses = [lost for part in stretches[:_STRETCHES] if (lost := loss(part)) is not None]
    return max(losses, key=lambda lost: lost.growth, default=None)


def _doubtful(c: Coefficients, drive: Drive) -> tuple[Array, Array]:
    """Indices of times at which the straight beam may be unstable, and bounds (t,) 1/s of the growth. Eigenvalues are
    computed only where the sum of the terms' bounds reaches the elastic stiffness; loads that follow the beam, which
    these bounds do not cover, make the growth infinite.
    """
    scale = np.linalg.inv(np.linalg.cholesky(c.stiffness))  # by which the elastic stiffness is one
    w, most = drive.w_WB_B, np.zeros(len(drive.w_WB_B))
    terms = [c.k_a, c.k_al, c.k_ww[_ROW, _COLUMN], c.k_ww[range(3), range(3)]]
    sizes = [drive.a_WO_B, drive.alpha_WB_B, 2 * w[:, _ROW] * w[:, _COLUMN], w**2]
    if drive.loads is not None and c.loads is not None:
        slope, values = c.loads.slope[:, :, 6:].reshape(-1, c.size, c.size), drive.loads.reshape(len(w), -1)
        terms.append(-slope)
        sizes.append(values)
        most[np.any(values[:, [unsymmetric(matrix) for matrix in slope]], axis=1)] = np.inf
    size = np.concatenate(sizes, axis=1)
    driven = size.any(axis=0)
    size, term = size[:, driven], symmetric(np.concatenate(terms)[driven])
    share = np.linalg.eigvalsh(scale @ term @ scale.T)
    taken = np.maximum(size, 0) @ np.maximum(-share[:, 0], 0) + np.maximum(-size, 0) @ np.maximum(share[:, -1], 0)
    large = np.flatnonzero((taken >= 1.0) & (most == 0))
    for block in (large[i : i + _BLOCK] for i in range(0, len(large), _BLOCK)):
        most[block] = np.sqrt(np.maximum(-lowest_over_time(c, drive.at(block)), 0))
    return np.flatnonzero(most), most


def lowest_over_time(c: Coefficients, drive: Drive) -> Array:
    """Lowest eigenvalue of K, M-normalised, over time: negative where K is not positive definite, rad²/s²."""
    scale = np.linalg.inv(np.linalg.cholesky(c.mass))
    return np.linalg.eigvalsh(scale @ symmetric(c.frozen(*drive)[1]) @ scale.T)[..., 0]


def _causes(structure: Structure, drive: Drive, matrices: tuple[Array, Array, Array]) -> tuple[str, ...]:
    """Name the terms of base and loads that take stiffness from the fastest growing mode, or feed it."""
    c, (a, w, alpha, loads) = structure.coefficients, drive
    value, modes = eigenvalues(*matrices)
    mode = modes[:, value.real.argmax()]

    def taken(stiffness: Array) -> float:
        """Share of the mode's elastic stiffness that a term takes away, or feeds by asymmetry."""
        share = (mode.conj() @ stiffness @ mode) / (mode.conj() @ c.stiffness @ mode).real
        return float(max(-share.real, abs(share.imag)))

    terms = {
        f"the base turns at {np.linalg.norm(w):.4g} rad/s": np.einsum("i,j,ijnm->nm", w, w, c.k_ww),
        f"its rate changes by {np.linalg.norm(alpha):.4g} rad/s²": symmetric(np.tensordot(alpha, c.k_al, 1)),
        f"the root is pushed with {np.linalg.norm(a):.4g} m/s²": np.tensordot(a, c.k_a, 1),
    }
    if loads is not None and c.loads is not None and structure.work is not None:
        points = np.bincount(structure.work.load)
        for k, (values, slope) in enumerate(zip(loads, c.loads.slope[:, :, 6:], strict=True)):
            force, moment = np.linalg.norm(values[:3]), np.linalg.norm(values[3:])
            size = f"{force:.4g} N" if force > 0 else f"{moment:.4g} N m"
            words = f"beam.loads[{k}] acts with {size}{'/m' if points[k] > 1 else ''}"
            terms[words] = -np.tensordot(values, slope, 1)
    shares = {words: taken(stiffness) for words, stiffness in terms.items()}
    return tuple(words for words, share in shares.items() if share > min(_SHARE, max(shares.values()) / 2))


MANY = 100  # steps between two of the results' times, above which a warning advises another integrator
GROWN = math.log(1e3)  # growth of a crookedness of a thousandth of the beam's length to all of it
NOTICED = math.log(2)  # growth below this is not warned of


def describe(
    structure: Structure,
    stable: bool,
    trajectory: Trajectory,
    base: Base,
    peaks: Peaks,
    time: Floats,
    q: Floats,
) -> tuple[str, str, tuple[str, ...]]:
    """Outcome, message and warnings of a run; base, time (t,) and q (t, n) are at the samples that are kept. It is
    not `stable` that starts from an equilibrium that is not.
    """
    end = trajectory.time[-1]
    if not (trajectory.stopped or trajectory.converged):
        return (
            "not converged",
            f"no acceleration satisfies the equations in the step after t = {end:.4g} s; "
            f'try a smaller response.step, or response.integrator = "generalized-alpha" with rho_inf = 0.8',
            (),
        )
    loss = worst_loss(structure, time, base, q)
    lost, first = "", 0
    if loss is not None:
        first = int(np.searchsorted(time, loss.start))
        state = "equilibrium is not stable" if loss.flutter else "stiffness is not positive definite"
        lost = f"{structure.kind}'s {state} from t = {loss.start:.4g} s, where {' and '.join(loss.causes)}"
    bent = of_first_order(elastic_bend(structure, each_leaf(lambda values: values[first], base)))
    if bent and loss is not None and (trajectory.stopped or loss.growth > GROWN):
        return NOT_KNOWN, f"whether it diverges is not known: {lost}, but {bent}", ()
    particles = structure.field is None  # they have no other model, nor a length that bounds their displacement
    if trajectory.stopped and particles:
        cause = f": {lost}" if lost else "; give a smaller response.step"
        return "diverged", f"the displacement exceeded {BOUNDLESS:.0e} m at t = {end:.4g} s{cause}", ()
    if trajectory.stopped:
        better = "FOAM or exact" if structure.kind == "TLAM" else "exact"
        why = f"use {better}"
        if lost:
            why = f"{lost}: the model is not valid beyond that; {why}"
            if structure.kind != "TLAM":
                why += ", and `gbeam critical-speed` to see whether the exact model loses its equilibrium as well"
        return (
            "diverged",
            f"the displacement exceeded the beam's length, {structure.length:.4g} m, at t = {end:.4g} s; {why}",
            (),
        )
    if loss is not None and loss.growth > GROWN:
        cure = "add a small load across the beam, which decides which way it gives"
        if particles:
            cure = "stiffen the structure, or slow its motion"
        elif structure.linear:
            cure = f"use {'FOAM or ' if structure.kind == 'TLAM' else ''}exact, and {cure}"
        return (
            "diverged",
            f"{lost}, to t = {loss.end:.4g} s: whatever deviates grows more than a thousandfold meanwhile, and no real "
            f"beam stays where this run has it; {cure}",
            (),
        )
    warnings, unknown = [], f"; that is not known, for {bent}" if bent else ""
    if loss is not None and loss.growth > NOTICED:
        warnings.append(
            f"{lost}, to t = {loss.end:.4g} s: whatever deviates grows {math.exp(loss.growth):.2g}-fold meanwhile"
            f"{unknown}"
        )
    elif not stable:
        warnings.append(
            "the run starts from an equilibrium that is not stable, which no beam would keep"
            f"{unknown or '; `gbeam critical-speed` finds where that begins'}"
        )
    warnings += yielding(peaks.loads)
    if particles:
        warnings += bent_far(structure, peaks.max_size / structure.length)
    if particles and peaks.max_size > structure.length:
        warnings.append(
            f"the displacement reaches {peaks.max_size:.4g} m, and no particle rests farther than "
            f"{structure.length:.4g} m from the root: places to second order in the coordinates may not hold so far"
        )
    return "done", "", tuple(warnings)


def inaccuracies(structure: Structure, errors: Errors, settings: ResponseSettings) -> tuple[str, ...]:
    """Warn of estimated errors above the tolerance, with causes and cures, or that no error could be estimated."""
    if not settings.estimate:
        return ()
    if math.isnan(errors.displacement.step):
        return ("no error could be estimated: the run with twice the step fails; give a smaller step",)
    if not (above := errors.above(settings.tolerance)):
        return ()
    name, worst = max(above.items(), key=lambda item: item[1].total)
    cures = {
        "model": 'check with model.kind = "exact"',
        "shapes": "raise model.modes, or leave them out",
        "step": _cure_of_step(settings),
        "beam_theory": f"{errors.causes}; {cure_of_theory(errors.causes)}",
        "mesh": ROUGH_MESH[1],
    }
    names = {"shapes": "too few shapes", "beam_theory": "the theory of slender beams"}
    if structure.richer is not None:
        (names["shapes"], cures["shapes"]), (names["model"], cures["model"]) = FEW_MODES, BENT_FAR
    parts = [(getattr(worst, part), part, cure) for part, cure in cures.items()]
    causes = [
        f"{percent(size)} from {names.get(part, f'the {part}')} ({cure})"
        for size, part, cure in sorted(parts, reverse=True)
        if size > settings.tolerance / 10
    ]
    peaks = [error.peak for error in above.values() if not math.isnan(error.peak)]
    of_peaks = f" at an instant and {percent(max(peaks))} of peaks of loads and stress" if peaks else ""
    return (
        f"the estimated error of the {', of the '.join(above)}, {percent(worst.total)} of the largest"
        f"{f' (of the {name})' if len(above) > 1 else ''}{of_peaks}, is above "
        f"the tolerance {percent(settings.tolerance)}: "
        f"{', '.join(causes)}{f'; {errors.note}' if errors.note else ''}",
    )


def _cure_of_step(settings: ResponseSettings) -> str:
    """Advice against an error of the steps."""
    if settings.step is not None:
        return 'give a smaller step, or "auto"'
    if settings.integrator == "gauss":
        return "vibration too fast for automatic steps: give a smaller step"
    return 'vibration too fast for automatic steps: response.integrator = "gauss" follows it in fewer'


def effort(settings: ResponseSettings, steps: int, finer: int) -> tuple[str, ...]:
    """Advise another integrator if an automatic step is `finer` times finer than the results', and that is many."""
    if settings.step is not None or settings.integrator == "gauss" or finer < MANY:
        return ()
    return (
        f"{settings.integrator} took {steps} steps, {finer} to each of the results: its error, most of it a delay that "
        "grows with every cycle of a lightly damped vibration, falls as the square of the step only; "
        'response.integrator = "gauss" keeps the same accuracy in far fewer',
    )


def yielding(peaks: LoadPeaks | None, of: str = "") -> list[str]:
    """Warn where the stress of a beam exceeds the yield strength."""
    strength = None if peaks is None else peaks.yield_strength
    if peaks is None or strength is None:
        return []
    stress = peaks.stress
    worst = int(np.argmax(stress.value))
    if not stress.value[worst] > strength:
        return []
    return [
        f"the stress reaches {1e-6 * stress.value[worst]:.4g} MPa at {peaks.stations[worst]:.4g} m{of}, t = "
        f"{stress.time[worst]:.4g} s, above the yield strength, {1e-6 * strength:.4g} MPa: the material yields, and "
        "the response, which is elastic, means nothing from there on"
    ]
