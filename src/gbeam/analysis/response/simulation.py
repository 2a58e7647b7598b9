"""Response over time in one environment."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import response_errors
from gbeam.analysis.accuracy.response_errors import Solution
from gbeam.analysis.response.outcome import describe, effort, inaccuracies
from gbeam.analysis.response.outline import outline_of
from gbeam.analysis.response.peaks import displacement_peaks, load_peaks
from gbeam.analysis.response.problem import Problem, problem_of
from gbeam.analysis.response.settings import NOT_ESTIMATED, ResponseSettings
from gbeam.analysis.response.step_errors import Readings, Run
from gbeam.analysis.response.stepping import check, corners, first_step, refine, scheme_of
from gbeam.analysis.response.trajectories import (
    adapted,
    going_on,
    integrated,
    joined,
    ramp,
    split,
    steps_beyond,
)
from gbeam.arrays.namespace import holds_jax, is_jax
from gbeam.errors import InputError
from gbeam.integrate.driver import Trajectory
from gbeam.integrate.steps import Corners
from gbeam.limits import HISTORY_BYTES, STEPS, refuse_more
from gbeam.mechanics.influence import influence
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.motion.centrifuge.history import axes_result
from gbeam.motion.protocol import Motion
from gbeam.results.errors import ErrorEstimate, Errors, StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.response import BaseMotion, HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.section_forces import Loads

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
    if settings is None:
        settings = _settings(options)
    elif options:
        raise InputError(next(iter(options)), "is given beside settings", "give one of them")
    structure.require_damping("the response")
    motion = motion.over(settings.start, settings.start + settings.duration)
    if holds_jax(structure, motion):
        return _traced(structure, motion, settings, name)
    coarse = first_step(structure, motion, settings)
    given = None if settings.step is None else settings.duration / max(1, round(settings.duration / settings.step))
    kept = given or coarse
    each = 8.0 * (3 * sum(structure.counts) + 9 * len(structure.stations))
    most = min(STEPS, int(HISTORY_BYTES / each))
    fix = f"give {most * kept:.3g} s or less, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / kept, most, each, fix)
    before, after = steps_beyond(motion, settings, kept)
    problem = problem_of(structure, motion, settings.start - before * kept, settings.begin)

    def too_far(y: Floats) -> int | None:
        """A projected field means nothing once it moves by the beam's length."""
        if structure.kind == "exact":
            return None
        moved = np.abs(structure.displacement(y[:, problem.first :])).max(axis=(1, 2))
        return int(np.argmax(moved > structure.length)) + 1 if moved.max() > structure.length else None

    def how(what: str) -> dict[str, Any]:
        return {"stop": too_far, "progress": None if progress is None else lambda share: progress(what, share)}

    def tip(y: Floats) -> Floats:
        return np.asarray(structure.displacement(y[..., problem.first :])[..., -1, :])

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
        base, _ = _moving(motion, time, q, qd, qdd)
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

    times, end = corners(structure, motion, coarse), settings.start + settings.duration
    felt = Corners.of(times, begun.equations.drive, settings.start, end)
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


def _settings(options: dict[str, Any]) -> ResponseSettings:
    try:
        return ResponseSettings(**options)
    except TypeError as error:
        fields = ", ".join(ResponseSettings.__dataclass_fields__)
        raise InputError("simulate", f"cannot be called so ({error})", f"give duration, and any of {fields}") from None


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


def response_of(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings,
    problem: Problem,
    runs: tuple[Trajectory | None, Trajectory, Trajectory | None],
    name: str,
    step: float,
    step_errors: StepErrors,
    stride: int,
    *,
    axes_of: Callable[[Any, Floats], AxesResult | None] = axes_result,
) -> Response:
    """Sample spin-up, flight and spin-down on the coarse grid and describe them; peaks are of the flight's times."""
    up, trajectory, down = runs
    every, flight = joined(up, trajectory, down, stride)
    last = trajectory if down is None else down
    traced = is_jax(trajectory.q)
    beam = slice(problem.first, None)
    fine = structure.displacement(trajectory.q[:, beam])
    peaks = displacement_peaks(structure, trajectory, problem.first, fine, settings.residual_from)

    def at(of: Trajectory, steps: Any) -> tuple[tuple[Any, ...], BaseMotion, HubResult | None, Loads | None]:
        """Coordinates, base, hub and loads at some of the steps."""
        time, q, qd, qdd = (x[steps] for x in (of.time, of.q, of.qd, of.qdd))
        base, hub = _moving(motion, time, q, qd, qdd)
        loads = None
        if settings.loads:
            loads = section_forces(structure, base, q[:, beam], qd[:, beam], qdd[:, beam], time, motion=motion)
        return (time, q, qd, qdd), base, hub, loads

    (time, q, qd, qdd), base, hub, loads = at(every, slice(None))
    if loads is not None and not traced:
        of_flight = load_peaks(loads.during(flight), lambda steps: at(trajectory, steps)[3], trajectory.time, stride)
        peaks = replace(peaks, loads=of_flight)
    if hub is not None and not motion.free and loads is not None and loads.drive_torque is not None:
        hub = replace(hub, drive_torque=loads.drive_torque)
    axes = None if traced or motion.kind != "centrifuge" else axes_of(motion, time)
    outcome, message, warnings = "done", "", tuple(f"record: {note}" for note in getattr(motion, "notes", ()))
    displacement = fine[::stride] if up is None and down is None else structure.displacement(q[:, beam])
    errors = Errors()
    if not traced:
        outcome, message, own = describe(structure, problem, last, base, peaks, time, q[:, beam])
        if outcome == "done":
            solution = Solution(time[flight], q[flight], qd[flight], qdd[flight])
            during = None if loads is None else loads.during(flight)
            settled, tip = up is not None or settings.begin.settled, np.asarray(displacement[flight, -1])
            steps = step_errors.displacement, step_errors.loads, step_errors.stress
            if settings.estimate:
                errors = response_errors(structure, motion, solution, tip, during, steps, settled=settled)
            else:
                alone = [ErrorEstimate(step=step) for step in steps]
                errors = Errors(alone[0], alone[1], alone[2], NOT_ESTIMATED)
            own += inaccuracies(structure, errors, settings) + effort(settings, len(trajectory.time) - 1, stride)
        given = input_warnings(structure, motion, name=name, span=(time[0], time[-1]), base=base)
        warnings = given + settings.warnings + own + (() if axes is None else axes.warnings) + warnings
    return Response(
        name=name,
        environment=motion.kind,
        model=structure.kind,
        outcome=outcome,
        message=message,
        warnings=warnings,
        time=time,
        stations=np.asarray(structure.stations),
        displacement=displacement,
        q=q[:, beam],
        qd=qd[:, beam],
        base=base,
        peaks=peaks,
        integrator=settings.integrator,
        step=step,
        steps=sum(len(run.time) - 1 for run in runs if run is not None),
        error_estimate=errors.displacement.total,
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        hub=hub,
        axes=axes,
        qdd=qdd[:, beam],
        frequencies=structure.rest[0],
        loads=loads,
        influence=influence(structure) if motion.kind == "centrifuge" and not traced else None,
        damping_ratio=structure.damping_ratio,
        initial=str(settings.begin),
        outline=None if traced else outline_of(structure, motion, time, q[:, beam]),
    )


def _moving(motion: Any, time: Floats, y: Array, yd: Array, ydd: Array) -> tuple[BaseMotion, HubResult | None]:
    """Motion of the root over time, and of the hub if there is one."""
    hub = None
    if motion.free:
        angle, rate, acceleration = y[:, 0], yd[:, 0], ydd[:, 0]
        base = motion.mount.base(angle, rate, acceleration)
        hub = HubResult(angle, rate, acceleration, motion.torque(time), free=True)
    else:
        base = motion.base(time)
        if motion.kind == "hub":
            axis = motion.mount.R_HB[2]
            hub = HubResult(motion.angle(time), base.w_WB_B @ axis, base.alpha_WB_B @ axis)
    return BaseMotion(base.a_WO_B, base.w_WB_B, base.alpha_WB_B), hub
