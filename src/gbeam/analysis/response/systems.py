"""Runs of a system, and the response that one leaves, with its errors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.beam_theory import largest
from gbeam.analysis.accuracy.correction import DEFLECTION, LOADS, PLACE, Quantity, pieces
from gbeam.analysis.accuracy.estimate import UNMOVED
from gbeam.analysis.outline import assembly_of, outline_of
from gbeam.analysis.response.outcome import yielding
from gbeam.analysis.response.peaks import half_ranges, load_peaks, system_peaks
from gbeam.analysis.response.posed_system import (
    PosedSystem,
    begun_in_words,
    corners,
    first_step,
    refuse_long,
    state_at,
    with_ends,
)
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import difference
from gbeam.analysis.response.stepping import LOADS_STEPS, scheme_of, steps_to_try
from gbeam.analysis.system.accuracy import UNSMOOTHED, Starting, doubts, system_errors, unjudged, unmoved
from gbeam.analysis.system.feedback import SystemControllers, loop_of
from gbeam.analysis.system.histories import Carried, beams_of, deflection, deflections, histories, loads_of, meshes_of
from gbeam.analysis.system.initial import on_bodies
from gbeam.analysis.system.point import Point, in_words, started, started_traced, unknown_at_start
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.solution import Solution
from gbeam.analysis.system.steady import MASSLESS, bent_most, massless
from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.integrate.equations import Trajectory, masses
from gbeam.mechanics.tree.bodies import LinearBody
from gbeam.mechanics.tree.equations import SLIP, SLIPS, STUCK, Inputs, Link
from gbeam.mechanics.tree.joints import SLIDES, SPIN, Joint
from gbeam.mechanics.tree.signals import local_names, unit_of_effort, units_of
from gbeam.mechanics.tree.steps import continuous
from gbeam.mechanics.tree.system import System
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.protocol import Motion, level_factor, notes_on
from gbeam.numerics.eigen import positive_definite
from gbeam.numerics.series import STEP
from gbeam.progress import Progress, tell
from gbeam.results.errors import Errors, StepErrors
from gbeam.results.parts import Loads
from gbeam.results.system import BeamResponse, Invariants, Loop, SystemResponse
from gbeam.structure.beam import names_at

LONG = 3_000  # steps: more of them follow deflections within the tolerance only
LOOKS = 30  # steps of a run at which its mass matrix is checked
BEYOND = 1e-8  # of a coordinate's range: a stop is not met by less
STOPPED = 10  # times in which friction alone would stop a coordinate: held is what is slow for longer
LITTLE = 1e-3  # of a coordinate's way: less is no creep

Prepared = tuple[Motion | None, ResponseSettings]


@dataclass(frozen=True)
class SystemRun(Run):
    """A run of a system."""

    posed: PosedSystem
    followed = False

    @classmethod
    def prepared(cls, system: System, motion: Motion | None, settings: ResponseSettings) -> Prepared:
        """The motion over the flight's times, and the settings; InputError for what systems lack."""
        system.require_damping("the response")
        if motion is not None:
            if motion.free:
                raise InputError("motion", "is a hub that turns freely", "give it as a body on a revolute joint")
            if system.gravity is not None:
                fix = "leave one out: a motion carries its own, as specific force"
                raise InputError("gravity", "is given beside a motion of the base", fix)
            motion = motion.over(settings.start, settings.start + settings.duration)
        on_bodies(system.flexible, (*settings.begin.displaced, *settings.begin.moving))  # raises what it refuses
        return motion, settings

    @classmethod
    def poses(cls, system: System, motion: Motion | None, settings: ResponseSettings) -> Iterator[PosedSystem]:
        """Yield the problem with each of the steps of results to try, the longest first."""
        point, bends = started(system, motion, settings.start, settings.begin), partial(corners, system, motion)
        for kept, limit in steps_to_try(first_step(point, bends, settings), LOADS_STEPS, bends, settings):
            ends = with_ends(motion, settings, settings.step or kept)
            refuse_long(system, ends, ends.step or kept)
            start = (point.y, point.yd) if ends.start == settings.start else state_at(system, motion, ends)
            yield PosedSystem(system, motion, ends, settings, start, kept, limit)

    @classmethod
    def by_steps(cls, posed: PosedSystem, step: float, progress: Progress = None) -> SystemRun:
        """Run the problem by steps of a length, s."""
        return cls(posed.integrated(step, corners=posed.felt, progress=progress), step, posed)

    @classmethod
    def traced(
        cls, system: System, motion: Motion | None, settings: ResponseSettings, step: float, name: str
    ) -> SystemResponse:
        """Response traced by JAX, by given steps: no branch depends on its values."""
        ends = with_ends(motion, settings, step)
        start = started_traced(system, motion, ends.start, settings.begin)
        refuse_long(system, ends, step)
        posed = PosedSystem(system, motion, ends, settings, start, step)
        return _described(cls(posed.integrated(step, corners=posed.commands), step, posed), Errors(), name)

    def described(self, errors: StepErrors, name: str, progress: Progress = None) -> SystemResponse:
        """Return the response, with the errors beyond those of the time steps if the settings ask for an estimate."""
        posed, settings, warnings = self.posed, self.posed.settings, self.missed + self.turned_over + self.crept
        errors = StepErrors() if self.missed else errors  # unknown where steps may miss a stop
        say = "errors of shapes and models"

        def again(system: System) -> Solution:
            return SystemRun.by_steps(posed.of(system), self.step, partial(tell, progress, say)).every(self.stride)

        by_step = dict(zip(self._moving, errors.moved, strict=False))
        stated = unjudged(posed.system, by_step, note=settings.not_estimated)
        if settings.estimate and self.whole:
            tell(progress, say, 0.0)
            of_loads = [(body, load) for body in judged_bodies(posed.system) for load in LOADS]
            peaks_by_step = dict(zip(of_loads, errors.peaks, strict=False))
            by_step |= dict(zip(of_loads, errors.each, strict=False))
            starting = Starting(partial(unknown_at_start, initial=settings.begin.state))
            if settings.begin.displaces:
                starting = replace(starting, state=lambda other: state_at(other, posed.motion, settings))
            rerun = again if posed.system.controllers else None
            rubbed = self._of_friction(partial(tell, progress, "errors of the smooth law of friction"))
            friction = dict(zip((*self._moving, *of_loads), rubbed, strict=False))
            more: Any = {"peaks_by_step": peaks_by_step, "starting": starting, "friction": friction}
            more |= {"stride": self.stride, "tolerance": settings.tolerance}
            stated, off_axis = system_errors(self.every, rerun, by_step, **more)
            warnings += off_axis
            if not friction and posed.system.rubbing:
                stated = replace(stated, note="; ".join(filter(None, (stated.note, UNSMOOTHED))))
            if rerun is not None:
                from gbeam.analysis.steady.loop_errors import unstable_with_more  # takes SciPy's linear algebra

                warnings += unstable_with_more(posed.system, posed.motion, posed.flight.start)
        return _described(self, stated, name, warnings)

    def _of_friction(self, progress: Progress) -> list[float]:
        """Errors by the smooth law of friction, of :attr:`moved` and of :meth:`loads`, which go as the rate below which
        it is smooth: by a run with half of that, or twice where this fails. Empty without friction, or where both fail.
        """
        for times, share in ((0.5, 2.0), (2.0, 1.0)) if self.posed.system.rubbing else ():
            other = SystemRun.by_steps(replace(self.posed, slip=times * self.posed.slip), self.step, progress)
            if other.whole:
                mine, others = ((*run.moved, *run.loads(self.stride)) for run in (self, other))
                return [share * difference(a, b, 1) for a, b in zip(others, mine, strict=True)]
        return []

    def aims(self, aim: float, enough: float) -> list[float]:
        """Errors of each history that :attr:`moved` at which automatic steps aim; of deflections `enough` in long runs,
        where small bodies that commands or blows make ring would need many times the steps.
        """
        of_deflections = aim if len(self.trajectory.time) <= LONG else enough
        return [of_deflections] * (len(self.moved) - 1) + [aim]

    @cached_property
    def peaks(self) -> list[Floats]:
        """Empty: errors of the steps are estimated from the history of the points."""
        return []

    @cached_property
    def bends(self) -> bool:
        """True if the force law of a joint has corners within steps, as friction and stops."""
        return any(joint.holder.bends for joint in self.posed.system.joints.values())

    def loads(self, stride: int) -> list[Floats]:
        """Root force, root moment and stress of every body that can be judged, at every `stride`-th step."""
        beams = judged_bodies(self.posed.system)
        if not beams or not self.posed.settings.estimate:
            return []
        values = self.every(stride).read(beams)
        # A largest stress (t,) is a column, as a vector is a row.
        return [values[name, load].reshape(len(values[PLACE]), -1) for name in beams for load in LOADS]

    @cached_property
    def loop(self) -> Loop | None:
        """Record of the controllers at the times of the run; None without controllers."""
        controllers, samples = self.posed.controllers, self.trajectory.samples
        if controllers is None or samples is None or not samples.begun:
            return None
        return loop_of(controllers, samples, self.trajectory.time)

    @property
    def _moving(self) -> list[Quantity]:
        """Quantities of which :attr:`moved` has the histories."""
        return [*((name, DEFLECTION) for name in self.posed.system.flexible), PLACE]

    @cached_property
    def moved(self) -> list[Floats]:
        """Displacements (t, 3 p) m: of each flexible body's points relative to its root, and of all points from their
        first places, with three on each rigid body that has none off its root. Zero where they are rounding.
        """
        solution, histories = self.every(1), list[Floats]()
        for name, q in solution.deformed.items():
            body = self.posed.system.flexible[name]
            bent = deflections(body, q)
            histories.append(np.zeros_like(bent) if largest(bent) <= UNMOVED * body.length else bent)
        places = np.concatenate([solution.read(())[PLACE], solution.turning()], axis=1)
        moved = places - places[0]
        histories.append(np.zeros_like(moved) if unmoved(np.abs(moved).max(initial=0.0), places) else moved)
        return [np.asarray(each).reshape(len(places), -1) for each in histories]

    @cached_property
    def without_mass(self) -> int | None:
        """Index of the first step looked at where M is not positive definite, or None. Second-order models may come to
        that where a joint carries little inertia but that of deformed bodies.
        """
        system, run = self.posed.system, self.trajectory
        if is_jax(run.q) or not any(isinstance(link.body, LinearBody) for link in system.tree.links):
            return None
        steps = np.unique(np.linspace(0, len(run.time) - 1, LOOKS).astype(int))
        q, qd, still = run.q[steps], run.qd[steps], np.zeros_like(run.q[steps])
        if Point(system.tree, q[0], qd[0], still[0], self.inputs(system, steps[0])).minimal:
            mass = masses(system.tree, q, qd, self.inputs(system, steps))
        else:  # by Euler parameters it is singular
            states = ((q[k], qd[k], still[k], self.inputs(system, step)) for k, step in enumerate(steps))
            mass = np.array([Point(system.tree, *state).local.slopes()[3] for state in states])
        return next((int(step) for step, m in zip(steps, mass, strict=True) if not positive_definite(m)), None)

    @cached_property
    def missed(self) -> tuple[str, ...]:
        """Warning of a stop that the steps may miss; empty if there is none."""
        return _missed_stop(self.posed.system, self.trajectory, self.driven)

    @cached_property
    def turned_over(self) -> tuple[str, ...]:
        """Warning of springs that a ball's turn of more than 180° makes pull the other way; empty if none do."""
        return _turned_over(self.posed.system, self.trajectory, self.driven)

    @cached_property
    def crept(self) -> tuple[str, ...]:
        """Warnings of coordinates that creep, or are driven, at rates at which friction has less than its size."""
        system, run, warnings = self.posed.system, self.trajectory, list[str]()
        if not any(joint.frictions for joint in system.joints.values()):
            return ()
        for name, joint, link, q, qd in _states(system, run, self.driven):
            values, rates = link.held(q, qd)
            for kind, friction in joint.frictions.items():
                k, driven, step = joint.rate_names.index(kind), kind in joint.rates, np.diff(run.time)
                rate = rates[:, k]
                mean = (rate[1:] + rate[:-1]) / 2 if kind in SPIN else np.diff(values[:, k]) / step
                limit = SLIP if driven else STUCK
                # Rates at the ends of steps ring about the creep by as much as its size.
                slow = (np.abs(mean) < limit) & (np.maximum(np.abs(rate[1:]), np.abs(rate[:-1])) < 2 * limit)
                ends = np.flatnonzero(np.diff(slow, prepend=False, append=False)).reshape(-1, 2)
                if not driven and ends.size:
                    # Friction stops an inertia in a few times m v/F; what turns back is slow for a shorter while.
                    inertia = self._inertia(f"{name}.{joint.values[k]}", int(ends[0, 0]))
                    lasting = np.diff(run.time[ends])[:, 0] > STOPPED * inertia * STUCK / friction
                    ends = ends[lasting]
                moved = np.append(0.0, np.cumsum(mean * step))
                way = sum(float(np.ptp(moved[first : last + 1])) for first, last in ends)
                if way > LITTLE * np.abs(mean * step).sum():
                    felt = max(float(np.abs(mean[first:last]).max()) for first, last in ends)
                    sizes = way, float(np.diff(run.time[ends]).sum()), friction * math.tanh(felt / SLIP), friction
                    warnings.append(_creeping(f"{name}.{kind}", *sizes, driven=driven))
        return tuple(warnings)

    def _inertia(self, name: str, step: int) -> float:
        """Inertia, kg or kg m², that an effort on a local coordinate accelerates at a step, the others being free."""
        system, run = self.posed.system, self.trajectory
        state = run.q[step], run.qd[step], 0 * run.q[step]
        local, names = Point(system.tree, *state, self.inputs(system, step)).local, local_names(system.coordinates)
        k = [names[each] for each in local.tree.free].index(name)
        return float(1 / np.linalg.inv(local.slopes()[3])[k, k])

    @cached_property
    def driven(self) -> Inputs:
        """Inputs at all steps."""
        return self.inputs(self.posed.system, slice(None))

    def inputs(self, of: System, steps: Any) -> Inputs:
        """Inputs, at an index or slice of the steps, of its system or of another one with the same controllers."""
        plain = of.inputs(self.trajectory.time[steps], self.posed.motion)
        return plain if self.loop is None else SystemControllers(of).driven(plain, self.loop.applied[steps])

    def every(self, stride: int) -> Solution:
        """Solution at every `stride`-th step."""
        steps = np.arange(len(self.trajectory.time))[::stride]
        return Solution(self.posed.system, self.trajectory.at(steps), lambda of, times: self.inputs(of, steps[times]))

    def histories(self, steps: Any, *, loads: bool) -> tuple[dict[str, Any], dict[str, Loads]]:
        """Histories by key at an index or slice of the steps and, if `loads`, the loads along each beam by name."""
        system, inertial = self.posed.system, self.posed.motion is None
        chosen = np.arange(len(self.trajectory.time))[steps]
        columns, beams = dict[str, list[Floats]](), dict[str, list[Carried]]()
        for part in pieces(len(chosen), system.tree.size):  # for memory: all frames of a part are held at once
            at, inputs = self.trajectory.at(chosen[part]), self.inputs(system, chosen[part])
            values, carried = histories(system, at.q, at.qd, at.qdd, inputs, inertial=inertial)
            for key, value in values.items():
                columns.setdefault(key, []).append(value)
            for name, beam in carried.items():
                beams.setdefault(name, []).append(beam)
        time = self.trajectory.time[chosen]
        along = {name: loads_of(beams_of(system)[name], parts, time) for name, parts in beams.items() if loads}
        over_time = {key: namespace(*values).concatenate(values) for key, values in columns.items()}
        return over_time | {"attitude": continuous(over_time["attitude"])}, along


def _creeping(name: str, way: float, time: float, felt: float, friction: float, *, driven: bool) -> str:
    """Warning of a coordinate that moves by a `way`, m or rad, where friction, N or N m, is felt in part."""
    kind = name.rpartition(".")[2]
    far, smooth = in_words(kind, way), f"friction is smooth below {SLIPS[kind not in SLIDES]}"
    share = f"{felt:.4g} of {friction:.4g} {unit_of_effort(kind)} at most"
    if driven:
        return f"{name} moves by {far} in {time:.4g} s so slowly that its drive feels {share}: {smooth}"
    held = f"{name} creeps by {far} in {time:.4g} s in which friction would hold it with {share}"
    return f"{held}: {smooth}; rate = 0 holds what should not move"


def _states(
    system: System, run: Trajectory, inputs: Inputs
) -> Iterator[tuple[str, Joint, Link, list[Floats], list[Floats]]]:
    """Yield name, joint, link, and coordinates and rates of its steps over the times of a run, of every joint with
    springs, dampers, friction or stops.
    """
    states = [run.q, run.qd]
    if inputs.prescribed is not None:
        states = [system.tree.whole(state, inputs.prescribed[..., k, :]) for k, state in enumerate(states)]
    names = {joint.body: name for name, joint in system.joints.items()}
    by_link = zip(*system.tree.parted(*states), strict=True)
    for body, link, (q, qd) in zip(system.order, system.tree.links, by_link, strict=True):
        if not link.loose:
            yield names[body], system.joints[names[body]], link, q[:-1], qd[:-1]  # the last are the body's own


def _held(system: System, run: Trajectory, inputs: Inputs) -> Iterator[tuple[str, Joint, Floats, Floats]]:
    """Yield name, joint, held coordinates (t, h) over the times of a run and their rates; of a ball the rotation vector
    is held.
    """
    for name, joint, link, q, qd in _states(system, run, inputs):
        # Rates are derivatives along time, by a complex step.
        ahead = [value + 1j * STEP * rate for value, rate in zip(q, qd, strict=True)]
        values, further = (link.held(of_joint, qd)[0] for of_joint in (q, ahead))
        yield name, joint, values, further.imag / STEP


def _missed_stop(system: System, run: Trajectory, inputs: Inputs) -> tuple[str, ...]:
    """Warn of a stop that a coordinate meets and leaves between two times of a run, so that the steps may miss it."""
    if len(run.time) < 2 or not any(np.any(joint.holder.stop) for joint in system.joints.values()):
        return ()
    from scipy.interpolate import CubicHermiteSpline  # which takes a while to import

    for name, joint, values, rates in _held(system, run, inputs):
        held = zip(joint.values, values.T, rates.T, joint.holder.low, joint.holder.high, strict=True)
        for value, q, qd, low, high in held:
            for sign, end in ((1.0, high), (-1.0, -low)):
                if not np.isfinite(end):
                    continue
                between = CubicHermiteSpline(run.time, sign * q, sign * qd)
                turns = between.derivative().roots(extrapolate=False)
                step = np.clip(np.searchsorted(run.time, turns, side="right") - 1, 0, len(q) - 2)
                ends = sign * q[step], sign * q[step + 1]
                beyond = (between(turns) > end + BEYOND * np.ptp(q)) & (np.abs(np.subtract(*ends)) < math.pi)
                missed = turns[beyond & (np.minimum(*ends) <= end)]
                if missed.size:
                    words = f"{name}.{value} meets a stop and leaves it within one step, at {missed[0]:.4g} s"
                    return (f"{words}: the steps may miss it, and their error is not known; give a smaller step",)
    return ()


def _turned_over(system: System, run: Trajectory, inputs: Inputs) -> tuple[str, ...]:
    """Warn of a ball that turns beyond 180°, from where its springs and stops act in the opposite direction."""
    if not any(joint.holds_turns for joint in system.joints.values()):
        return ()
    for name, joint, values, _ in _held(system, run, inputs):
        jumps = np.linalg.norm(np.diff(values[:, -3:], axis=0), axis=1) > math.pi
        if joint.holds_turns and jumps.any():
            words = (
                f"{name} turns by more than half a turn, at {run.time[int(jumps.argmax())]:.4g} s, and from there its"
            )
            return (f"{words} springs and stops hold it the other way round; let a revolute joint turn it so far",)
    return ()


def _described(run: SystemRun, errors: Errors, name: str, warnings: tuple[str, ...] = ()) -> SystemResponse:
    """Response at all steps; the residual vibration is measured over the flight's times alone."""
    trajectory, stride, system, motion = run.trajectory, run.stride, run.posed.system, run.posed.motion
    settings, flight = run.posed.settings, run.posed.flight
    time, traced = trajectory.time, is_jax(trajectory.q)
    over_time, along = run.histories(slice(None), loads=settings.loads)
    beams, yielded = dict[str, BeamResponse](), []
    for body, loads in along.items():
        beam = beams_of(system)[body]

        peaks = None if traced else load_peaks(loads, time)
        first = system.coordinates.index(f"{body}.q1")
        q = over_time["q"][:, first : first + beam.size]
        names = () if traced or beam.source is None else names_at(beam.source.beam, beam.stations)
        beams[body] = BeamResponse(loads, peaks, None if traced else outline_of(beam, None, time, q), names)
        yielded += yielding(peaks, f" of {body}")
    kind = "ground" if motion is None else motion.kind
    drawn = settings.loads and not traced
    solids, surfaces = meshes_of(system, time, over_time["q"], name, kind) if drawn else ({}, {})
    invariants = None
    if motion is None:
        invariants = Invariants(*(over_time.pop(key) for key in ("momentum", "angular_momentum", "energy")))
    base: Any = None if motion is None else motion.base(time)
    outcome, message = "done", ""
    if not trajectory.whole:
        outcome, end = "not converged", trajectory.time[-1]
        message = f"Newton's method failed at {end:.4g} s: give a smaller step, or look for what breaks there"
    if trajectory.failure is not None:
        outcome, message = trajectory.failure.outcome, str(trajectory.failure)
    if (step := run.without_mass) is not None:
        free = [system.coordinates[k] for k in system.tree.free]
        words = f"at {trajectory.time[step]:.4g} s, {massless(system, free, trajectory.q[step])}"
        if not trajectory.whole or bent_most(system, free, trajectory.q)[1] > 1:
            outcome, message = MASSLESS, words
        else:
            warnings += (f"{words}; what moves so grows without bound where steps resolve it",)
    warnings += (*settings.warnings, *yielded)
    of_errors = doubts(errors, settings.tolerance)
    warnings += tuple(warning for warning in of_errors if warning not in warnings) + system.warnings
    warnings += () if traced else run.every(1).left_out
    residual: Any = None
    if settings.residual_from is not None:
        # Points of flexible bodies vibrate about their roots, others about the ground.
        relative = (deflection(system, point, over_time["q"]) for point in system.points)
        moved = [over_time["place"][:, k] if bent is None else bent for k, bent in enumerate(relative)]
        all_points = namespace(*moved).concatenate(moved, axis=1)
        flown = time <= flight.start + flight.duration * (1 + 1e-9)
        residual = half_ranges(time[flown], all_points[flown], settings.residual_from).reshape(-1, 3)
    return SystemResponse(
        name=name,
        environment=kind,
        outcome=outcome,
        message=message,
        time=time,
        points=system.points,
        coordinates=system.coordinates,
        units=units_of(system),
        invariants=invariants,
        loop=run.loop,
        beams=beams,
        solids=solids,
        surfaces=surfaces,
        base=base,
        axes=axes_result(motion, time) if isinstance(motion, Centrifuge) else None,
        assembly=assembly_of(system) if drawn else None,
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(trajectory.time) - 1,
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        residual_amplitude=residual,
        kept_every=settings.kept_every(len(time), run.step, stride),
        peaks=None if traced else system_peaks(system, time, over_time),
        initial=begun_in_words(system, settings.begin),
        warnings=warnings,
        notes=notes_on({name: motion}),
        scale=level_factor(motion),
        **over_time,
    )
