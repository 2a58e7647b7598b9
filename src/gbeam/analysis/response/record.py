"""Response of a system that a run leaves, with its errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import PLACE, Quantity, Reading
from gbeam.analysis.outline import assembly_of, box_of, ends_of, outline_of, supports_of
from gbeam.analysis.response.outcome import ending_of, inaccuracies, integrator_advice, stressed_and_bent
from gbeam.analysis.response.peaks import displacement_peaks, half_ranges, load_peaks, maxima_of
from gbeam.analysis.response.posed import begun_in_words
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.stepping import LOADS_STEPS, scheme_of
from gbeam.analysis.system.histories import Carried, deflection, loads_of
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.solution import reading_of
from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Floats, Indices
from gbeam.mechanics.causes import causes_of, loads_at
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.section_forces import accelerations, add_hub_torques
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.signals import units_of
from gbeam.motion.arm import imbalance_of, level_of
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.histories import axes_result
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import kind_of, level_factor, notes_on
from gbeam.progress import Progress
from gbeam.results.body_response import BodyResponse
from gbeam.results.errors import Errors, StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Base, Influence, Loads, Peaks
from gbeam.results.response import HubResult, Response
from gbeam.results.system import Closures, Invariants
from gbeam.structure.beam import names_at

Known = Mapping[str, tuple[Floats, Peaks]]  # displacements (t, s, 3) m at all steps, and their peaks, by the body
AxesOf = Callable[[Any, Floats], AxesResult | None]


def influence(structure: Structure) -> Influence:
    """Static tip displacements and root loads of the straight beam by unit accelerations of the base.

    One acceleration is uniform (3,). The others grow with x: the centripetal one (−ω² x) and the angular one (α_z x,
    −α_y x). Where supports hold the tip, the displacements are those of the station that moves farthest.
    """
    c = structure.coefficients
    linear = np.stack([-c.f_ww[2, 2], c.f_al[2], -c.f_al[1]])
    station = structure.farthest_station
    per_q = structure.station_places.first[station]

    def tip(load: Array) -> Array:
        return np.diagonal(per_q @ np.linalg.solve(c.stiffness, load.T))

    mass, first, second = float(c.rigid[0]), float(c.rigid[1]), float(c.rigid[4])  # and moments ∫ x dm, ∫ x² dm
    lateral = np.array([0.0, 1.0, 1.0])
    return Influence(
        tip_uniform=tip(c.f_a),
        tip_linear=tip(linear),
        force_uniform=np.full(3, -mass),
        force_linear=np.full(3, -first),
        moment_uniform=-first * lateral,
        moment_linear=-second * lateral,
        station=station,
    )


@dataclass(frozen=True)
class Histories:
    """Quantities of a run at steps that are looked at: `over_time` by key, and the states of `bodies` by name.

    Those at the indices `recorded` are the response's. Every `spacing`-th step of the flight is among them.
    """

    run: Run
    name: str
    spacing: int
    steps: Indices
    recorded: Any  # indices of the response's times among these, or a slice
    over_time: Mapping[str, Any]
    bodies: Mapping[str, Carried]
    known: Known

    @classmethod
    def from_run(cls, run: Run, name: str, known: Known = MappingProxyType({})) -> Histories:
        """Read a run at every step, or at 50,000 of more: the steps near peaks are looked at again."""
        fewest = min(run.stride, -(-len(run.flight.time) // LOADS_STEPS))
        spacing = next(count for count in range(fewest, run.stride + 1) if run.stride % count == 0)
        steps = run.recorded_steps(spacing)
        recorded = slice(None) if spacing == run.stride else np.searchsorted(steps, run.recorded_steps(run.stride))
        return cls(run, name, spacing, steps, recorded, *run.histories(steps), known)

    @property
    def time(self) -> Floats:
        """Times of the steps that are looked at, s."""
        return self.run.trajectory.time[self.steps]

    @property
    def flown(self) -> slice:
        """The flight among the steps that are looked at."""
        return self.run.flight_slice(self.spacing)

    def body(self, name: str) -> BodyResponse:
        """Describe a body that deforms, or a rigid specimen."""
        run, posed, traced = self.run, self.run.posed, self.run.traced
        structure, state, settings = posed.system.flexible[name], self.bodies[name], posed.settings
        motion = posed.subject.motion if name == posed.subject.body else None  # what carries a body that is alone
        recorded, columns = state.select(self.recorded), posed.columns(name)
        if name in self.known:
            moved, peaks = self.known[name]
        else:
            moved = structure.displacement(run.flight.q[:, columns])
            (peaks,) = displacement_peaks(structure, [run.flight], columns, moved[None], settings.residual_from)
        loads = self._loads_in(name, state, self.time) if settings.loads else None
        if loads is not None and not traced:
            read_loads = self._load_reader(name)
            peaks = replace(
                peaks, loads=load_peaks(loads.select_times(self.flown), run.flight.time, read_loads, self.spacing)
            )
        runs_beyond = len(run.trajectory.time) > len(run.flight.time)
        source, acceleration = structure.source, None
        if loads is not None:
            acceleration = loads.acceleration[:, 1:] if structure.sections is not None else accelerations(
                structure, state.base, *state[:3]
            )  # fmt: skip
        straight = structure.recovery is None and (source is None or source.beam.line is None)
        drawn = settings.loads and not traced
        time = self.time[self.recorded]
        outline = outline_of(structure, motion, time, recorded.q) if drawn else None
        return BodyResponse(
            model=structure.kind,
            base=recorded.base,
            stations=np.asarray(structure.stations),
            points=structure.points if traced or source is None else names_at(source.beam, structure.stations),
            displacement=structure.displacement(recorded.q) if runs_beyond else moved[:: run.stride],
            q=recorded.q,
            qd=recorded.qd,
            qdd=recorded.qdd,
            peaks=peaks,
            acceleration=None if acceleration is None else acceleration[self.recorded],
            loads=None if loads is None else loads.select_times(self.recorded),
            frequencies=structure.rest[0],
            damping_ratio=structure.damping_ratio,
            shapes=None if source is None else dict(zip(FAMILIES, structure.counts, strict=True)),
            influence=influence(structure) if isinstance(motion, Centrifuge) and straight and not traced else None,
            outline=outline,
            supports=supports_of(structure, outline, time, recorded.q) if drawn else None,
            **(box_of(structure, time, recorded.q) | self._recovered(name, state, peaks) if drawn else {}),
        )

    def reading(self, bodies: Mapping[str, BodyResponse]) -> Reading | None:
        """Readings over the flight, of the bodies that are judged, for their errors, or None without loads."""
        run = self.run
        if not run.posed.settings.loads:
            return None
        flown = run.flight_slice(run.stride)
        readings: dict[Quantity, Floats] = {PLACE: self.over_time["place"][self.recorded][flown]}
        for name, body in judged_bodies(run.posed.system).items():
            response = bodies[name]
            assert response.loads is not None
            time = self.time[self.recorded][flown]
            readings |= reading_of(name, body, time, response.q[flown], response.loads.select_times(flown))
        return readings

    def _loads_in(self, name: str, state: Carried, time: Floats) -> Loads:
        """Loads along a body in a state at times (t,) s, of a beam on a hub with the torque on it."""
        subject = self.run.posed.subject
        loads = loads_of(subject.system.flexible[name], state, time)
        return add_hub_torques(loads, subject.motion, state.base.alpha_WB_B) if name == subject.body else loads

    def _load_reader(self, name: str) -> Callable[[Indices], Loads]:
        """Return a function that computes the loads along a body at indices of all steps of the flight."""
        first = self.run.in_flight.start or 0

        def loads(steps: Indices) -> Loads:
            _, bodies = self.run.histories(first + steps)
            return self._loads_in(name, bodies[name], self.run.flight.time[steps])

        return loads

    def _recovered(self, name: str, state: Carried, peaks: Peaks) -> dict[str, Any]:
        """Fields that only the responses of curved beams, solids and rigid specimens have, by name."""
        structure, motion = self.run.posed.system.flexible[name], self.run.posed.subject.motion
        if structure.recovery is None:
            return {}
        names = {"motion": self.name, "model": structure.kind, "environment": kind_of(motion)}
        causes = causes_of(structure, state.q, loads_at(structure, self.time))
        parts = structure.recovery.parts(self.time, state.base, causes, **names)
        if "specimen" in parts:
            parts["specimen"] = replace(parts["specimen"], root=peaks.loads)
        if "solid" in parts and self.spacing < self.run.stride:
            parts["solid"] = parts["solid"].sampled(self.recorded)
        return parts

    def hub(self, base: Base | None, bodies: Mapping[str, BodyResponse]) -> HubResult | None:
        """Motion of the hub that carries the body, or None without a hub.

        It follows from the motion of the ground, which rests under a free hub.
        """
        over_time, time = self.over_time, self.time[self.recorded]
        motion: Any = self.run.posed.subject.motion
        if motion is None or motion.kind != "hub":
            return None
        if base is None:
            angle, rate = (over_time[key][self.recorded][:, 0] for key in ("q", "qd"))
            acceleration = self.run.trajectory.select(self.steps[self.recorded]).qdd[:, 0]
            fastest = 0.0 if self.run.traced else float(np.abs(self.run.flight.qd[:, 0]).max())
            return HubResult(angle, rate, acceleration, motion.torque(time), fastest=fastest)
        axis = motion.mount.R_HB[2]
        loads = [body.loads for body in bodies.values() if body.loads is not None]
        torque = loads[0].drive_torque if loads else None
        level = None if self.run.traced else level_of(motion)
        on_ground = over_time["ground_force"][self.recorded], over_time["ground_moment"][self.recorded]
        return HubResult(
            motion.angle(time), base.w_WB_B @ axis, base.alpha_WB_B @ axis, torque,
            level=level, imbalance=imbalance_of(motion, level, time, *on_ground),
        )  # fmt: skip

    @property
    def residual(self) -> Floats | None:
        """Half ranges (p, 3) m after the residual's start, or None without one.

        Those of flexible bodies' points are relative to their roots, those of others about the ground.
        """
        system, settings = self.run.posed.system, self.run.posed.settings
        if settings.residual_from is None:
            return None
        flown, over_time = self.flown, self.over_time
        relative = (deflection(system, point, over_time["q"]) for point in system.points)
        moved = [over_time["place"][:, k] if bent is None else bent for k, bent in enumerate(relative)]
        histories = namespace(*moved).concatenate(moved, axis=1)[flown]
        return half_ranges(self.time[flown], histories, settings.residual_from).reshape(-1, 3)

    def sampled(self) -> dict[str, Any]:
        """Histories of points, coordinates, efforts and the ground's load at the response's times, by field."""
        histories = _during(self.over_time, self.recorded)
        if "gap" in histories:
            keys = "gap", "gap_angle", "closing_force", "closing_moment"
            histories["closures"] = Closures(self.run.posed.system.closing, *(histories.pop(key) for key in keys))
        if "energy" not in histories:
            return histories
        names = "momentum", "angular_momentum", "energy"
        recorded, steps = ([values.pop(name) for name in names] for values in (histories, dict(self.over_time)))
        changes = (
            [] if self.run.traced else [_change(steps[0]), _change(steps[1]), _change(steps[2].sum(axis=1), steps[2])]
        )
        return histories | {"invariants": Invariants(*recorded, *changes)}


def response_of(
    run: Run,
    step_errors: StepErrors,
    name: str,
    progress: Progress = None,
    *,
    axes_of: AxesOf = axes_result,
    known: Known = MappingProxyType({}),
) -> Response:
    """Response at the results' times through spin-up, flight and spin-down, with errors and warnings.

    The displacements of bodies that are `known` are not computed again.
    """
    posed, traced, entire = run.posed, run.traced, run.trajectory
    subject, system, settings = posed.subject, posed.system, posed.settings
    motion, read = subject.motion, Histories.from_run(run, name, known)
    time = read.time[read.recorded]
    bodies = {body: read.body(body) for body in system.flexible}
    base = None if posed.motion is None else posed.motion.base(time)
    axes = None if traced or not isinstance(motion, Centrifuge) else axes_of(motion, time)
    outcome, message, errors, warnings = "done", "", Errors(), tuple[str, ...]()
    if not traced:
        unladen = {body: answer for body, answer in bodies.items() if answer.q.size and body not in system.laden}
        free = {body: (answer.base, answer.q) for body, answer in unladen.items()}
        ending = ending_of(run, free, time)
        outcome, message, from_run = ending.outcome, ending.message, ending.warnings
        if ending.done:
            from_run += stressed_and_bent(run, bodies)
            errors, of_bodies = run.errors(step_errors, read.reading(bodies), progress)
            advice = integrator_advice(settings, len(run.flight.time) - 1, run.stride)
            from_run += of_bodies + inaccuracies(run, errors) + advice
        root = bodies[subject.body].base if subject.body in bodies else None
        inputs = subject.doubts(name, root, span=(time[0], time[-1]))
        warnings = inputs + settings.warnings + run.doubts + from_run + (() if axes is None else axes.warnings)
    flown = motion.flight if isinstance(motion, Centrifuge) else motion
    span = settings.start, settings.start + settings.duration
    felt_at_steps = None
    if read.spacing < run.stride and settings.loads and not traced:
        felt_at_steps = read.time[read.flown], read.over_time["acceleration"][read.flown]
    return Response(
        name=name,
        environment=kind_of(motion),
        outcome=outcome,
        message=message,
        warnings=tuple(dict.fromkeys(warnings)),
        notes=notes_on({name: motion}),
        time=time,
        points=system.points,
        coordinates=system.coordinates,
        units=units_of(system),
        bodies=bodies,
        base=base,
        loop=None if run.loop is None else run.loop.select_times(read.steps[read.recorded]),
        hub=read.hub(base, bodies),
        axes=axes,
        assembly=assembly_of(system) if settings.loads and not traced else None,
        initial=begun_in_words(system, settings.begin),
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(entire.time) - 1,
        error_estimate=_stated(run, errors, outcome),
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        residual_amplitude=read.residual,
        maxima=None if traced else maxima_of(system, read.time[read.flown], _during(read.over_time, read.flown)),
        whole=flown.part_of(*span) if isinstance(flown, Flight) else None,
        scale=level_factor(motion),
        ends={} if traced else ends_of(system),
        kept_every=settings.kept_every(len(time), float(time[-1] - time[0]) / max(len(time) - 1, 1)),
        felt_at_steps=felt_at_steps,
        **read.sampled(),
    )


def _stated(run: Run, errors: Errors, outcome: str) -> float:
    """Total error of the displacement; that of the steps alone where a body cannot be judged."""
    total, step = errors.displacement.total, errors.displacement.step
    system = run.posed.system
    judged = len(judged_bodies(system)) == len(system.flexible)
    stepped = run.posed.settings.estimate and outcome == "done" and not judged
    return step if stepped and math.isnan(total) else total


def _change(history: Floats, parts: Floats | None = None) -> float:
    """Largest change of a history (t, ...) from its start, over its largest size or that of its parts."""
    size = np.abs(history if parts is None else parts).max(initial=0.0)
    return float(np.abs(history - history[0]).max(initial=0.0) / size) if size > 0 else 0.0


def _during(over_time: Mapping[str, Any], part: Any) -> dict[str, Any]:
    """Histories at some of their times, by key."""
    return {key: values[part] for key, values in over_time.items()}
