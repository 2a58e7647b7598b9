"""Response of a system over time, with the error of its steps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import PLACE, pieces
from gbeam.analysis.outline import assembly_of, outline_of
from gbeam.analysis.response.outcome import yielding
from gbeam.analysis.response.peaks import half_ranges, load_peaks
from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import Run
from gbeam.analysis.response.stepping import (
    LOADS_STEPS,
    Plan,
    answered,
    enough,
    even_steps,
    integrated,
    planned,
    scheme_of,
    steps_beyond,
    steps_to_try,
)
from gbeam.analysis.system.accuracy import doubts, system_errors, unmoved
from gbeam.analysis.system.feedback import SystemControllers, loop_of
from gbeam.analysis.system.histories import Carried, beams_of, deflection, histories, loads_of, meshes_of
from gbeam.analysis.system.point import Point, started, started_traced
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.solution import Solution
from gbeam.analysis.system.steady import MASSLESS, bent_most, massless
from gbeam.arrays.namespace import Array, holds_jax, is_jax, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.limits import HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.equations import NonlinearEquations, Trajectory, slopes
from gbeam.integrate.sampled import Sampling
from gbeam.integrate.steps import Corners
from gbeam.mechanics.tree.bodies import LinearBody
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.joints import Joint
from gbeam.mechanics.tree.signals import units_of
from gbeam.mechanics.tree.steps import continuous
from gbeam.mechanics.tree.system import System
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.protocol import Motion
from gbeam.numerics.eigen import positive_definite
from gbeam.numerics.series import STEP
from gbeam.progress import Progress, tell
from gbeam.results.errors import ErrorEstimate, StepErrors, SystemErrors
from gbeam.results.parts import Loads
from gbeam.results.system import BeamResponse, Invariants, Loop, SystemResponse
from gbeam.structure.beam import names_at

LEAST = 500  # steps of the results at least
LOOKS = 30  # at the mass matrix of a run
LOADS = "force", "moment", "stress"  # of a beam, whose errors are estimated
BEYOND = 1e-8  # of a coordinate's range: less beyond a stop is no contact


@dataclass(frozen=True)
class PosedSystem:
    """A system on the ground or on a moving base, with the equations of its motion."""

    system: System
    motion: Motion | None

    @cached_property
    def equations(self) -> NonlinearEquations:
        """Its equations, with its controllers, if any, in the loop."""
        control = SystemControllers(self.system) if self.system.controllers else None
        drive = partial(self.system.inputs, motion=self.motion)
        return NonlinearEquations(self.system.tree, drive, control, None if control is None else [])

    def start(self, settings: ResponseSettings) -> Point:
        """State at the start."""
        return started(self.system, self.motion, settings.start, settings.begin.state)

    def corners(self, step: float) -> Floats:
        """Times that steps of a length should not pass unseen, s."""
        moved = [] if self.motion is None else [self.motion.corners(step)]
        return np.concatenate([self.system.corners(step), *moved])

    def jumps(self, settings: ResponseSettings, step: float) -> Corners:
        """Corners in a run of steps of about a length, and jumps of its controllers' commands."""
        end = settings.start + settings.duration
        felt = Corners.of(self.corners(step), self.equations.drive, settings.start, end)
        if self.equations.controllers is None:
            return felt
        commands = self.commands(settings).time
        commands = commands[np.abs(commands[:, None] - felt.time).min(axis=1, initial=np.inf) > 1e-9]
        both, jumps = np.append(felt.time, commands), np.append(felt.jump, np.ones(len(commands), dtype=bool))
        return Corners(np.sort(both), jumps[np.argsort(both)])

    def commands(self, settings: ResponseSettings) -> Corners:
        """Times at which its controllers sample and their commands jump."""
        if self.equations.controllers is None:
            return Corners(np.zeros(0), np.zeros(0, dtype=bool))
        times = self.equations.controllers.corners(settings.start, settings.start + settings.duration)
        times = np.unique(np.round(times, 12))
        return Corners(times, np.ones(len(times), dtype=bool))

    def run(self, settings: ResponseSettings, q: Array, qd: Array, step: float, **how: Any) -> SystemRun:
        """Integrate it from coordinates and rates."""
        trajectory = integrated(Problem(self.equations, q, qd, 0, True), settings, step, **how)
        sampling = self.equations.samplings[-1] if self.equations.samplings else None
        return SystemRun(trajectory, step, self, sampling, settings.estimate)


@dataclass(frozen=True)
class SystemRun(Run):
    """A run of a system, with the samples of its controllers, and whether its loads are to be judged."""

    posed: PosedSystem
    sampling: Sampling | None
    judged: bool
    followed = False

    @cached_property
    def peaks(self) -> list[Floats]:
        """None: the history of the points is judged."""
        return []

    @cached_property
    def bends(self) -> bool:
        """True if the law of a joint bends."""
        return any(joint.holder.bends for joint in self.posed.system.joints.values())

    def loads(self, stride: int) -> list[Floats]:
        """Force and moment at the root and the stress of every beam that can be judged, at every so many steps."""
        beams = judged_bodies(self.posed.system)
        if not beams or not self.judged:
            return []
        values = self.every(stride).read(beams)
        return [values[name, each] for name in beams for each in LOADS]

    @cached_property
    def loop(self) -> Loop | None:
        """Record of its controllers at its times."""
        controllers = self.posed.equations.controllers
        return None if self.sampling is None else loop_of(controllers, self.sampling, self.trajectory.time)

    @cached_property
    def moved(self) -> Floats:
        """Displacements of all points, and of three on each body whose points do not turn, side by side, (t, 3 p) m."""
        every = self.every(1)
        places = np.concatenate([every.read(())[PLACE], every.turning()], axis=1)
        moved = np.asarray((places - places[0]).reshape(len(places), -1))
        return np.zeros_like(moved) if unmoved(np.abs(moved).max(initial=0.0), places) else moved

    @cached_property
    def without_mass(self) -> int | None:
        """Step at which a motion is first seen to have no kinetic energy: energies that end at second order may have
        none where little inertia but that of deformed bodies is on a joint.
        """
        system, every = self.posed.system, self.trajectory
        if is_jax(every.q) or not any(isinstance(link.body, LinearBody) for link in system.tree.links):
            return None
        steps = np.unique(np.linspace(0, len(every.time) - 1, LOOKS).astype(int))
        q, qd, still = every.q[steps], every.qd[steps], np.zeros_like(every.q[steps])
        if Point(system.tree, q[0], qd[0], still[0], self.inputs(system, steps[0])).minimal:
            mass = slopes(system.tree, q, qd, still, self.inputs(system, steps))[2]
        else:  # of Euler parameters it is no matrix of energies
            each = ((q[k], qd[k], still[k], self.inputs(system, step)) for k, step in enumerate(steps))
            mass = np.array([Point(system.tree, *state).local.slopes()[3] for state in each])
        return next((int(step) for step, one in zip(steps, mass, strict=True) if not positive_definite(one)), None)

    @cached_property
    def missed(self) -> tuple[str, ...]:
        """Warning of a stop that its steps may miss."""
        return _missed_stop(self.posed.system, self.trajectory, self.inputs(self.posed.system, slice(None)))

    @cached_property
    def turned_over(self) -> tuple[str, ...]:
        """Warning of springs that hold a ball the other way round."""
        return _turned_over(self.posed.system, self.trajectory, self.inputs(self.posed.system, slice(None)))

    def inputs(self, of: System, steps: Any) -> Inputs:
        """Inputs at some of its steps of its system, or of another with the same controllers."""
        plain = of.inputs(self.trajectory.time[steps], self.posed.motion)
        return plain if self.loop is None else SystemControllers(of).driven(plain, self.loop.applied[steps])

    def every(self, stride: int) -> Solution:
        """Each `stride`-th of its steps."""
        steps = np.arange(len(self.trajectory.time))[::stride]
        return Solution(self.posed.system, self.trajectory.at(steps), lambda of, some: self.inputs(of, steps[some]))

    def histories(self, steps: Any, *, loads: bool) -> tuple[dict[str, Any], dict[str, Loads]]:
        """Histories at some of its steps, and loads along the beams by name."""
        system, inertial = self.posed.system, self.posed.motion is None
        chosen = np.arange(len(self.trajectory.time))[steps]
        columns, beams = dict[str, list[Floats]](), dict[str, list[Carried]]()
        for part in pieces(len(chosen), system.tree.size):  # of which all frames are held in memory at once
            at, inputs = self.trajectory.at(chosen[part]), self.inputs(system, chosen[part])
            values, carried = histories(system, at.q, at.qd, at.qdd, inputs, inertial=inertial)
            for key, value in values.items():
                columns.setdefault(key, []).append(value)
            for name, each in carried.items():
                beams.setdefault(name, []).append(each)
        time = self.trajectory.time[chosen]
        along = {name: loads_of(beams_of(system)[name], each, time) for name, each in beams.items() if loads}
        over_time = {key: namespace(*values).concatenate(values) for key, values in columns.items()}
        return over_time | {"attitude": continuous(over_time["attitude"])}, along


def simulate_system(
    system: System, motion: Motion | None, settings: ResponseSettings, name: str, progress: Progress = None
) -> SystemResponse:
    """Compute the response of a system on the ground or on a moving base."""
    settings = settings.chosen(free=True)
    if motion is not None:
        if motion.free:
            raise InputError("motion", "is a hub that turns freely", "give it as a body on a revolute joint")
        if system.gravity is not None:
            fix = "leave one out: a motion carries its own, as specific force"
            raise InputError("gravity", "is given beside a motion of the base", fix)
        motion = motion.over(settings.start, settings.start + settings.duration)
    begin, posed = settings.begin, PosedSystem(system, motion)
    if begin != type(begin)(begin.state):
        raise InputError("initial", "displaces a tip", 'give "equilibrium" or "undeformed"; joints have initial values')
    if system.holds_jax or holds_jax(motion):
        return _traced(posed, settings, name)
    point = posed.start(settings)
    flight = settings
    for coarse, most in steps_to_try(_first_step(posed, point, flight), LOADS_STEPS, posed.corners, flight):
        settings = _with_ends(motion, flight, flight.step or coarse)
        if settings.start < flight.start:
            point = posed.start(settings)
        _refuse_long(system, settings, settings.step or coarse)
        jumps = posed.jumps(settings, coarse)
        plan: Plan[SystemRun] = planned(settings, settings.step or coarse, most)
        chosen, of_steps = answered(plan, partial(_run, posed, settings, point, jumps, progress))
        if enough(chosen, of_steps, settings):
            break
    if chosen.missed:
        of_steps = StepErrors()
    stride = 1 if settings.step is not None else round(coarse / chosen.step)
    errors = SystemErrors(ErrorEstimate(of_steps.displacement), note=settings.not_estimated)

    def again(of: System) -> Solution:
        richer = PosedSystem(of, motion)
        what = "errors of shapes and models"
        return _run(richer, settings, richer.start(settings), jumps, progress, chosen.step, what).every(stride)

    if settings.estimate and chosen.whole:
        tell(progress, "errors of shapes and models", 0.0)
        steps = {(name, each): math.nan for name in judged_bodies(system) for each in LOADS}
        steps |= {PLACE: of_steps.displacement, **dict(zip(steps, of_steps.each, strict=False))}
        settled, closed = begin.state == "equilibrium", again if system.controllers else None
        errors = system_errors(chosen.every(stride), closed, steps, settled=settled)
    return _described(chosen, settings, stride, errors, name, flight, chosen.missed + chosen.turned_over)


def _run(
    posed: PosedSystem,
    settings: ResponseSettings,
    point: Point,
    jumps: Corners,
    progress: Progress,
    step: float,
    what: str,
) -> SystemRun:
    """The run from a state, by steps of a length, s, for what is said."""
    return posed.run(settings, point.y, point.yd, step, corners=jumps, progress=partial(tell, progress, what))


def _refuse_long(system: System, settings: ResponseSettings, step: float) -> None:
    """Refuse controllers that cannot be sampled, and a run of too many samples or steps."""
    for key, controller in system.controllers.items():
        fix = f"give {settings.duration / LOADS_STEPS:.3g} s or more, or a shorter run"
        samples = settings.duration / controller.sample
        refuse_more(f"controllers.{key}.sample", "samples", samples, STEPS, 8.0 * 3 * system.tree.size, fix)
    if system.controllers and not len(system.tree.free):
        raise InputError("controllers", "have nothing to move: all motion is prescribed", "leave them out, or a rate")
    if system.controllers and settings.integrator != "gauss":
        fix = "leave it out: controllers are sampled by Gauss's method"
        raise InputError("integrator", f"is {settings.integrator!r}", fix)
    each = 8.0 * (3 * system.tree.size + 16 * len(system.points))
    most = int(HISTORY_BYTES / each)
    fix = f"give {most * step:.3g} s or less, or longer steps"
    refuse_more("response.duration", "steps", settings.duration / step, most, each, fix)


def _traced(posed: PosedSystem, settings: ResponseSettings, name: str) -> SystemResponse:
    """A run whose values JAX traces: of a given step, without a look at them."""
    if settings.step is None:
        raise InputError("step", "is automatic, and a traced run has no numbers to choose it by", "give a step, s")
    step = settings.duration / max(1, round(settings.duration / settings.step))
    flight, settings = settings, _with_ends(posed.motion, settings, step)
    start = started_traced(posed.system, posed.motion, settings.start, settings.begin.state)
    _refuse_long(posed.system, settings, step)
    ran = posed.run(settings, *start, step, corners=posed.commands(settings))
    return _described(ran, settings, 1, SystemErrors(), name, flight)


def _with_ends(motion: Motion | None, settings: ResponseSettings, step: float) -> ResponseSettings:
    """Settings of a run from a machine's standstill to its standstill, in whole steps beyond the flight's times."""
    if motion is None:
        return settings
    before, after = (step * count for count in steps_beyond(motion, settings, step))
    return replace(settings, start=settings.start - before, duration=settings.duration + before + after)


def _held(system: System, run: Trajectory, inputs: Inputs) -> Iterator[tuple[str, Joint, Floats, Floats]]:
    """Joints with springs or stops, by name, and what these hold over the times of a run, (t, h), and its rates: of
    balls the rotation vector.
    """
    states = [run.q, run.qd]
    if inputs.prescribed is not None:
        states = [system.tree.whole(each, inputs.prescribed[..., k, :]) for k, each in enumerate(states)]
    names = {joint.body: name for name, joint in system.joints.items()}
    parted = zip(*map(system.tree.parted, states), strict=True)
    for body, link, (q, qd) in zip(system.order, system.tree.links, parted, strict=True):
        if not link.loose:
            ahead = [at + 1j * STEP * rate for at, rate in zip(q[:-1], qd[:-1], strict=True)]
            values, further = (link.held(each, qd[:-1])[0] for each in (q[:-1], ahead))
            yield names[body], system.joints[names[body]], values, further.imag / STEP


def _missed_stop(system: System, run: Trajectory, inputs: Inputs) -> tuple[str, ...]:
    """Warn of a stop that a coordinate meets and leaves between two times of a run, which steps may not know."""
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
    """Warn of a ball whose springs or stops hold it the other way round from somewhere on."""
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


def _first_step(posed: PosedSystem, point: Point, settings: ResponseSettings) -> float:
    """Step of the results, s: 500 at least, twenty to the period of the slowest vibration of which the most steps are
    one to a period, and none over a corner, as far as there are not too many.
    """
    _, k, _, m = point.local.slopes()
    square = np.abs(np.linalg.eigvals(np.linalg.solve(m, k))) if len(k) else np.zeros(0)
    largest = settings.duration / LEAST
    oscillating = np.sqrt(square[square > 1e-9 * square.max(initial=0.0)])
    oscillating = oscillating[oscillating * settings.duration < 2 * math.pi * LOADS_STEPS]
    if oscillating.size:
        largest = min(largest, 2 * math.pi / float(oscillating.min()) / 20)
    return settings.duration / min(even_steps(largest, posed.corners(largest), settings), LOADS_STEPS)


def _described(
    run: SystemRun,
    settings: ResponseSettings,
    stride: int,
    errors: SystemErrors,
    name: str,
    flight: ResponseSettings,
    warnings: tuple[str, ...] = (),
) -> SystemResponse:
    """Describe a run at every `stride`-th of its steps; its residual is of the flight's times."""
    every, system, motion = run.trajectory, run.posed.system, run.posed.motion
    time, traced = every.time[::stride], is_jax(every.q)
    over_time, along = run.histories(slice(None, None, stride), loads=settings.loads)
    beams, yielded = dict[str, BeamResponse](), []
    for body, loads in along.items():
        beam = beams_of(system)[body]

        def between(steps: Any, body: str = body) -> Loads:
            return run.histories(steps, loads=True)[1][body]

        peaks = None if traced else load_peaks(loads, between, every.time, stride)
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
    loop = run.loop
    if loop is not None:
        histories = {each: getattr(loop, each)[::stride] for each in ("measured", "asked", "applied")}
        loop = replace(loop, **histories)
    outcome, message = "done", ""
    if not every.whole:
        outcome = "not converged"
        message = (
            f"Newton's method failed at {every.time[-1]:.4g} s: give a smaller step, or look for what breaks there"
        )
    if (step := run.without_mass) is not None:
        free = [system.coordinates[k] for k in system.tree.free]
        words = f"at {every.time[step]:.4g} s, {massless(system, free, every.q[step])}"
        if not every.whole or bent_most(system, free, every.q)[1] > 1:
            outcome, message = MASSLESS, words
        else:
            warnings += (f"{words}; what moves so grows without bound where steps resolve it",)
    warnings += (*settings.warnings, *yielded)
    warnings += tuple(each for each in doubts(errors, settings.tolerance) if each not in warnings) + system.warnings
    warnings += () if traced else run.every(1).unstiffened
    residual: Any = None
    if settings.residual_from is not None:
        deflected = (deflection(system, each, over_time["q"]) for each in system.points)
        moved = [over_time["place"][:, k] if each is None else each for k, each in enumerate(deflected)]
        every_point = namespace(*moved).concatenate(moved, axis=1)
        flown = time <= flight.start + flight.duration * (1 + 1e-9)
        residual = half_ranges(time[flown], every_point[flown], settings.residual_from).reshape(-1, 3)
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
        loop=loop,
        beams=beams,
        solids=solids,
        surfaces=surfaces,
        base=base,
        axes=axes_result(motion, time) if isinstance(motion, Centrifuge) else None,
        assembly=assembly_of(system) if drawn else None,
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(every.time) - 1,
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        residual_amplitude=residual,
        kept_every=settings.kept_every(len(time), run.step * stride),
        warnings=warnings,
        **over_time,
    )
