"""Runs of systems: a trajectory by steps of one length, and what the choice of steps, errors and the response read."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.beam_theory import largest
from gbeam.analysis.accuracy.correction import DEFLECTION, LOADS, PLACE, Quantity, Reading, pieces
from gbeam.analysis.accuracy.estimate import NOTHING, UNMOVED
from gbeam.analysis.response.contacts import creeping, half_turn_warnings, missed_stop
from gbeam.analysis.response.peaks import peaks_of_coordinates
from gbeam.analysis.response.posed import Posed, begun
from gbeam.analysis.response.step_errors import difference
from gbeam.analysis.system.accuracy import UNSMOOTHED, system_errors, unjudged, unmoved
from gbeam.analysis.system.feedback import SystemControllers, loop_of
from gbeam.analysis.system.histories import Carried, deflections, held_loads, histories, loads_of
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.richer_readings import Starting
from gbeam.analysis.system.solution import Solution
from gbeam.analysis.system.start import unknown_at_start
from gbeam.arrays.namespace import holds_jax, is_jax, namespace
from gbeam.arrays.types import Floats, Indices
from gbeam.integrate.equations import Trajectory, masses
from gbeam.mechanics.causes import causes_of, loads_at
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import moments_of
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.linear import is_linear
from gbeam.mechanics.tree.signal_names import local_names
from gbeam.mechanics.tree.steps import remove_sign_jumps
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import positive_definite
from gbeam.progress import Progress, tell
from gbeam.results.errors import Errors, StepErrors
from gbeam.results.system import Loop

LONG = 3_000  # steps: more of them follow deflections of several bodies within the tolerance only
LOOKS = 30  # steps of a run at which its mass matrix is checked


@dataclass(frozen=True)
class Run:
    """A trajectory of a system, the length of its steps in the flight, s, and the problem that was run."""

    trajectory: Trajectory
    step: float
    posed: Posed

    @classmethod
    def by_steps(cls, posed: Posed, step: float, progress: Progress = None) -> Run:
        """Run a problem by steps of a length, s."""
        return cls(posed.integrated(step, progress=progress), step, posed)

    @property
    def stride(self) -> int:
        """Number of steps of the flight in one step of the results."""
        return 1 if self.posed.settings.step is not None else max(1, round(self.posed.result_step / self.step))

    @property
    def reached_end(self) -> bool:
        """True if the run came to its end."""
        return self.trajectory.reached_end

    @cached_property
    def traced(self) -> bool:
        """True if its arrays are JAX's, or what it follows from is."""
        return is_jax(self.trajectory.q) or self.posed.system.holds_jax or holds_jax(self.posed.subject.motion)

    @property
    def in_flight(self) -> slice:
        """The steps of the flight; all where a machine's spin-up failed before it."""
        steps_before, count, _ = self.posed.counts(self.step)
        return (
            slice(steps_before, steps_before + count + 1)
            if len(self.trajectory.time) > steps_before + 1
            else slice(0, None)
        )

    @cached_property
    def flight(self) -> Trajectory:
        """The trajectory over the flight's times."""
        return self.trajectory.select(self.in_flight)

    def recorded_steps(self, stride: int) -> Indices:
        """Indices of the steps of spin-up and spin-down, and of every `stride`-th of the flight."""
        steps, flight = np.arange(len(self.trajectory.time)), self.in_flight
        inside = steps[flight]
        later_steps = steps[flight.stop :] if flight.stop is not None else inside[:0]
        return np.concatenate([steps[: flight.start], inside[::stride], later_steps])

    def flight_slice(self, stride: int) -> slice:
        """Slice of the flight among the :meth:`recorded_steps`."""
        return slice(self.in_flight.start, self.in_flight.start + len(self.flight.time[::stride]))

    def _flight_steps(self, stride: int) -> Indices:
        """Indices of every `stride`-th step of the flight."""
        return np.arange(len(self.trajectory.time))[self.in_flight][::stride]

    @property
    def deforming(self) -> dict[str, Structure]:
        """Bodies that have coordinates, by name."""
        return {name: body for name, body in self.posed.system.flexible.items() if body.size}

    @cached_property
    def bends(self) -> bool:
        """True if the force law of a joint has corners within steps, so that errors do not fall by an order."""
        return any(joint.holder.bends for joint in self.posed.system.joints.values())

    def aims(self, aim: float, enough: float) -> list[float]:
        """Errors of each history of :attr:`displacements` at which automatic steps aim.

        In long runs of several bodies `enough` is the aim for deflections: small ones that commands or blows make ring
        would need many times the steps.
        """
        count = sum(kind == DEFLECTION for _, kind in self._moving_quantities)
        of_deflections = aim if count < 2 or len(self.flight.time) <= LONG else enough
        return [of_deflections if kind == DEFLECTION else aim for _, kind in self._moving_quantities]

    @property
    def _moving_quantities(self) -> list[Quantity]:
        """Quantities of :attr:`displacements`: deflections of bodies, and places where joints move or shift."""
        deforming = [(name, DEFLECTION) for name in self.deforming]
        jointed = any(link.steps for link in self.posed.system.tree.links)
        return [*deforming, PLACE] if jointed else deforming

    @cached_property
    def displacements(self) -> list[Floats]:
        """Displacements (t, 3 p) m over the flight: of each flexible body's points relative to its root, and of all
        points from their first places.

        A rigid body without points off its root has three more. Displacements that are rounding are zero.
        """
        solution, histories = self.solution(1), list[Floats]()
        for name, kind in self._moving_quantities:
            if kind == DEFLECTION:
                body = self.posed.system.flexible[name]
                bent = deflections(body, self.flight.q[:, self.posed.columns(name)])
                histories.append(np.zeros_like(bent) if largest(bent) <= UNMOVED * body.length else bent)
                continue
            places = np.concatenate([solution.read(())[PLACE], solution.turning()], axis=1)
            moved = places - places[0]
            histories.append(np.zeros_like(moved) if unmoved(np.abs(moved).max(initial=0.0), places) else moved)
        return [np.asarray(history).reshape(len(history), -1) for history in histories]

    @cached_property
    def peaks(self) -> list[Floats]:
        """Peaks (4,), over the flight, of the displacement of the end of each flexible body, relative to its root, and
        of the moment there by its elastic forces.
        """
        flight, peaks = self.flight, list[Floats]()
        for name, body in self.deforming.items():
            for vector in (_tip, _moment):
                measured = partial(vector, body, self.posed.columns(name))
                peaks.append(peaks_of_coordinates(flight, measured(flight.q), measured))
        return peaks

    def loads(self, stride: int) -> list[Floats]:
        """Root force and moment (t, 3) and stress of every flexible body, at every `stride`-th step of the flight.

        Force and moment are zero where they are rounding. The stress is that at every section (t, s, 1), or a solid's
        (t, c).
        """
        histories, solution = list[Floats](), self.solution(stride)
        for name, state in solution.states(self.deforming)[1].items():
            body = self.posed.system.flexible[name]
            loads = loads_of(body, state, solution.trajectory.time)
            force, moment = held_loads(loads)
            sizes = np.abs(force).max() * body.length, np.abs(moment).max()
            histories += [force * (sizes[0] > NOTHING * sizes[1]), moment * (sizes[1] > NOTHING * sizes[0])]
            sides = [loads.stress_tension, loads.stress_compression]
            if loads.von_mises is not None and np.isfinite(loads.von_mises).all():
                sides.append(loads.von_mises)  # under torsion alone the normal stresses are rounding
            stress = np.concatenate(sides, axis=1)[..., None]
            if body.recovery is not None:
                applied = loads_at(body, solution.trajectory.time)
                stress = np.asarray(body.recovery.felt(causes_of(body, state.q, applied)))
            histories.append(stress)
        return histories

    def _step_errors(self, errors: StepErrors) -> dict[Quantity, float]:
        """Errors of the steps by quantity. Root force and moment of a body have the larger of their two errors."""
        by_step = dict.fromkeys([PLACE, *((name, DEFLECTION) for name in self.deforming)], errors.displacement)
        by_step |= dict(zip(self._moving_quantities, errors.moved, strict=False))
        rigid = self.posed.system.flexible.keys() - self.deforming.keys()
        by_step |= dict.fromkeys([(name, load) for name in rigid for load in LOADS[:2]], errors.loads)
        for k, (name, body) in enumerate(self.deforming.items()):
            force, moment, stress = errors.each[3 * k : 3 * k + 3] or (math.nan,) * 3
            by_step |= dict.fromkeys([(name, "force"), (name, "moment")], max(force, moment))
            by_step |= {(name, "stress"): stress} if _stressed(body) else {}
        return by_step

    def errors(
        self, of_steps: StepErrors, computed: Reading | None, progress: Progress = None
    ) -> tuple[Errors, tuple[str, ...]]:
        """Errors of the response over the flight's times, and warnings.

        They follow from the errors `of_steps` and from the readings that are `computed`, which are read if None.
        Warnings are of masses off the axis of a beam, and of controllers that lose what has more shapes.
        """
        posed, settings = self.posed, self.posed.settings
        of_steps = StepErrors() if self.event_warnings else of_steps  # unknown where steps may miss a stop
        by_step, say = self._step_errors(of_steps), "errors of shapes and models"
        if not (settings.estimate and self.reached_end):
            return unjudged(posed.system, by_step, note=settings.not_estimated), ()

        judged = self._resolved_run if posed.system.controllers else self

        def rerun(system: System) -> Solution:
            """Run another system by the same steps."""
            run = Run.by_steps(posed.replace_system(system), judged.step, partial(tell, progress, say))
            return run.solution(judged.stride)

        tell(progress, say, 0.0)
        of_loads = [(name, load) for name in self.deforming for load in LOADS]
        rubbed = self._friction_errors(partial(tell, progress, "errors of the smooth law of friction"))
        friction = dict(zip((*self._moving_quantities, *of_loads), rubbed, strict=False))
        details: Any = {"peaks_by_step": dict(zip(of_loads, of_steps.peaks, strict=False)), "friction": friction}
        details |= {"stride": judged.stride, "tolerance": settings.tolerance, "starting": self._starting}
        details |= {"computed": computed if judged is self else None}
        by_runs = rerun if posed.system.controllers else None
        stated, doubts = system_errors(judged.solution, by_runs, by_step, **details)
        if not friction and posed.system.rubbing:
            stated = replace(stated, note="; ".join(filter(None, (stated.note, UNSMOOTHED))))
        if posed.system.controllers:
            from gbeam.analysis.steady.loop_errors import unstable_richer_loop  # takes SciPy's linear algebra

            doubts += unstable_richer_loop(posed.system, posed.motion, settings.start)
        tell(progress, say, 1.0)
        return stated, doubts

    @property
    def _resolved_run(self) -> Run:
        """Run by the steps of the results, with which richer systems in a loop are compared.

        Steps that resolve what rings in the loads would cost many times as much, and leave the differences of shapes
        and models as they are.
        """
        if self.stride == 1:
            return self
        rough = Run.by_steps(self.posed, self.posed.result_step)
        return rough if rough.reached_end else self

    @property
    def _starting(self) -> Starting | None:
        """Start of richer systems, or None where all is in equilibrium with a motion that is prescribed."""
        posed, begin = self.posed, self.posed.settings.begin
        jointed = len(posed.system.tree.unknowns) > sum(body.size for body in self.deforming.values())
        if not jointed and (posed.steps_before or begin.settled):
            return None

        def state(other: System) -> tuple[Floats, Floats]:
            start = begun(replace(posed.subject, system=other), posed.settings, posed.settings.start)
            return start.y, start.yd

        flags = partial(unknown_at_start, initial=begin.state)
        return Starting(flags, state if begin.displaces or posed.subject.body else None)

    def _friction_errors(self, progress: Progress) -> list[float]:
        """Errors by the smooth law of friction, of :attr:`displacements` and of :meth:`loads`.

        They are proportional to the rate below which the law is smooth, and follow from a run with half of that rate,
        or with twice where this fails. The list is empty without friction, or where both fail.
        """
        if not self.posed.system.rubbing:
            return []
        for factor, share in ((0.5, 2.0), (2.0, 1.0)):  # of the rate, and of the difference that it makes
            comparison = Run.by_steps(replace(self.posed, slip=factor * self.posed.slip), self.step, progress)
            if comparison.reached_end:
                histories, other_histories = (
                    (*run.displacements, *run.loads(self.stride)) for run in (self, comparison)
                )
                return [share * difference(a, b, 1) for a, b in zip(other_histories, histories, strict=True)]
        return []

    @cached_property
    def loop(self) -> Loop | None:
        """Record of the controllers at the times of the run, or None without controllers."""
        controllers, samples = self.posed.controllers, self.trajectory.samples
        if controllers is None or samples is None or not samples.has_begun:
            return None
        return loop_of(controllers, samples, self.trajectory.time)

    @cached_property
    def without_mass(self) -> int | None:
        """Index of the first step looked at where M is not positive definite, or None. Second-order models may come to
        that where a joint carries little inertia but that of deformed bodies.
        """
        system, run = self.posed.system, self.trajectory
        if self.traced or is_linear(system.tree):  # whose M is that of the start
            return None
        if all(moments_of(link.body) is None for link in system.tree.links):
            return None
        steps = np.unique(np.linspace(0, len(run.time) - 1, LOOKS).astype(int))
        q, qd, zeros = run.q[steps], run.qd[steps], np.zeros_like(run.q[steps])
        if Point(system.tree, q[0], qd[0], zeros[0], self.inputs(system, steps[0])).minimal:
            mass = masses(system.tree, q, qd, self.inputs(system, steps))
        else:  # by Euler parameters it is singular
            states = ((q[k], qd[k], zeros[k], self.inputs(system, step)) for k, step in enumerate(steps))
            mass = np.array([Point(system.tree, *state).local.slopes()[3] for state in states])
        if positive_definite(mass):
            return None
        return next(int(step) for step, m in zip(steps, mass, strict=True) if not positive_definite(m))

    @cached_property
    def event_warnings(self) -> tuple[str, ...]:
        """Warning of a stop that the steps may miss, or empty if there is none."""
        return missed_stop(self.posed.system, self.trajectory, lambda: self.all_inputs)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings of stops, of springs that a ball turns over, and of friction that lets creep."""
        system, run = self.posed.system, self.trajectory
        half_turns = half_turn_warnings(system, run, lambda: self.all_inputs)
        return self.event_warnings + half_turns + creeping(system, run, lambda: self.all_inputs, self._inertia)

    def _inertia(self, name: str, step: int) -> float:
        """Inertia, kg or kg m², that an effort on a local coordinate accelerates at a step, the others being free."""
        system, run = self.posed.system, self.trajectory
        state = run.q[step], run.qd[step], 0 * run.q[step]
        local, names = Point(system.tree, *state, self.inputs(system, step)).local, local_names(system.coordinates)
        k = [names[unknown] for unknown in local.tree.unknowns].index(name)
        return float(1 / np.linalg.inv(local.slopes()[3])[k, k])

    @cached_property
    def all_inputs(self) -> Inputs:
        """Inputs at all steps."""
        return self.inputs(self.posed.system, slice(None))

    def inputs(self, system: System, steps: Any) -> Inputs:
        """Return the inputs of a `system` at an index or slice of the steps.

        It is the run's system, or another one with the same controllers.
        """
        plain = system.inputs(self.trajectory.time[steps], self.posed.motion)
        return plain if self.loop is None else SystemControllers(system).add_commands(plain, self.loop.applied[steps])

    def solution(self, stride: int) -> Solution:
        """Solution at every `stride`-th step of the flight."""
        steps = self._flight_steps(stride)
        return Solution(
            self.posed.system, self.trajectory.select(steps), lambda system, times: self.inputs(system, steps[times])
        )

    def histories(self, steps: Indices) -> tuple[dict[str, Any], dict[str, Carried]]:
        """Histories by key at indices of the steps, and the state of each flexible body by name."""
        system, inertial = self.posed.system, self.posed.motion is None
        columns, bodies = dict[str, list[Floats]](), {name: list[Carried]() for name in system.flexible}
        for part in pieces(len(steps), system.tree.size):  # for memory: all frames of a part are held at once
            state, inputs = self.trajectory.select(steps[part]), self.inputs(system, steps[part])
            values, of_bodies = histories(system, state.q, state.qd, state.qdd, inputs, inertial=inertial)
            for key, value in values.items():
                columns.setdefault(key, []).append(value)
            for name, of_body in of_bodies.items():
                bodies[name].append(of_body)
        over_time = {key: namespace(*values).concatenate(values) for key, values in columns.items()}
        over_time |= {"attitude": remove_sign_jumps(over_time["attitude"])}
        return over_time, {name: Carried.joined(of_body) for name, of_body in bodies.items()}


def _tip(body: Structure, columns: slice, y: Floats) -> Floats:
    """Displacement (..., 3) m of the end of a body. Components that are rounding, as under a torque alone, are zero."""
    tip = np.asarray(body.tip(y[..., columns]))
    return np.where(np.abs(tip) > UNMOVED * body.length, tip, 0.0)


def _moment(body: Structure, columns: slice, y: Floats) -> Floats:
    """Root moment (..., 3) N m of a straight body, or zero where it does not bend.

    It is the moment of the inertia that balances the elastic forces K q.
    """
    c = body.coefficients
    moment = np.asarray(y[..., columns] @ (c.f_al @ np.linalg.solve(c.mass, c.stiffness)).T)
    return np.where(np.any(_tip(body, columns, y), axis=-1, keepdims=True), moment, 0.0)


def _stressed(body: Structure) -> bool:
    """True if a body has a stress: of sections, or of a solid."""
    return bool(body.size) and (body.sections is not None or body.recovery is not None)
