"""How a run ended, and what to beware of in its result, in words."""

from __future__ import annotations

import math

import numpy as np

from gbeam.analysis.equilibrium.definiteness import first_loss
from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.integrate.trajectory import Trajectory
from gbeam.mechanics.fields.exact import ExactField
from gbeam.mechanics.fields.rooted import RootedField
from gbeam.mechanics.structure import Structure
from gbeam.results.parts.errors import Errors
from gbeam.results.parts.peaks import Peaks
from gbeam.results.response import BaseMotion
from gbeam.results.result import Floats

MANY = 100  # steps between two of the results' times, above which a run says why
_NEAR = np.radians(160.0)  # of the pole at 180 degrees


def describe(
    structure: Structure,
    problem: Problem,
    trajectory: Trajectory,
    base: BaseMotion,
    peaks: Peaks,
    time: Floats,
    q: Floats,
) -> tuple[str, str, tuple[str, ...]]:
    """Outcome, message and warnings of a run.

    Parameters
    ----------
    trajectory : Trajectory
        Every step computed; `base`, at times `time` (t,) s, and the beam's coordinates `q` (t, n) are at those kept.
    """
    loss = first_loss(structure.coefficients, time, base) if structure.linear else None
    lost = (
        ""
        if loss is None
        else f"{structure.kind}'s stiffness is not positive definite from t = {loss[0]:.4g} s, where the base turns at "
        f"{loss[1]:.4g} rad/s"
    )
    warnings = []
    end = trajectory.time[-1]
    if trajectory.stopped:
        better = "FOAM or exact" if structure.kind == "TLAM" else "exact"
        why = f"use {better}"
        if lost:
            why = f"{lost}: the model is not valid beyond that speed; {why}"
            if structure.kind != "TLAM":
                why += ", and `gbeam critical-speed` to see whether the exact model loses its equilibrium as well"
        return (
            "diverged",
            f"the displacement exceeded the beam's length, {structure.length:.4g} m, at t = {end:.4g} s; {why}",
            (),
        )
    if not trajectory.converged:
        return (
            "not converged",
            f"no acceleration satisfies the equations in the step after t = {end:.4g} s; "
            f'try a smaller response.step, or response.integrator = "generalized-alpha" with rho_inf = 0.8',
            (),
        )
    if lost:
        warnings.append(f"{lost}; the result beyond is not to be trusted")
    elif not problem.stable:
        warnings.append(
            "the run starts from an equilibrium that is not stable, which no beam would keep; `gbeam critical-speed` "
            "finds where that begins"
        )
    warnings += _yielding(structure, peaks)
    if (turned := turned_out_of_plane(structure, q)) > _NEAR:
        warnings.append(
            f"the beam's tangent turns by {np.degrees(turned):.0f}° out of one plane: straight back, at 180°, its "
            "rotation vector has a pole, and near it the shapes converge slowly; check with more of them"
        )
    return "done", "", tuple(warnings)


def inaccuracies(structure: Structure, errors: Errors, settings: ResponseSettings) -> tuple[str, ...]:
    """What to say where the estimated errors are above the tolerance, or where there are none: causes and cures."""
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
    }
    parts = [(getattr(worst, part), part, cure) for part, cure in cures.items()]
    causes = [
        f"{_percent(size)} from {'too few shapes' if part == 'shapes' else f'the {part}'} ({cure})"
        for size, part, cure in sorted(parts, reverse=True)
        if size > settings.tolerance / 10
    ]
    return (
        f"the estimated error of the {' and of the '.join(above)}, {_percent(worst.total)} of the largest"
        f"{f' (of the {name})' if len(above) > 1 else ''}, is above the tolerance {_percent(settings.tolerance)}: "
        f"{', '.join(causes)}{f'; {errors.note}' if errors.note else ''}",
    )


def _cure_of_step(settings: ResponseSettings) -> str:
    if settings.step is not None:
        return 'give a smaller step, or "auto"'
    if settings.integrator == "adaptive":
        return "give a smaller tolerance"
    if settings.integrator == "gauss":
        return "vibration too fast for automatic steps: give a smaller step"
    return 'vibration too fast for automatic steps: response.integrator = "gauss" follows it in fewer'


def effort(settings: ResponseSettings, steps: int, finer: int) -> tuple[str, ...]:
    """What to say of an automatic step so many times finer than the results': which integrator needs fewer."""
    if settings.step is not None or settings.integrator in ("gauss", "adaptive") or finer < MANY:
        return ()
    return (
        f"{settings.integrator} took {steps} steps, {finer} to each of the results: its error, most of it a delay that "
        "grows with every cycle of a lightly damped vibration, falls as the square of the step only; "
        'response.integrator = "gauss" keeps the same accuracy in far fewer',
    )


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _yielding(structure: Structure, peaks: Peaks) -> list[str]:
    """What to say where the stress exceeds the yield strength."""
    strength = None if structure.sections is None else structure.sections.yield_strength
    if strength is None or peaks.loads is None:
        return []
    stress, stations = peaks.loads.stress, np.append(0.0, structure.stations)
    worst = int(np.argmax(stress.value))
    if not stress.value[worst] > strength:
        return []
    return [
        f"the stress reaches {1e-6 * stress.value[worst]:.4g} MPa at {stations[worst]:.4g} m, t = "
        f"{stress.time[worst]:.4g} s, above the yield strength, {1e-6 * strength:.4g} MPa: the material yields, and "
        "the response, which is elastic, means nothing from there on"
    ]


def turned_out_of_plane(structure: Structure, q: Floats) -> float:
    """Largest angle by which the exact field's tangent turns, rad; zero where the beam stays in one plane."""
    field = structure.field.inner if isinstance(structure.field, RootedField) else structure.field
    if not isinstance(field, ExactField) or field.planar:
        return 0.0
    beam = q[:, : field.angle_y.shape[1]]
    vector = np.stack([(beam @ np.asarray(angle).T).ravel() for angle in (field.angle_y, field.angle_z)])
    across, _ = np.linalg.eigvalsh(vector @ vector.T)
    in_plane = across <= (1e-6 * np.pi) ** 2 * vector.shape[1]
    return 0.0 if in_plane else float(np.linalg.norm(vector, axis=0).max())
