"""The scheme and the step: divided until the error estimated from runs of several is within the tolerance."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import Estimate, of_everything, ratio
from gbeam.arrays.namespace import is_traced, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.checks import choice
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import Trajectory
from gbeam.integrate.schemes import SCHEMES, Scheme
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.printable import advise
from gbeam.results.errors import StepErrors

MAX_STEPS = 4_000_000
LOADS_STEPS = 50_000  # at most, where it is the loads that need them
MANY = 20_000  # steps: where the periods ask for more, fewer are tried before
FEW = 5_000, 20_000, 40_000  # steps that are tried, with which a third of the tolerance is enough
ONE_CORNER = 1e-6  # of the duration: corners nearer to one another are one
JUMPS = 2, 3, 4, 6, 8, 12, 16  # into how many a step is divided; a check takes four, three or two of the new ones
BENT = 4  # into how many at most where a law bends, for errors to be seen to fall
RIGID = 2e-3  # s: step of a specimen without coordinates
SPARE = 1.05  # how much finer a step is than the order promises to be enough
# Yields a step, s, and what it is for; is sent the run; returns the run that counts with its errors.
R = TypeVar("R", bound=Run)
Plan = Generator[tuple[float, str], R, tuple[R, StepErrors]]


def scheme_of(settings: ResponseSettings) -> Scheme:
    """The integration scheme that the settings name."""
    choice("response.integrator", str(settings.integrator), SCHEMES)
    scheme = SCHEMES[str(settings.integrator)]
    takes = tuple(inspect.signature(scheme).parameters)
    for name in settings.parameters:
        if name not in takes:
            fix = advise(name, takes, listed="it takes") if takes else "leave it out: it has no parameters"
            raise InputError(f"parameters.{name}", f"does not belong to {settings.integrator}", fix)
    return scheme(**{str(name): value for name, value in settings.parameters.items()})


def first_step(structure: Structure, motion: Motion, settings: ResponseSettings) -> float:
    """Step of the results, s: the given one, a whole number over the duration; otherwise an even number, at least 500
    and 20 to the lowest period, none longer than the shortest time between corners of motion or loads.
    """
    if settings.step is not None:
        return settings.duration / max(1, round(settings.duration / settings.step))
    period = 2 * math.pi / float(structure.rest[0][0]) if structure.size else 20 * RIGID
    largest = min(period / 20, settings.duration / 500)
    return settings.duration / even_steps(largest, corners(structure, motion, largest), settings)


def first_steps(structure: Structure, motion: Motion, settings: ResponseSettings) -> list[tuple[float, int]]:
    """Steps of the results to try, s, each with the most steps of a run."""
    step = first_step(structure, motion, settings)
    if not structure.size:
        return [(step, MAX_STEPS)]
    return steps_to_try(step, MAX_STEPS, partial(corners, structure, motion), settings)


def steps_to_try(
    step: float, most: int, corners: Callable[[float], Floats], settings: ResponseSettings
) -> list[tuple[float, int]]:
    """Steps of the results to try, s, each with the most steps of a run: where the periods ask for many first those
    that are enough for what hardly vibrates, unless they could pass a pulse unseen.

    `corners` gives the times that steps of a length should not pass unseen, s.
    """
    tries = [(step, most)]
    if settings.step is None and step < settings.duration / MANY:
        for count in FEW[::-1]:
            bends = corners(settings.duration / count)
            few = settings.duration / even_steps(settings.duration / count, bends, settings)
            gaps = np.diff(np.unique(bends))
            short = ((gaps > 1e-12 * settings.duration) & (gaps < few / 2)).any()
            if step < few and not short:
                tries.insert(0, (few, round(settings.duration / few)))
    return tries


def enough(run: Run, errors: StepErrors, settings: ResponseSettings) -> bool:
    """True if a run by steps that were tried misses nothing, and its errors are within a third of the tolerance."""
    return not run.missed and max(errors.displacement, errors.loads) <= settings.tolerance / 3


def even_steps(largest: float, corners: Floats, settings: ResponseSettings) -> int:
    """Least even number of steps over the duration, none longer than the largest, s, or than from corner to corner."""
    gaps = np.diff(np.unique(np.clip(corners - settings.start, 0.0, settings.duration)))
    largest = min(largest, gaps.min(where=gaps > ONE_CORNER * settings.duration, initial=largest))
    return 2 * math.ceil(settings.duration / largest / 2)


def corners(structure: Structure, motion: Motion, step: float) -> Floats:
    """Times at which the motion or the loads have a corner or jump, or what steps of a length could pass unseen, s."""
    loads = [] if structure.history is None else [structure.history.corners(step)]
    return np.concatenate([motion.corners(step), *loads])


def answered(plan: Plan[R], run: Callable[[float, str], R]) -> tuple[R, StepErrors]:
    """Compute the runs of a plan, one after the other."""
    try:
        wanted = next(plan)
        while True:
            wanted = plan.send(run(*wanted))
    except StopIteration as end:
        chosen, errors = end.value
        return chosen, errors


def planned(settings: ResponseSettings, step: float, most: int = MAX_STEPS) -> Plan[R]:
    """The runs of some settings from the step of the results: those of an automatic step, by so many steps at most, or
    of the given one and what its estimate needs.
    """
    order = scheme_of(settings).order
    if settings.step is None:
        return (yield from refine(step, order, settings, most))
    if settings.estimate:
        return (yield from check(step, order))
    return (yield from once(step, StepErrors()))


def once(step: float, errors: StepErrors) -> Plan[R]:
    """One run, whose errors are known beforehand or unknown."""
    return (yield step, "integrating"), errors


def check(step: float, order: int) -> Plan[R]:
    """Run with a given step, and with twice and four times that, from which the error is estimated."""
    runs = [(yield step, "integrating"), (yield 2 * step, "checking with twice the step")]
    if not runs[1].whole:
        return runs[0], StepErrors()
    runs.append((yield 4 * step, "checking with four times the step"))
    return runs[0], of_everything(runs[::-1], order)


def refine(coarse: float, order: int, settings: ResponseSettings, limit: int = MAX_STEPS) -> Plan[R]:
    """Divide the step, from twice the results', until the errors estimated of what moves and of the peaks are within
    their aims; histories of root loads, if followed, only to a third of the tolerance and by LOADS_STEPS. Where steps
    are to be no finer than the results' that is the only aim.
    """
    aims = settings.aim, settings.aim_of_peaks
    if round(settings.duration / coarse) == limit:
        aims = settings.tolerance / 3, settings.tolerance / 3

    def refined(step: float) -> tuple[float, str]:
        return step, f"refining the step to {1e3 * step:.3g} ms"

    runs = [(yield 2 * coarse, "integrating"), (yield refined(coarse))]
    while True:
        left, promised = _left(runs[-3:], order, aims)
        both, new = runs[-2].whole and runs[-1].whole, runs[-1]
        if both and promised <= 1 and (more := _check_needed(runs, left)):
            checked = yield more, f"checking with {1e3 * more:.3g} ms"
            runs = sorted([*runs, checked], key=lambda each: -each.step)
            left, _ = _left(runs[-3:], order, aims)
        far, most = promised, limit
        if both and left <= 1 and not new.missed and not (new.bends and len(runs) < 3):
            errors = of_everything(runs[-3:], order)
            far, most = 3 * errors.loads / settings.tolerance, min(limit, LOADS_STEPS)
            if not (far > 1 and new.followed):  # as NaN is not
                return new, errors
        finer = min(finer_by(far, order), BENT if new.bends else JUMPS[-1])
        stuck = not (runs[-2].whole or new.whole) and (new.trajectory.stopped or len(runs) > 3)
        if stuck or settings.duration / new.step * finer > most:
            break
        runs.append((yield refined(new.step / finer)))
    return runs[-1], of_everything(runs[-3:], order)


def finer_by(far: float, order: int) -> int:
    """Into how many steps to divide one whose error the order promises to be so many times too large."""
    times = SPARE * max(far, 1.0) ** (1 / order) if math.isfinite(far) else 2.0
    return next((jump for jump in JUMPS if jump >= times), JUMPS[-1])


def _left(runs: Sequence[Run], order: int, aims: tuple[float, float]) -> tuple[float, float]:
    """Error of tip or peaks over its aim, by the order observed and by the scheme's own."""
    error, (tip, peaks) = Estimate.of(runs, order), aims
    return max(error.tip / tip, error.peaks / peaks), max(error.promised_tip / tip, error.promised_peaks / peaks)


def _check_needed(runs: Sequence[Run], left: float) -> float | None:
    """Step of a cheaper run, s, that tells whether an error is what the order promises, or None: unresolved modes after
    a jump promise too well.
    """
    jump, new = ratio(*runs[-2:]), runs[-1]
    if new.bends or (left <= 1 and jump <= 4):
        return None
    if jump > 3:
        return (4 if jump > 6 else jump // 2) * new.step
    return 4 * new.step if len(runs) == 2 else None


def steps_beyond(motion: Motion, settings: ResponseSettings, step: float) -> tuple[int, int]:
    """Number of steps of the results in a machine's spin-up and spin-down."""
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


def split(trajectory: Trajectory, *counts: int) -> list[Trajectory | None]:
    """Runs of so many steps, one after the other; None where there are none."""
    ends = [0, *np.cumsum(counts)]
    return [trajectory.at(slice(a, b + 1)) if b > a else None for a, b in pairwise(ends)]


def joined(up: Trajectory | None, flight: Trajectory, down: Trajectory | None, stride: int) -> tuple[Trajectory, slice]:
    """Every step of spin-up and spin-down with every `stride`-th of the flight's, and where these are."""
    parts = [flight.at(slice(None, None, stride))]
    if up is not None:
        parts.insert(0, up.at(slice(None, -1)))
    if down is not None:
        parts.append(down.at(slice(1, None)))
    xp = namespace(flight.q)
    q, qd, qdd = (xp.concatenate([getattr(part, name) for part in parts]) for name in ("q", "qd", "qdd"))
    time = np.concatenate([part.time for part in parts])
    first = 0 if up is None else len(up.time) - 1
    return replace(flight, time=time, q=q, qd=qd, known=qdd), slice(first, first + len(flight.time[::stride]))
