"""Response of a structure that a run leaves, with its errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.outline import outline_of
from gbeam.analysis.response.outcome import effort, ending_of, far_bent, inaccuracies, yielding
from gbeam.analysis.response.peaks import displacement_peaks, load_peaks
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.stepping import LOADS_STEPS, scheme_of
from gbeam.arrays.namespace import Array
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.section_forces import accelerations, section_forces
from gbeam.mechanics.structure import Structure
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import Motion, level_factor, notes_on
from gbeam.progress import Progress
from gbeam.results.errors import Errors, StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Base, Influence, Loads, Peaks
from gbeam.results.response import HubResult, Response
from gbeam.structure.beam import names_at


def influence(structure: Structure) -> Influence:
    """Static tip displacements and root loads of the straight beam by unit accelerations of the base: uniform (3,), and
    growing with x: centripetal (−ω² x) and angular (α_z x, −α_y x).
    """
    c = structure.coefficients
    linear = np.stack([-c.f_ww[2, 2], c.f_al[2], -c.f_al[1]])
    per_q = structure.station_places.first[-1]

    def tip(load: Array) -> Array:
        return np.diagonal(per_q @ np.linalg.solve(c.stiffness, load.T))

    mass, first, second = float(c.rigid[0]), float(c.rigid[1]), float(c.rigid[4])  # and moments ∫ x dm, ∫ x² dm
    across = np.array([0.0, 1.0, 1.0])
    return Influence(
        tip_uniform=tip(c.f_a),
        tip_linear=tip(linear),
        force_uniform=np.full(3, -mass),
        force_linear=np.full(3, -first),
        moment_uniform=-first * across,
        moment_linear=-second * across,
    )


def response_of(
    run: Run,
    step_errors: StepErrors,
    name: str,
    progress: Progress = None,
    *,
    axes_of: Callable[[Any, Floats], AxesResult | None] = axes_result,
    base: Base | None = None,
    moved: Array | None = None,
    peaks: Peaks | None = None,
) -> Response:
    """Response at the results' times through spin-up, flight and spin-down, with errors and warnings. `base`, `moved`
    and `peaks` are computed unless given, which they may be of a flight alone.
    """
    posed, trajectory, stride, entire = run.posed, run.flight, run.stride, run.trajectory
    subject, settings = posed.subject, posed.settings
    structure, beam, traced = subject.structure, posed.columns(subject.body), run.traced
    assert subject.motion is not None
    motion, chosen = subject.motion, run.sampled(stride)
    fine = structure.displacement(trajectory.q[:, beam]) if moved is None else moved
    if peaks is None:
        (peaks,) = displacement_peaks(structure, [trajectory], beam.start, fine[None], settings.residual_from)

    def read(
        part: Trajectory, steps: Any, known: Base | None = None
    ) -> tuple[tuple[Any, ...], Base, HubResult | None, Loads | None]:
        """Times and coordinates, base, hub and loads at an index or slice of the steps of a trajectory."""
        part = part.at(steps)
        time, q, qd, qdd = part.time, part.q, part.qd, part.qdd
        base, hub = _moving(motion, time, q, qd, qdd, known)
        loads = None
        if settings.loads:
            loads = section_forces(structure, base, q[:, beam], qd[:, beam], qdd[:, beam], time, motion=motion)
        return (time, q, qd, qdd), base, hub, loads

    (time, q, qd, qdd), over_time, hub, loads = read(entire, chosen, base)
    frequencies, _ = structure.rest
    # Peaks are of all steps, of 50,000 at most: among more their neighbourhoods are looked at again. The results' steps
    # are among those that are looked at.
    fewest = min(stride, -(-len(trajectory.time) // LOADS_STEPS))
    looked = next(every for every in range(fewest, stride + 1) if stride % every == 0)
    felt_at_steps = None
    if loads is not None and not traced:
        every = loads.during(run.flown(stride))
        if looked < stride:
            (at, *state), base_there, _, at_steps = read(trajectory, slice(None, None, looked))
            assert at_steps is not None
            every, (y, yd, ydd) = at_steps, (values[:, beam] for values in state)
            accelerated = every.acceleration[:, 1:] if structure.sections is not None else accelerations(
                structure, base_there, y, yd, ydd
            )  # fmt: skip
            felt_at_steps = at, accelerated
        of_flight = load_peaks(every, trajectory.time, lambda steps: read(trajectory, steps)[3], looked)
        peaks = replace(peaks, loads=of_flight)
    if hub is not None and not motion.free and loads is not None and loads.drive_torque is not None:
        hub = replace(hub, drive_torque=loads.drive_torque)
    if hub is not None and hub.free and not traced:
        hub = replace(hub, fastest=float(np.abs(trajectory.qd[:, 0]).max()))
    axes = None if traced or motion.kind != "centrifuge" else axes_of(motion, time)
    outcome, message = "done", ""
    straight = structure.source is None or structure.source.beam.line is None
    felt = None if traced or structure.sections is not None or not settings.loads else accelerations(
        structure, over_time, q[:, beam], qd[:, beam], qdd[:, beam]
    )  # fmt: skip
    beyond = len(entire.time) > len(trajectory.time)
    displacement = structure.displacement(q[:, beam]) if beyond else fine[::stride]
    errors = Errors()
    warnings: tuple[str, ...] = ()
    if not traced:
        ending = ending_of(run, {subject.body: (over_time, q[:, beam])}, time)
        outcome, message, from_run = ending.outcome, ending.message, ending.warnings
        if ending.done:
            from_run += (*yielding(peaks.loads), *far_bent(structure, peaks.max_size))
            errors, doubts = run.errors(step_errors, progress)
            doubts += inaccuracies(structure, errors, settings)
            from_run += doubts + effort(settings, len(trajectory.time) - 1, stride)
        span = time[0], time[-1]
        from_inputs = input_warnings(structure, motion, name=name, span=span, base=over_time, rest=frequencies)
        warnings = from_inputs + settings.warnings + from_run + (() if axes is None else axes.warnings)
    recovered = dict[str, Any]()
    if settings.loads and not traced:
        at_all, base_then = entire.at(chosen), over_time
        if looked < stride and structure.recovery is not None:
            at_all = entire.at(run.sampled(looked))
            base_then, _ = _moving(motion, at_all.time, at_all.q, at_all.qd, at_all.qdd)
        recovered = _recovered(structure, motion, at_all.time, base_then, at_all.q[:, beam], name, peaks)
        if looked < stride and "solid" in recovered:
            recovered["solid"] = recovered["solid"].sampled(np.searchsorted(at_all.time, time))
    # Of what cannot be judged the steps alone are known.
    known = settings.estimate and not structure.judged and math.isnan(errors.displacement.total)
    stated = errors.displacement.step if known else errors.displacement.total
    flown = motion.flight if isinstance(motion, Centrifuge) else motion
    span = settings.start, settings.start + settings.duration
    whole = flown.part_of(*span) if isinstance(flown, Flight) else None
    return Response(
        name=name,
        environment=motion.kind,
        model=structure.kind,
        outcome=outcome,
        message=message,
        warnings=warnings,
        notes=notes_on({name: motion}),
        time=time,
        stations=np.asarray(structure.stations),
        points=structure.points
        if traced or structure.source is None
        else names_at(structure.source.beam, structure.stations),
        displacement=displacement,
        q=q[:, beam],
        qd=qd[:, beam],
        base=over_time,
        peaks=peaks,
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(entire.time) - 1,
        error_estimate=stated,
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        hub=hub,
        axes=axes,
        qdd=qdd[:, beam],
        frequencies=frequencies,
        loads=loads,
        influence=influence(structure) if motion.kind == "centrifuge" and straight and not traced else None,
        damping_ratio=structure.damping_ratio,
        initial=str(settings.begin),
        outline=outline_of(structure, motion, time, q[:, beam]) if settings.loads and not traced else None,
        bodies=np.empty((0, 3)) if traced or structure.source is None else structure.source.beam.body_centres,
        whole=whole,
        scale=level_factor(motion),
        shapes=None if structure.source is None else dict(zip(FAMILIES, structure.counts, strict=True)),
        point_acceleration=felt,
        kept_every=settings.kept_every(len(time), float(time[-1] - time[0]) / max(len(time) - 1, 1)),
        felt_at_steps=felt_at_steps,
        **recovered,
    )


def _moving(
    motion: Any, time: Floats, y: Array, yd: Array, ydd: Array, base: Base | None = None
) -> tuple[Base, HubResult | None]:
    """Motion of the root at times (t,) and unknowns (t, n), or the `base` if known; and of the hub, or None."""
    if motion.free:
        angle, rate, acceleration = y[:, 0], yd[:, 0], ydd[:, 0]
        hub = HubResult(angle, rate, acceleration, motion.torque(time), free=True)
        return motion.mount.base(angle, rate, acceleration), hub
    base = motion.base(time) if base is None else base
    if motion.kind != "hub":
        return base, None
    axis = motion.mount.R_HB[2]
    return base, HubResult(motion.angle(time), base.w_WB_B @ axis, base.alpha_WB_B @ axis)


def _recovered(
    structure: Structure, motion: Motion, time: Floats, base: Base, q: Floats, name: str, peaks: Peaks
) -> dict[str, Any]:
    """Fields that only the responses of curved beams, solids and rigid specimens have, by name."""
    if structure.recovery is None:
        return {} if structure.source is None else {"envelope": structure.source.beam.envelope}
    parts = structure.recovery.parts(time, base, q, motion=name, model=structure.kind, environment=motion.kind)
    if "specimen" in parts:
        parts["specimen"] = replace(parts["specimen"], root=peaks.loads)
    return {"envelope": structure.recovery.envelope, **parts}
