"""The outcome of a run and warnings of its result, in words."""

from __future__ import annotations

import math

import numpy as np

from gbeam.analysis.accuracy.estimate import BEYOND, percent
from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.steady.definiteness import Loss, worst_loss
from gbeam.guards.limits import BOUNDLESS
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.results.errors import Errors
from gbeam.results.parts import LoadPeaks, Peaks
from gbeam.results.response import BaseMotion
from gbeam.results.result import Floats

MANY = 100  # steps between two of the results' times, above which a run says why
LABOUR = 50_000  # steps, from which on one that follows the motion alone is worth a thought
STILL = 0.05  # of the elastic forces: less inertia of the modes is that of a motion they do not vibrate in
GROWN = math.log(1e3)  # a crookedness of a thousandth of the beam's length is its length then
NOTICED = math.log(2)  # what grows less has hardly had the time


def describe(
    structure: Structure,
    problem: Problem,
    trajectory: Trajectory,
    base: BaseMotion,
    peaks: Peaks,
    time: Floats,
    q: Floats,
) -> tuple[str, str, tuple[str, ...]]:
    """Outcome, message and warnings of a run; base, time (t,) and q (t, n) are at the samples that are kept."""
    end = trajectory.time[-1]
    if not (trajectory.stopped or trajectory.converged):
        return (
            "not converged",
            f"no acceleration satisfies the equations in the step after t = {end:.4g} s; "
            f'try a smaller response.step, or response.integrator = "generalized-alpha" with rho_inf = 0.8',
            (),
        )
    loss = worst_loss(structure, time, base, q)
    lost = "" if loss is None else _lost(structure, loss)
    particles = structure.field is None  # which have no other model, and no length that bounds how far they move
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
    warnings = []
    if loss is not None and loss.growth > NOTICED:
        warnings.append(
            f"{lost}, to t = {loss.end:.4g} s: whatever deviates grows {math.exp(loss.growth):.2g}-fold meanwhile"
        )
    elif not problem.stable:
        warnings.append(
            "the run starts from an equilibrium that is not stable, which no beam would keep; `gbeam critical-speed` "
            "finds where that begins"
        )
    warnings += yielding(peaks.loads)
    if particles and peaks.max_size > structure.length:
        warnings.append(
            f"the displacement reaches {peaks.max_size:.4g} m, and no particle rests farther than "
            f"{structure.length:.4g} m from the root: places to second order in the coordinates may not hold so far"
        )
    return "done", "", tuple(warnings)


def _lost(structure: Structure, loss: Loss) -> str:
    """Say where a run's stability is lost."""
    what = "equilibrium is not stable" if loss.flutter else "stiffness is not positive definite"
    return f"{structure.kind}'s {what} from t = {loss.start:.4g} s, where {' and '.join(loss.causes)}"


def inaccuracies(structure: Structure, errors: Errors, settings: ResponseSettings) -> tuple[str, ...]:
    """Warn of estimated errors above the tolerance, or of none: causes and cures."""
    if not settings.estimate:
        return ()
    if math.isnan(errors.displacement.step):
        return ("no error could be estimated: the run with twice the step fails; give a smaller step",)
    quantities = {"tip's displacement": errors.displacement, "root's loads": errors.loads}
    above = {name: each for name, each in quantities.items() if each.total > settings.tolerance}
    if not above:
        return ()
    name, worst = max(above.items(), key=lambda item: item[1].total)
    cures = {
        "model": 'check with model.kind = "exact"',
        "shapes": "raise model.modes, or leave them out",
        "step": _cure_of_step(settings),
        "beam_theory": f"{errors.theory}; {BEYOND}",
    }
    names = {"shapes": "too few shapes", "beam_theory": "the theory of slender beams"}
    parts = [(getattr(worst, part), part, cure) for part, cure in cures.items()]
    causes = [
        f"{percent(size)} from {names.get(part, f'the {part}')} ({cure})"
        for size, part, cure in sorted(parts, reverse=True)
        if size > settings.tolerance / 10
    ]
    return (
        f"the estimated error of the {' and of the '.join(above)}, {percent(worst.total)} of the largest"
        f"{f' (of the {name})' if len(above) > 1 else ''}, is above the tolerance {percent(settings.tolerance)}: "
        f"{', '.join(causes)}{f'; {errors.note}' if errors.note else ''}",
    )


def _cure_of_step(settings: ResponseSettings) -> str:
    if settings.step is not None:
        return 'give a smaller step, or "auto"'
    if settings.integrator == "gauss":
        return "vibration too fast for automatic steps: give a smaller step"
    return 'vibration too fast for automatic steps: response.integrator = "gauss" follows it in fewer'


def effort(settings: ResponseSettings, steps: int, finer: int) -> tuple[str, ...]:
    """Advise, of an automatic step so many times finer than the results', an integrator that needs fewer."""
    if settings.step is not None or settings.integrator == "gauss" or finer < MANY:
        return ()
    return (
        f"{settings.integrator} took {steps} steps, {finer} to each of the results: its error, most of it a delay that "
        "grows with every cycle of a lightly damped vibration, falls as the square of the step only; "
        'response.integrator = "gauss" keeps the same accuracy in far fewer',
    )


def stiffness(structure: Structure, settings: ResponseSettings, trajectory: Trajectory) -> tuple[str, ...]:
    """Advise, where an automatic step follows modes that the motion does not excite, a scheme that damps them."""
    steps = len(trajectory.time) - 1
    if settings.step is not None or steps < LABOUR or not structure.linear:
        return ()
    c, n = structure.coefficients, structure.size
    push, pull = (np.abs(each @ part).max() for each, part in (
        (trajectory.qdd[:, -n:], c.mass), (trajectory.q[:, -n:], c.stiffness)))  # fmt: skip
    if not push < STILL * pull:
        return ()
    lowest = float(structure.rest[0][0]) / (2 * np.pi)
    return (
        f"the motion lies far below the lowest frequency, {lowest:.4g} Hz, whose periods {steps} steps divide; "
        'response.integrator = "generalized-alpha" with parameters = { rho_inf = 0 } and a step of the motion\'s own '
        f"time, such as {settings.duration / 1000:.2g} s, damps what is not excited: see the error that it states",
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
