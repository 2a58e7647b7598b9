"""A system on the ground or on a moving base posed as a problem, ready for runs by any step."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import (
    LOADS_STEPS,
    MAX_STEPS,
    RIGID,
    Plan,
    even_steps,
    plan_one_run,
    plan_runs,
    scheme_of,
    steps_beyond,
    steps_to_try,
)
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.feedback import SystemControllers
from gbeam.analysis.system.initial import STATE_WORDS, Initial, assign_to_bodies
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.start import starting_point, starting_state, unknown_at_start
from gbeam.arrays.namespace import Array, holds_jax
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import InputError
from gbeam.guards.limits import BOUNDLESS, HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.driver import integrate_steps
from gbeam.integrate.equations import LinearEquations, NonlinearEquations, Trajectory
from gbeam.integrate.steps import Corners, Steps, join_steps, make_steps
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.linear import idle_inputs, is_linear, linear_equations
from gbeam.mechanics.tree.links import SLIP
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.results.errors import StepErrors

LEAST = 500  # steps of the results
PER_PERIOD = 20  # steps of the results to a period of the slowest vibration


@dataclass(frozen=True)
class Begun:
    """Coordinates and rates (n,) in which a run begins."""

    y: Array
    yd: Array


@dataclass(frozen=True, eq=False)
class Posed:
    """A system in an environment posed from the state `start`, to be run by any step.

    `result_step`, s, is the step of the results. The settings' times are the flight's. A machine spins up in
    `steps_before` steps of the results ahead of these, and down in `steps_after` of them behind.
    """

    subject: Subject
    settings: ResponseSettings
    start: Begun
    result_step: float
    limit: int = MAX_STEPS  # steps of a run at most
    steps_before: int = 0
    steps_after: int = 0
    slip: float = SLIP  # rad/s or m/s, rate below which friction is smooth

    @property
    def system(self) -> System:
        """The system of bodies."""
        return self.subject.system

    @property
    def motion(self) -> Motion | None:
        """Motion of the ground, or None where it rests."""
        return self.subject.ground

    @property
    def begin(self) -> float:
        """Time at which the run begins, s."""
        return self.settings.start - self.steps_before * self.result_step

    @property
    def end(self) -> float:
        """Time at which the run ends, s."""
        return self.settings.start + self.settings.duration + self.steps_after * self.result_step

    @cached_property
    def controllers(self) -> SystemControllers | None:
        """Controllers in the loop, or None without any."""
        return SystemControllers(self.system) if self.system.controllers else None

    def drive(self, t: Array) -> Inputs:
        """Inputs of the equations at times (t,) s, without controllers."""
        return self.system.inputs(t, self.motion)

    @cached_property
    def equations(self) -> LinearEquations | NonlinearEquations:
        """Equations of the system, with its controllers, if any, in the loop; linear where they are so without."""
        tree = self.system.tree.slipping(self.slip)
        if self.controllers is None and is_linear(tree):
            return linear_equations(tree, self.drive)
        at_start = self.system.inputs(np.array([self.settings.start]))  # on a ground that rests
        ground = each_leaf(lambda leaf: leaf[0], at_start.ground) if self.motion is None else None
        contracted = tree.contracted(ground)
        idle = idle_inputs(contracted, at_start) if self.controllers is None else None
        return NonlinearEquations(contracted, self.drive, self.controllers, idle)

    def driven_as(self, other: Posed) -> bool:
        """True if all that drives it is the same objects as in another problem."""
        mine, other_drives = self._drives, other._drives
        return len(mine) == len(other_drives) and all(
            drive is other_drive for drive, other_drive in zip(mine, other_drives, strict=True)
        )

    @property
    def _drives(self) -> list[Any]:
        """Motion, gravity, joints that are moved, histories of efforts, forces and loads."""
        system, drives = self.system, list[Any]()
        for joint in system.joints.values():
            drives += [joint] if joint.rates else joint.efforts.values()
        histories = [profile for force in system.forces.values() for profile in force.history]
        loads = [body.history for body in system.flexible.values()]
        return [self.subject.motion, system.gravity, *drives, *histories, *loads]

    @cached_property
    def felt(self) -> Corners:
        """Corners and jumps of the inputs, and jumps of the controllers' commands."""
        felt = Corners.from_times(corners(self.subject, self.result_step), self.drive, self.begin, self.end)
        if self.controllers is None:
            return felt
        commands = self.commands.time
        commands = commands[np.abs(commands[:, None] - felt.time).min(axis=1, initial=np.inf) > 1e-9]
        times, jumps = np.append(felt.time, commands), np.append(felt.jump, np.ones(len(commands), dtype=bool))
        return Corners(np.sort(times), jumps[np.argsort(times)])

    @property
    def commands(self) -> Corners:
        """Times at which controllers sample and their commands jump, as jumps."""
        if self.controllers is None:
            return Corners(np.zeros(0), np.zeros(0, dtype=bool))
        times = np.unique(np.round(self.controllers.corners(self.begin, self.end), 12))
        return Corners(times, np.ones(len(times), dtype=bool))

    def counts(self, step: float) -> tuple[int, int, int]:
        """Numbers of steps in which a machine spins up, of the flight, of a length, s, and in which it spins down. A
        length that does not divide the duration goes beyond its end, where nothing spins down.
        """
        count = math.ceil(self.settings.duration / step - 1e-6)
        is_whole = math.isclose(count * step, self.settings.duration, rel_tol=1e-6)
        return self.steps_before, count, self.steps_after if is_whole else 0

    def steps(self, step: float, cut: Corners | None = None) -> Steps:
        """Steps of a run, of a length, s, in the flight, of the results' in a machine's spin-up and spin-down, `cut` at
        corners, by default those that the scheme feels.
        """
        cut = self.felt.felt_by(scheme_of(self.settings)) if cut is None else cut
        steps_before, count, steps_after = self.counts(step)
        start, result_step = self.settings.start, self.result_step
        parts = (
            (self.begin, result_step, steps_before),
            (start, step, count),
            (start + self.settings.duration, result_step, steps_after),
        )
        return join_steps([make_steps(*part, cut) for part in parts if part[-1]])

    def integrated(self, step: float, cut: Corners | None = None, progress: Any = None) -> Trajectory:
        """Integrate by steps of a length, s, until the model of a body ceases to hold."""
        y, yd, steps = self.start.y, self.start.yd, self.steps(step, cut)
        scheme = scheme_of(self.settings)
        return integrate_steps(self.equations, scheme, y, yd, steps, stop=self.steps_in_bounds, progress=progress)

    def plan(self) -> Plan[Any]:
        """Plan the runs that the settings need."""
        if not len(self.system.tree.unknowns):  # nothing is integrated
            return plan_one_run(self.result_step, StepErrors(0.0, 0.0, 0.0))
        return plan_runs(self.settings, self.result_step, self.limit)

    def columns(self, body: str) -> slice:
        """Coordinates that deform a body, among the unknown ones."""
        chosen = deforming(self.system.unknown_coordinates, body)
        return slice(chosen[0], chosen[-1] + 1) if chosen else slice(0, 0)

    def steps_in_bounds(self, y: Floats, moved: Mapping[str, Floats] = MappingProxyType({})) -> int | None:
        """Number of steps until the displacement of a body exceeds the length of a beam, or the bound of particles,
        where its model ceases to hold, or None if none does. `moved` (t, s, 3) m are the displacements of bodies by
        name at unknowns y (t, n), where they are known.
        """
        far = np.zeros(len(y), dtype=bool)
        for name, body in self.system.flexible.items():
            if body.size:
                displaced = moved[name] if name in moved else body.displacement(y[:, self.columns(name)])
                far |= self.far(body, displaced)
        return int(np.argmax(far)) + 1 if far.any() else None

    @staticmethod
    def far(body: Structure, displaced: Floats) -> Flags:
        """Flags (t,) of displacements (t, s, 3) m beyond which the model of a body does not hold; exact ones do."""
        limit = math.inf if body.kind == "exact" else BOUNDLESS if body.field is None else body.length
        return np.abs(displaced).max(axis=(1, 2), initial=0.0) > limit

    def replace_system(self, system: System) -> Posed:
        """Return the problem of another system, which begins at its own initial state."""
        subject = replace(self.subject, system=system)
        return replace(self, subject=subject, start=begun(subject, self.settings, self.begin))


def prepared(structure: Structure | System, motion: Motion | None, settings: ResponseSettings) -> Subject:
    """Subject of a response, with its motion over the flight's times.

    An InputError says that it has no motion, or one too many.
    """
    if motion is not None:
        motion = motion.over(settings.start, settings.start + settings.duration)
    subject = subject_of(structure, motion)
    if motion is None and structure is not subject.system:
        raise InputError("motion", "is missing", "give a Flight, a Hub or a Centrifuge; Flight(z=0.0) is at rest")
    structure.require_damping("the response")
    if subject.ground is not None and subject.ground.free:
        raise InputError("motion", "is a hub that turns freely", "give it as a body on a revolute joint")
    if subject.ground is not None and subject.system.gravity is not None:
        fix = "leave one out: a motion carries its own, as specific force"
        raise InputError("gravity", "is given beside a motion of the base", fix)
    for moved in (settings.begin.displaced, settings.begin.moving):
        assign_to_bodies(subject.system.flexible, moved)  # raises what it refuses
    return subject


def poses(subject: Subject, settings: ResponseSettings) -> Iterator[Posed]:
    """Yield the problem with each of the steps of results to try, the longest first."""
    start = begun(subject, settings, settings.start)
    for result_step, limit in tries(subject, settings, start):
        yield pose(subject, settings, result_step, limit, start)


def tries(subject: Subject, settings: ResponseSettings, start: Begun) -> list[tuple[float, int]]:
    """Steps of the results to try, s, the longest first, each with the most steps of a run."""
    limit = MAX_STEPS if is_linear(subject.system.tree) else LOADS_STEPS
    return steps_to_try(first_step(subject, start, settings), limit, partial(corners, subject), settings)


def pose(
    subject: Subject, settings: ResponseSettings, result_step: float, limit: int = MAX_STEPS, start: Begun | None = None
) -> Posed:
    """Pose a problem with a step of the results, s, from the start of a machine's spin-up.

    The `start` of the flight serves where nothing spins up. An InputError refuses a run that is too long.
    """
    steps_before, steps_after = (
        (0, 0) if subject.ground is None else steps_beyond(subject.ground, settings, result_step)
    )
    refuse_long(subject.system, settings, result_step)
    if start is None or steps_before:
        start = begun(subject, settings, settings.start - steps_before * result_step)
    return Posed(subject, settings, start, result_step, limit, steps_before, steps_after)


def corners(subject: Subject, step: float) -> Floats:
    """Times, s, that steps of a length should not pass unseen, of a system and its motion."""
    of_motion = [] if subject.motion is None else [subject.motion.corners(step)]
    return np.concatenate([subject.system.corners(step), *of_motion])


def begun(subject: Subject, settings: ResponseSettings, time: float) -> Begun:
    """Coordinates and rates (n,) in which a system begins at a time, s."""
    system, ground = subject.system, subject.ground
    if system.holds_jax or holds_jax(ground):
        return Begun(*starting_state(system, ground, time, settings.begin))
    point = starting_point(system, ground, time, settings.begin)
    return Begun(point.y, point.yd)


def begun_in_words(system: System, initial: Initial) -> str:
    """Sentence on the state in which a system begins."""
    floating = [name for name in system.flexible if name in system.floating]
    held_bodies = [name for name in system.flexible if name not in floating]
    if not any(link.steps for link in system.tree.links):
        return str(initial)
    if initial.displaces:
        return f"{initial}, joints at their initial values"
    state_words = STATE_WORDS[initial.state]
    if initial.state == "equilibrium" and floating:
        of_held = (
            f"with {', '.join(held_bodies)} in relative equilibrium, {', '.join(floating)} " if held_bodies else ""
        )
        state_words = f"{of_held}undeformed ({'it floats' if len(floating) == 1 else 'they float'})"
    deforms = system.flexible or unknown_at_start(system, initial.state)[0].any()
    return (
        f"begins {state_words}, joints at their initial values"
        if deforms
        else "begins with joints at their initial values"
    )


def refuse_long(system: System, settings: ResponseSettings, step: float) -> None:
    """Raise InputError for controllers that the run cannot sample, and for too many samples or steps."""
    for key, controller in system.controllers.items():
        fix = f"give {settings.duration / LOADS_STEPS:.3g} s or more, or a shorter run"
        samples = settings.duration / controller.sample
        refuse_more(f"controllers.{key}.sample", "samples", samples, STEPS, 8.0 * 3 * system.tree.size, fix)
    if system.controllers and not len(system.tree.unknowns):
        raise InputError("controllers", "have nothing to move: all motion is prescribed", "leave them out, or a rate")
    if system.controllers and settings.integrator != "gauss":
        fix = "leave it out: controllers are sampled by Gauss's method"
        raise InputError("integrator", f"is {settings.integrator!r}", fix)
    stations = sum(len(body.stations) for body in system.flexible.values())
    size = 8.0 * (3 * system.tree.size + 16 * len(system.points) + 9 * stations)  # bytes of a step
    largest_count = min(STEPS, int(HISTORY_BYTES / size))
    fix = f"give {largest_count * step:.3g} s or less, longer steps, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / step, largest_count, size, fix)


def first_step(subject: Subject, start: Begun, settings: ResponseSettings) -> float:
    """Step of the results, s: that of the settings, rounded to a whole number of steps.

    An automatic one divides the response into 500 steps or more, and the period of the slowest vibration on a ground
    that rests into twenty. It is no longer than the time from corner to corner. Equations that are not linear have
    LOADS_STEPS at most, and only vibrations that these would resolve count.
    """
    if settings.step is not None:
        return settings.duration / max(1, round(settings.duration / settings.step))
    system, bends = subject.system, partial(corners, subject)
    largest = settings.duration / LEAST
    if not len(system.tree.unknowns):
        largest = min(largest, RIGID)
        return settings.duration / even_steps(largest, bends(largest), settings)
    _, k, _, m = Point(system.tree, start.y, start.yd, 0 * start.y, _resting(subject, settings.start)).local.slopes()
    square = np.abs(np.linalg.eigvals(np.linalg.solve(m, k)))
    largest_count = math.inf if is_linear(system.tree) else LOADS_STEPS
    oscillating = np.sqrt(square[square > 1e-9 * square.max(initial=0.0)])
    oscillating = oscillating[oscillating * settings.duration < 2 * math.pi * largest_count]
    if oscillating.size:
        largest = min(largest, 2 * math.pi / float(oscillating.min()) / PER_PERIOD)
    return settings.duration / min(even_steps(largest, bends(largest), settings), largest_count)


def _resting(subject: Subject, time: float) -> Inputs:
    """Inputs at a time, s, on a ground that rests, without loads on bodies."""
    inputs, zero = subject.system.inputs(np.asarray(time), subject.ground), np.zeros(3)
    a = inputs.ground.a if subject.ground is None else zero
    return replace(inputs, ground=Frame(np.eye(3), zero, zero, zero, a, zero), loads=(None,) * len(inputs.loads))
