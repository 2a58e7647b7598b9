"""Runs of a structure, and the response that is made of one, with its errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import DEFLECTION, LOADS, PLACE
from gbeam.analysis.accuracy.estimate import BEAM, NOTHING, unjudged
from gbeam.analysis.outline import outline_of
from gbeam.analysis.response.outcome import describe, effort, inaccuracies
from gbeam.analysis.response.peaks import displacement_peaks, load_peaks, peaks_of_coordinates
from gbeam.analysis.response.posed import Posed, pose
from gbeam.analysis.response.problem import problem_of, start_of
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import (
    LOADS_STEPS,
    first_steps,
    integrated,
    joined,
    scheme_of,
    split,
    steps_beyond,
)
from gbeam.analysis.system.accuracy import Starting, system_errors
from gbeam.analysis.system.point import unknown_at_start
from gbeam.analysis.system.solution import Solution
from gbeam.arrays.namespace import Array, is_jax
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.section_forces import accelerations, root_loads, section_forces
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.one_body import on_motion
from gbeam.mechanics.tree.system import System
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import Motion, level_factor, notes_on
from gbeam.progress import Progress
from gbeam.results.errors import ErrorEstimate, Errors, StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Base, Influence, Loads, Peaks
from gbeam.results.response import HubResult, Response
from gbeam.structure.beam import names_at

Prepared = tuple[Motion, ResponseSettings]


@dataclass(frozen=True)
class StructureRun(Run):
    """A run of a structure, with a machine's spin-up and spin-down where it has them."""

    posed: Posed
    up: Trajectory | None = None
    down: Trajectory | None = None

    @classmethod
    def prepared(cls, structure: Structure, motion: Motion | None, settings: ResponseSettings) -> Prepared:
        """The motion over the flight's times, and the settings; InputError without a motion."""
        if motion is None:
            raise InputError("motion", "is missing", "give a Flight, a Hub or a Centrifuge; Flight(z=0.0) is at rest")
        structure.require_damping("the response")
        return motion.over(settings.start, settings.start + settings.duration), settings

    @classmethod
    def poses(cls, structure: Structure, motion: Motion, settings: ResponseSettings) -> Iterator[Posed]:
        """Yield the problem with each of the steps of results to try, the longest first."""
        return (pose(structure, motion, settings, *step) for step in first_steps(structure, motion, settings))

    @classmethod
    def by_steps(cls, posed: Posed, step: float, progress: Progress = None) -> StructureRun:
        """Run by steps of a length, s, until the model ceases to hold; a spin-up that failed is the whole run."""
        if posed.up is not None and posed.stuck:
            return cls(posed.up, posed.kept, posed)
        how: Any = {"corners": posed.felt, "stop": posed.too_far, "progress": progress}
        return cls(integrated(posed.problem, posed.settings, step, **how), step, posed, posed.up)

    @classmethod
    def traced(
        cls, structure: Structure, motion: Motion, settings: ResponseSettings, step: float, name: str
    ) -> Response:
        """Response traced by JAX: one program runs spin-up, flight and spin-down, which are then split."""
        before, after = steps_beyond(motion, settings, step)
        start, count = settings.start - before * step, round(settings.duration / step)
        problem = problem_of(structure, motion, start, settings.begin)
        entire = integrated(problem, replace(settings, start=start, duration=(before + count + after) * step), step)
        up, trajectory, down = split(entire, before, count, after)
        assert trajectory is not None
        posed = Posed(structure, motion, settings, problem, step)
        return response_of(cls(trajectory, step, posed, up, down), StepErrors(), name)

    def described(self, errors: StepErrors, name: str, progress: Progress = None) -> Response:
        """Run the spin-down, if the run is whole, and return the response."""
        down = self.posed.spun_down(self.trajectory, progress) if self.whole else None
        return response_of(replace(self, down=down), errors, name)

    def judged(self, steps: StepErrors) -> tuple[Errors, tuple[str, ...]]:
        """Errors of the response over the flight's times, and warnings of them."""
        posed, settings = self.posed, self.posed.settings
        structure, motion = posed.structure, posed.motion
        tip, root, stress = (ErrorEstimate(step=step) for step in (steps.displacement, steps.loads, steps.stress))
        errors, doubts = Errors(tip, tip, root, stress, note=settings.not_estimated), tuple[str, ...]()
        if settings.estimate and not settings.loads:
            tip, root = (replace(each, total=each.step) for each in (tip, root))
            errors = Errors(tip, tip, root, note=unjudged(structure))
        elif settings.estimate:
            system, ground = on_motion(structure, motion, BEAM)

            def every(stride: int) -> Solution:
                of = self.trajectory.at(slice(None, None, stride))
                return Solution(system, of, lambda other, times: other.inputs(of.time[times], ground))

            def begun(other: System) -> tuple[Floats, Floats]:
                (body,) = other.flexible.values()
                return start_of(body, motion, settings.start, settings.begin)[:2]

            settled = not motion.free and (self.up is not None or settings.begin.settled)
            starting = None if settled else Starting(partial(unknown_at_start, initial=settings.begin.state), begun)
            by_step = dict.fromkeys((PLACE, (BEAM, DEFLECTION)), steps.displacement)
            by_step |= {(BEAM, load): steps.loads for load in LOADS[:2]}
            stressed = structure.size and (structure.sections is not None or structure.recovery is not None)
            by_step |= {(BEAM, LOADS[2]): steps.stress} if stressed else {}
            peaks = dict(zip(((BEAM, load) for load in LOADS), steps.peaks, strict=False))
            how: Any = {"stride": self.stride, "peaks_by_step": peaks, "starting": starting}
            errors, doubts = system_errors(every, None, by_step, **how, tolerance=settings.tolerance)
        doubts += inaccuracies(structure, errors, settings)
        return errors, doubts + effort(settings, len(self.trajectory.time) - 1, self.stride)

    @cached_property
    def moved(self) -> list[Floats]:
        """Displacement of the tip, (t, 3) m."""
        return [self.posed.tip(self.trajectory.q)]

    @cached_property
    def peaks(self) -> list[Floats]:
        """Peaks of the tip's displacement and of the root's moment, (4,) each."""
        tip, moment = self.posed.tip, self.posed.moment
        histories = (self.moved[0], tip), (moment(self.trajectory.q), moment)
        return [peaks_of_coordinates(self.trajectory, values, of) for values, of in histories]

    def loads(self, stride: int) -> list[Floats]:
        """Root force and moment (t, 3), zero if rounding; if errors are estimated, stress at every section (t, s, 1),
        or a solid's (t, c).
        """
        posed, structure, at = self.posed, self.posed.structure, self.trajectory.at(slice(None, None, stride))
        base, _ = posed.moving(at.time, at.q, at.qd, at.qdd)
        q, qd, qdd = (x[:, posed.beam] for x in (at.q, at.qd, at.qdd))
        force, moment = root_loads(structure, posed.terms, base, q, qd, qdd, at.time)
        largest = np.abs(force).max() * structure.length, np.abs(moment).max()
        felt = [force * (largest[0] > NOTHING * largest[1]), moment * (largest[1] > NOTHING * largest[0])]
        if not posed.settings.estimate:
            return felt
        forces = section_forces(structure, base, q, qd, qdd, at.time, motion=posed.motion)
        sides = [forces.stress_tension, forces.stress_compression]
        if forces.von_mises is not None and np.isfinite(forces.von_mises).all():
            sides.append(forces.von_mises)  # under torsion alone the normal stresses are rounding
        stress = np.concatenate(sides, axis=1)[..., None]
        if structure.recovery is not None:
            stress = np.asarray(structure.recovery.felt(q))
        return [*felt, stress]


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
    run: StructureRun,
    step_errors: StepErrors,
    name: str,
    *,
    axes_of: Callable[[Any, Floats], AxesResult | None] = axes_result,
    base: Base | None = None,
    moved: Array | None = None,
    peaks: Peaks | None = None,
) -> Response:
    """Response at the results' times through spin-up, flight and spin-down, with errors and warnings. `base`, `moved`
    and `peaks` are computed unless given, which they may be of a flight alone.
    """
    posed, trajectory, stride, up, down = run.posed, run.trajectory, run.stride, run.up, run.down
    structure, motion, settings, beam = posed.structure, posed.motion, posed.settings, posed.beam
    entire, flight = joined(up, trajectory, down, stride)
    last = trajectory if down is None else down
    traced = is_jax(trajectory.q)
    fine = structure.displacement(trajectory.q[:, beam]) if moved is None else moved
    if peaks is None:
        (peaks,) = displacement_peaks(structure, [trajectory], posed.problem.first, fine[None], settings.residual_from)

    def read(
        part: Trajectory, steps: Any, known: Base | None = None
    ) -> tuple[tuple[Any, ...], Base, HubResult | None, Loads | None]:
        """Times and coordinates, base, hub and loads at an index or slice of the steps of a trajectory."""
        part = part.at(steps)
        time, q, qd, qdd = part.time, part.q, part.qd, part.qdd
        base, hub = posed.moving(time, q, qd, qdd, known)
        loads = None
        if settings.loads:
            loads = section_forces(structure, base, q[:, beam], qd[:, beam], qdd[:, beam], time, motion=motion)
        return (time, q, qd, qdd), base, hub, loads

    (time, q, qd, qdd), over_time, hub, loads = read(entire, slice(None), base)
    frequencies, _ = structure.rest
    # Peaks are of all steps, of 50,000 at most: among more their neighbourhoods are looked at again. The results' steps
    # are among those that are looked at.
    fewest = min(stride, -(-len(trajectory.time) // LOADS_STEPS))
    looked = next(every for every in range(fewest, stride + 1) if stride % every == 0)
    felt_at_steps = None
    if loads is not None and not traced:
        every = loads.during(flight)
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
    displacement = fine[::stride] if up is None and down is None else structure.displacement(q[:, beam])
    errors = Errors()
    warnings: tuple[str, ...] = ()
    if not traced:
        outcome, message, from_run = describe(structure, posed.problem, last, over_time, peaks, time, q[:, beam])
        if outcome == "done":
            errors, doubts = run.judged(step_errors)
            from_run += doubts
        span = time[0], time[-1]
        from_inputs = input_warnings(structure, motion, name=name, span=span, base=over_time, rest=frequencies)
        warnings = from_inputs + settings.warnings + from_run + (() if axes is None else axes.warnings)
    recovered = dict[str, Any]()
    if settings.loads and not traced:
        at_all, base_then = entire, over_time
        if looked < stride and structure.recovery is not None:
            at_all = joined(up, trajectory, down, looked)[0]
            base_then, _ = posed.moving(at_all.time, at_all.q, at_all.qd, at_all.qdd)
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
        steps=sum(len(part.time) - 1 for part in (up, trajectory, down) if part is not None),
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
