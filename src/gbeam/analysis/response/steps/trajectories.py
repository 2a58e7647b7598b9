"""A run put together: a machine's spin-up, the flight's times, and its spin-down, each with steps of its own.

Spin-up and spin-down are slow beside any vibration: they take the steps of the results, while those of the flight's
times are refined from the state that the spin-up leaves.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.steps.stepping import scheme_of
from gbeam.arrays.namespace import is_traced, namespace
from gbeam.errors import InputError
from gbeam.integrate.driver import integrate
from gbeam.integrate.trajectory import Trajectory
from gbeam.motion.protocol import Motion

Array = Any
_HISTORIES = "q", "qd", "qdd"


def steps_beyond(motion: Motion, settings: ResponseSettings, step: float) -> tuple[int, int]:
    """How many steps of the results a machine's spin-up and spin-down take."""
    beyond = motion.beyond(settings.start, settings.start + settings.duration)
    if is_traced(*beyond):
        fix = 'give spin_up and spin_down, or start = "idle"'
        raise InputError("spin_up", "is found from the load, and JAX traces the machine", fix)
    before, after = (math.ceil(float(time) / step - 1e-6) for time in beyond)
    return before, after


def integrated(problem: Problem, settings: ResponseSettings, step: float, **how: Any) -> Trajectory:
    """The run at the flight's times."""
    # A step that does not divide the duration, twice the one given, goes beyond the end.
    how |= {"step": step, "count": math.ceil(settings.duration / step - 1e-6), "start": settings.start}
    return integrate(problem.equations, scheme_of(settings), problem.q, problem.qd, **how)


def ramp(problem: Problem, settings: ResponseSettings, step: float, first: int, count: int, **how: Any) -> Trajectory:
    """Spin-up or spin-down from a problem's state: `count` steps from the `first`, counted from the flight's start."""
    how |= {"step": step, "count": count, "start": settings.start + step * first}
    made = integrate(problem.equations, scheme_of(settings), problem.q, problem.qd, **how)
    # The flight's own times to the last digit.
    return replace(made, time=np.asarray(settings.start + step * (first + np.arange(len(made.time))), dtype=np.float64))


def going_on(problem: Problem, trajectory: Trajectory) -> Problem:
    """The problem that begins in the state in which a run ends."""
    return replace(problem, q=trajectory.q[-1], qd=trajectory.qd[-1])


def split(trajectory: Trajectory, *counts: int) -> list[Trajectory | None]:
    """Runs of so many steps, one after the other; None where there are none."""
    ends = [0, *np.cumsum(counts)]
    return [_part(trajectory, slice(a, b + 1)) if b > a else None for a, b in pairwise(ends)]


def joined(up: Trajectory | None, flight: Trajectory, down: Trajectory | None, stride: int) -> tuple[Trajectory, slice]:
    """Every step of spin-up and spin-down with every `stride`-th of the flight's, and where these are."""
    pieces = [(flight, slice(None, None, stride))]
    if up is not None:
        pieces.insert(0, (up, slice(None, -1)))
    if down is not None:
        pieces.append((down, slice(1, None)))
    xp = namespace(flight.q)
    histories = {name: xp.concatenate([getattr(run, name)[steps] for run, steps in pieces]) for name in _HISTORIES}
    time = np.concatenate([run.time[steps] for run, steps in pieces])
    first = 0 if up is None else len(up.time) - 1
    return replace(flight, time=time, **histories), slice(first, first + len(flight.time[::stride]))


def _part(trajectory: Trajectory, steps: slice) -> Trajectory:
    return replace(trajectory, **{name: getattr(trajectory, name)[steps] for name in ("time", *_HISTORIES)})
