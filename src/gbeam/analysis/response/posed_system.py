"""A system on the ground or on a moving base posed as a problem, ready for runs by any step."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import (
    LOADS_STEPS,
    Plan,
    even_steps,
    integrated,
    planned,
    steps_beyond,
)
from gbeam.analysis.system.feedback import SystemControllers
from gbeam.analysis.system.initial import STATE_WORDS, Initial
from gbeam.analysis.system.point import Point, started, unknown_at_start
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.limits import HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.equations import LinearEquations, NonlinearEquations, Trajectory
from gbeam.integrate.steps import Corners
from gbeam.mechanics.tree.equations import SLIP
from gbeam.mechanics.tree.linear import idle_inputs, is_linear, linear_equations
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress

LEAST = 500  # steps of the results


@dataclass(frozen=True, eq=False)
class PosedSystem:
    """A system in an environment posed from coordinates and rates (n,) at the `start`, to be run by any step.

    The times of `settings` are those of the run, from a machine's standstill to standstill, of `flight` the flight's.
    """

    system: System
    motion: Motion | None
    settings: ResponseSettings
    flight: ResponseSettings
    start: tuple[Array, Array]
    kept: float  # step of the results, s
    limit: int = LOADS_STEPS  # of steps of a run
    slip: float = SLIP  # rad/s or m/s, rate below which friction is smooth

    @cached_property
    def controllers(self) -> SystemControllers | None:
        """Controllers in the loop; None without any."""
        return SystemControllers(self.system) if self.system.controllers else None

    @cached_property
    def equations(self) -> LinearEquations | NonlinearEquations:
        """Equations of the system, with its controllers, if any, in the loop; linear where they are so without."""
        tree, drive = self.system.tree.slipping(self.slip), partial(self.system.inputs, motion=self.motion)
        if self.controllers is None and is_linear(tree):
            return linear_equations(tree, drive)
        at_start = self.system.inputs(np.array([self.settings.start]))  # on a ground that rests
        ground = each_leaf(lambda leaf: leaf[0], at_start.ground) if self.motion is None else None
        contracted = tree.contracted(ground)
        idle = idle_inputs(contracted, at_start) if self.controllers is None else None
        return NonlinearEquations(contracted, drive, self.controllers, idle)

    @cached_property
    def felt(self) -> Corners:
        """Corners and jumps of the inputs, and jumps of the controllers' commands."""
        end = self.settings.start + self.settings.duration
        felt = Corners.of(corners(self.system, self.motion, self.kept), self.equations.drive, self.settings.start, end)
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
        times = self.controllers.corners(self.settings.start, self.settings.start + self.settings.duration)
        times = np.unique(np.round(times, 12))
        return Corners(times, np.ones(len(times), dtype=bool))

    def begun(self, progress: Progress) -> PosedSystem:
        """The problem itself: a machine's spin-up is a part of the run."""
        return self

    def plan(self) -> Plan[Any]:
        """Plan the runs that the settings need."""
        return planned(self.settings, self.settings.step or self.kept, self.limit)

    def integrated(self, step: float, **how: Any) -> Trajectory:
        """Integrate by steps of a length, s; `how` are further arguments of the driver."""
        return integrated(Problem(self.equations, *self.start, 0, True), self.settings, step, **how)

    def of(self, system: System) -> PosedSystem:
        """Return the problem of another system, which begins at its own initial state."""
        return replace(self, system=system, start=state_at(system, self.motion, self.settings))


def corners(system: System, motion: Motion | None, step: float) -> Floats:
    """Times, s, that steps of a length should not pass unseen, of a system and its motion."""
    of_motion = [] if motion is None else [motion.corners(step)]
    return np.concatenate([system.corners(step), *of_motion])


def state_at(system: System, motion: Motion | None, settings: ResponseSettings) -> tuple[Floats, Floats]:
    """Coordinates and rates (n,) of a system at the start of the settings."""
    point = started(system, motion, settings.start, settings.begin)
    return point.y, point.yd


def begun_in_words(system: System, initial: Initial) -> str:
    """Sentence on the state in which a system begins."""
    floating = [name for name in system.flexible if name in system.floating]
    held = [name for name in system.flexible if name not in floating]
    if initial.displaces:
        return f"{initial}, joints at their initial values"
    how = STATE_WORDS[initial.state]
    if initial.state == "equilibrium" and floating:
        of_held = f"with {', '.join(held)} in relative equilibrium, {', '.join(floating)} " if held else ""
        how = f"{of_held}undeformed ({'it floats' if len(floating) == 1 else 'they float'})"
    deforms = system.flexible or unknown_at_start(system, initial.state)[0].any()
    return f"begins {how}, joints at their initial values" if deforms else "begins with joints at their initial values"


def refuse_long(system: System, settings: ResponseSettings, step: float) -> None:
    """Raise InputError for controllers that the run cannot sample, and for too many samples or steps."""
    for key, controller in system.controllers.items():
        fix = f"give {settings.duration / LOADS_STEPS:.3g} s or more, or a shorter run"
        samples = settings.duration / controller.sample
        refuse_more(f"controllers.{key}.sample", "samples", samples, STEPS, 8.0 * 3 * system.tree.size, fix)
    if system.controllers and not len(system.tree.free):
        raise InputError("controllers", "have nothing to move: all motion is prescribed", "leave them out, or a rate")
    if system.controllers and settings.integrator != "gauss":
        fix = "leave it out: controllers are sampled by Gauss's method"
        raise InputError("integrator", f"is {settings.integrator!r}", fix)
    size = 8.0 * (3 * system.tree.size + 16 * len(system.points))  # bytes of a step
    most = int(HISTORY_BYTES / size)
    fix = f"give {most * step:.3g} s or less, or longer steps"
    refuse_more("response.duration", "steps", settings.duration / step, most, size, fix)


def with_ends(motion: Motion | None, settings: ResponseSettings, step: float) -> ResponseSettings:
    """Settings whose times go from a machine's standstill to standstill, whole steps beyond the flight's times."""
    if motion is None:
        return settings
    before, after = (step * count for count in steps_beyond(motion, settings, step))
    return replace(settings, start=settings.start - before, duration=settings.duration + before + after)


def first_step(point: Point, corners: Callable[[float], Floats], settings: ResponseSettings) -> float:
    """Step of the results, s: 500 steps or more, twenty to the period of the slowest vibration (of those that the most
    steps would resolve), none longer than from corner to corner; LOADS_STEPS at most.
    """
    _, k, _, m = point.local.slopes()
    square = np.abs(np.linalg.eigvals(np.linalg.solve(m, k))) if len(k) else np.zeros(0)
    largest = settings.duration / LEAST
    oscillating = np.sqrt(square[square > 1e-9 * square.max(initial=0.0)])
    oscillating = oscillating[oscillating * settings.duration < 2 * math.pi * LOADS_STEPS]
    if oscillating.size:
        largest = min(largest, 2 * math.pi / float(oscillating.min()) / 20)
    return settings.duration / min(even_steps(largest, corners(largest), settings), LOADS_STEPS)
