"""Response over time in one environment."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import problem_of
from gbeam.analysis.response.record import moving, response_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.steps.step_errors import Readings, Run
from gbeam.analysis.response.steps.stepping import check, corners, first_step, refine, scheme_of
from gbeam.analysis.response.steps.trajectories import (
    adapted,
    going_on,
    integrated,
    ramp,
    split,
    steps_beyond,
)
from gbeam.arrays.namespace import holds_jax
from gbeam.errors import InputError
from gbeam.guards.limits import HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.driver import Trajectory
from gbeam.integrate.equations import Drive
from gbeam.integrate.steps import Corners
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.parts.errors import StepErrors
from gbeam.results.response import Response
from gbeam.results.result import Floats

Array = Any


def simulate(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings | None = None,
    *,
    name: str = "",
    progress: Callable[[str, float], None] | None = None,
    **options: Any,
) -> Response:
    """Compute the response of a beam in one environment.

    It starts in relative equilibrium with the base's motion at the start (a free hub at rest), without vibration,
    unless ``initial`` of the settings says otherwise: ``"undeformed"``, or an :class:`Initial` state. A
    machine's run covers its whole motion on the flight's clock: spin-up comes before `start`, and spin-down after the
    duration, in whole steps of the results' grid. The step is chosen, and error and peaks are, for the flight's times.

    Parameters
    ----------
    structure : Structure
        From :func:`gbeam.assemble`.
    motion : Flight, Centrifuge or Hub
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate(structure, motion, duration=10.0)``.
    name : str
        For the result.
    progress : callable, optional
        Called with what is being done and the fraction done.

    Returns
    -------
    Response
        With the loads along the beam. Its outcome is ``done``, ``diverged`` (the displacement left what the model can
        mean) or ``not converged`` (Newton's method failed). Where JAX traces the structure or the motion, its arrays
        are traced: their derivatives are those of the discrete solution; there is no error estimate, and a step that
        fails leaves NaN.

    Raises
    ------
    InputError
        If the integrator cannot run this model, the beam has no damping ratio, settings are given twice, there are too
        many steps, or a traced run has no step.
    ComputationError
        If there is no relative equilibrium to start from.
    """
    settings = settings_of("simulate", settings, options)
    structure.require_damping("the response")
    motion = motion.over(settings.start, settings.start + settings.duration)
    if structure.holds_jax or holds_jax(motion):
        return _traced(structure, motion, settings, name)
    coarse, given, before, after = planned_steps(structure, motion, settings)
    kept = given or coarse
    problem = problem_of(structure, motion, settings.start - before * kept, settings.begin)

    def too_far(y: Floats) -> int | None:
        return steps_within(structure, structure.displacement(y[:, problem.first :]))

    def how(what: str) -> dict[str, Any]:
        return {"stop": too_far, "progress": None if progress is None else lambda share: progress(what, share)}

    def tip(y: Floats) -> Floats:
        return np.asarray(structure.tip(y[..., problem.first :]))

    def moment(y: Floats) -> Floats:
        """Root moment by the elastic forces K q, which the coordinates' inertia balances, of the straight beam."""
        c = structure.coefficients
        return np.asarray(y[..., problem.first :] @ (c.f_al @ np.linalg.solve(c.mass, c.stiffness)).T)

    def loads(trajectory: Trajectory, stride: int) -> list[Floats]:
        """Force and moment at the root, and both sides' stress at every section; none where the settings have none."""
        if not settings.loads:
            return []
        some = slice(None, None, stride)
        time, q, qd, qdd = (x[some] for x in (trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd))
        base, _ = moving(motion, time, q, qd, qdd)
        q, qd, qdd = (x[:, problem.first :] for x in (q, qd, qdd))
        made = section_forces(structure, base, q, qd, qdd, time, motion=motion)
        if made is None:
            return []
        stress = np.concatenate([made.stress_tension, made.stress_compression], axis=1)[..., None]
        return [made.section_force[:, 0], made.section_moment[:, 0], stress]

    up = ramp(problem, settings, kept, -before, before, **how("spinning up")) if before else None
    if up is not None and not up.whole:
        return response_of(structure, motion, settings, problem, (None, up, None), name, kept, StepErrors(), 1)
    begun = problem if up is None else going_on(problem, up)

    felt = felt_corners(structure, motion, settings, coarse, begun.equations.drive)
    readings = Readings(tip, moment, loads)

    def run(step: float, what: str) -> Run:
        return Run(integrated(begun, settings, step, corners=felt, **how(what)), step, readings)

    if settings.integrator == "adaptive":
        made, errors = adapted(begun, replace(settings, tolerance=settings.aim), coarse, felt, readings, too_far)
    elif given is not None:
        once = not settings.estimate
        made, errors = (
            (run(given, "integrating"), StepErrors()) if once else check(run, given, scheme_of(settings).order)
        )
    else:
        made, errors = refine(run, coarse, scheme_of(settings).order, settings)
    trajectory, step = made.trajectory, made.step
    down = None
    if after and trajectory.whole:
        at_end = round(settings.duration / kept)
        down = ramp(going_on(problem, trajectory), settings, kept, at_end, after, **how("spinning down"))
    # An automatic step divides the coarse one: its stride brings every motion of a study back to the same times.
    stride = 1 if settings.step is not None or math.isnan(step) else round(coarse / step)
    return response_of(structure, motion, settings, problem, (up, trajectory, down), name, step, errors, stride)


def _traced(structure: Structure, motion: Motion, settings: ResponseSettings, name: str) -> Response:
    """A run whose values JAX traces: of a given step, without a look at them."""
    if settings.step is None or settings.integrator == "adaptive":
        raise InputError("step", "is automatic, and a traced run has no numbers to choose it by", "give a step, s")
    step = settings.duration / max(1, round(settings.duration / settings.step))
    before, after = steps_beyond(motion, settings, step)
    start, count = settings.start - before * step, round(settings.duration / step)
    problem = problem_of(structure, motion, start, settings.begin)
    # One program for all of it, which is then taken apart.
    entire = integrated(problem, replace(settings, start=start, duration=(before + count + after) * step), step)
    up, trajectory, down = split(entire, before, count, after)
    assert trajectory is not None
    return response_of(structure, motion, settings, problem, (up, trajectory, down), name, step, StepErrors(), 1)


def settings_of(name: str, settings: ResponseSettings | None, options: dict[str, Any]) -> ResponseSettings:
    """The settings that a function of some name is given, as such or by keyword; InputError if both or neither are."""
    if settings is not None:
        if options:
            raise InputError(next(iter(options)), "is given beside settings", "give one of them")
        return settings
    try:
        return ResponseSettings(**options)
    except TypeError as error:
        fields = ", ".join(ResponseSettings.__dataclass_fields__)
        raise InputError(name, f"cannot be called so ({error})", f"give duration, and any of {fields}") from None


def planned_steps(
    structure: Structure, motion: Motion, settings: ResponseSettings
) -> tuple[float, float | None, int, int]:
    """Step of the results, that given or None, s, and how many steps a machine takes before and after the flight's.

    Raises
    ------
    InputError
        If there are too many.
    """
    coarse = first_step(structure, motion, settings)
    given = None if settings.step is None else settings.duration / max(1, round(settings.duration / settings.step))
    each = 8.0 * (3 * sum(structure.counts) + 9 * len(structure.stations))
    most, kept = min(STEPS, int(HISTORY_BYTES / each)), given or coarse
    fix = f"give {most * kept:.3g} s or less, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / kept, most, each, fix)
    return coarse, given, *steps_beyond(motion, settings, kept)


def felt_corners(
    structure: Structure, motion: Motion, settings: ResponseSettings, coarse: float, drive: Drive
) -> Corners:
    """Corners and jumps of what drives a run, at the flight's times."""
    times, end = corners(structure, motion, coarse), settings.start + settings.duration
    return Corners.of(times, drive, settings.start, end)


def steps_within(structure: Structure, displacement: Floats) -> int | None:
    """After how many steps a projected field moved by the beam's length, and means nothing.

    Parameters
    ----------
    structure : Structure
    displacement : (t, s, 3)
        Of its stations, m.
    """
    if structure.kind == "exact":
        return None
    largest = np.abs(displacement).max(axis=(1, 2))
    return int(np.argmax(largest > structure.length)) + 1 if largest.max() > structure.length else None
