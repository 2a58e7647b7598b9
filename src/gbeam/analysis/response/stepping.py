"""The scheme and its step, which is divided until the error is within the tolerance.

The error is estimated from several runs.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Generator, Sequence
from operator import truediv
from typing import TypeVar

import numpy as np

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import Estimate, Stepped, estimate_step_errors, ratio
from gbeam.arrays.namespace import is_traced
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.checks import choice
from gbeam.integrate.schemes import SCHEMES, Scheme
from gbeam.motion.protocol import Motion
from gbeam.printable import advise
from gbeam.results.errors import StepErrors

MAX_STEPS = 4_000_000
LOADS_STEPS = 50_000  # at most, where it is the loads that need them
MANY = 20_000  # steps: where the periods ask for more, fewer are tried first
FEW = 5_000, 20_000, 40_000  # numbers of steps tried first; an error of a third of the tolerance is enough for them
ONE_CORNER = 1e-6  # of the duration: corners nearer to one another are one
JUMPS = 2, 3, 4, 6, 8, 12, 16  # numbers of steps that a step is divided into; a check joins four, three or two of these
BENT = 4  # the largest division where a law bends, so that errors can be seen to fall
RIGID = 2e-3  # s: longest step of the results where nothing is unknown
ROUNDING = 1e-9  # of a number of steps
SPARE = 1.05  # how much finer a step is than the order promises to be enough
# A plan yields a step, s, and its purpose, receives the run, and returns the run that counts with its errors.
R = TypeVar("R", bound=Stepped)
Plan = Generator[tuple[float, str], R, tuple[R, StepErrors]]


def scheme_of(settings: ResponseSettings) -> Scheme:
    """Return the integration scheme that the settings name."""
    choice("response.integrator", settings.integrator, SCHEMES)
    scheme = SCHEMES[settings.integrator]
    takes = tuple(inspect.signature(scheme).parameters)
    for name in settings.parameters:
        if name not in takes:
            owners = [owner for owner, candidate in SCHEMES.items() if name in inspect.signature(candidate).parameters]
            fix = f'give integrator = "{owners[0]}" with it' if owners else "leave it out: it has no parameters"
            if takes:
                fix = advise(name, takes, listed="it takes")
            raise InputError(f"parameters.{name}", f"does not belong to {settings.integrator}", fix)
    return scheme(**{str(name): value for name, value in settings.parameters.items()})


def steps_to_try(
    step: float, limit: int, corners: Callable[[float], Floats], settings: ResponseSettings
) -> list[tuple[float, int]]:
    """Return the steps of the results to try, s, each with the most steps of a run.

    Where `step` asks for many steps, fewer ones are tried first, unless they could miss a pulse: they are enough for
    motions that hardly vibrate. `corners` returns the times, s, that steps of a length should not pass unseen.
    """
    tries = [(step, limit)]
    if settings.step is None and step < settings.duration / MANY:
        for count in FEW[::-1]:
            bends = corners(settings.duration / count)
            few = settings.duration / even_steps(settings.duration / count, bends, settings)
            gaps = np.diff(np.unique(bends))
            short = ((gaps > 1e-12 * settings.duration) & (gaps < few / 2)).any()
            if step < few and not short:
                tries.insert(0, (few, round(settings.duration / few)))
    return tries


def enough(run: Stepped, errors: StepErrors, settings: ResponseSettings) -> bool:
    """True if a run misses no stop, and its step errors are within a third of the tolerance."""
    return not run.event_warnings and max(errors.displacement, errors.loads) <= settings.tolerance / 3


def even_steps(largest: float, corners: Floats, settings: ResponseSettings) -> int:
    """Least even number of steps over the duration of which none is longer than `largest`, s, or passes a corner."""
    gaps = np.diff(np.unique(np.clip(corners - settings.start, 0.0, settings.duration)))
    largest = min(largest, gaps.min(where=gaps > ONE_CORNER * settings.duration, initial=largest))
    return 2 * math.ceil(settings.duration / largest / 2 - ROUNDING)


def run_plan(plan: Plan[R], run: Callable[[float, str], R]) -> tuple[R, StepErrors]:
    """Compute the runs that a plan asks for, one after the other, and return the run that counts with its errors."""
    try:
        wanted = next(plan)
        while True:
            wanted = plan.send(run(*wanted))
    except StopIteration as end:
        chosen, errors = end.value
        return chosen, errors


def plan_runs(settings: ResponseSettings, step: float, limit: int = MAX_STEPS) -> Plan[R]:
    """Plan the runs that settings ask for, from the `step` of the results, s.

    If the step is automatic, the steps become ever finer, `limit` in a run. Otherwise the runs have that step and, for
    an estimate, two longer ones.
    """
    order = scheme_of(settings).order
    if settings.step is None:
        return (yield from plan_refinement(step, order, settings, limit))
    if settings.estimate:
        return (yield from plan_check(step, order))
    return (yield from plan_one_run(step, StepErrors()))


def plan_one_run(step: float, errors: StepErrors) -> Plan[R]:
    """Plan one run, with errors that are known beforehand or unknown."""
    return (yield step, "integrating"), errors


def plan_check(step: float, order: int) -> Plan[R]:
    """Plan runs with a given step, and with twice and four times that, from which the error is estimated."""
    runs = [(yield step, "integrating"), (yield 2 * step, "checking with twice the step")]
    if not runs[1].reached_end:
        return runs[0], StepErrors()
    runs.append((yield 4 * step, "checking with four times the step"))
    return runs[0], estimate_step_errors(runs[::-1], order)


def plan_refinement(coarse: float, order: int, settings: ResponseSettings, limit: int = MAX_STEPS) -> Plan[R]:
    """Plan runs with ever finer steps, from twice the results' step, until the errors are within their aims.

    Displacements and peaks have the aims of the settings. The aim of the root's loads is a third of the tolerance, as
    far as LOADS_STEPS reach it. Where the results have as many steps as `limit`, all have this aim.
    """
    aims, third = (settings.aim, settings.aim_of_peaks), settings.tolerance / 3
    if round(settings.duration / coarse) == limit:
        aims = third, third

    def refinement(step: float) -> tuple[float, str]:
        return step, f"refining the step to {1e3 * step:.3g} ms"

    runs = [(yield 2 * coarse, "integrating"), (yield refinement(coarse))]
    while True:
        remaining, promised = _remaining_errors(runs[-3:], order, aims, third)
        both_ended, last_run = runs[-2].reached_end and runs[-1].reached_end, runs[-1]
        if both_ended and promised <= 1 and (check_step := _check_needed(runs, remaining)):
            checked = yield check_step, f"checking with {1e3 * check_step:.3g} ms"
            runs = sorted([*runs, checked], key=lambda run: -run.step)
            remaining, _ = _remaining_errors(runs[-3:], order, aims, third)
        excess, step_limit = promised, limit
        if both_ended and remaining <= 1 and not last_run.event_warnings and not (last_run.bends and len(runs) < 3):
            errors = estimate_step_errors(runs[-3:], order)
            excess, step_limit = 3 * errors.loads / settings.tolerance, min(limit, LOADS_STEPS)
            if not excess > 1:  # errors of loads that are NaN are not followed
                return last_run, errors
        finer = min(finer_by(excess, order), BENT if last_run.bends else JUMPS[-1])
        stuck = not (runs[-2].reached_end or last_run.reached_end) and (last_run.flight.stopped or len(runs) > 3)
        if stuck or settings.duration / last_run.step * finer > step_limit:
            break
        runs.append((yield refinement(last_run.step / finer)))
    return runs[-1], estimate_step_errors(runs[-3:], order)


def finer_by(excess: float, order: int) -> int:
    """Number of steps to divide a step into, if its error is `excess` times too large and falls by the order."""
    times = SPARE * max(excess, 1.0) ** (1 / order) if math.isfinite(excess) else 2.0
    return next((jump for jump in JUMPS if jump >= times), JUMPS[-1])


def _remaining_errors(
    runs: Sequence[Stepped], order: int, aims: tuple[float, float], enough: float
) -> tuple[float, float]:
    """Largest of the errors of displacements and peaks over their aims: by the order observed, and by the scheme's."""
    error, (aim, aim_of_peaks) = Estimate.from_runs(runs, order), aims
    aims_of_displacements = runs[-1].aims(aim, enough)

    def excess(displacements: Sequence[float], peaks: float) -> float:
        return max(peaks / aim_of_peaks, *map(truediv, displacements, aims_of_displacements))

    return excess(error.displacements, error.peaks), excess(error.promised_displacements, error.promised_peaks)


def _check_needed(runs: Sequence[Stepped], remaining: float) -> float | None:
    """Step, s, of a cheaper run that checks whether errors fall by the order, or None if no check is needed.

    After a large jump of the step unresolved modes may make the error look too small.
    """
    jump, last_run = ratio(*runs[-2:]), runs[-1]
    if last_run.bends or (remaining <= 1 and jump <= 4):
        return None
    if jump > 3:
        return (4 if jump > 6 else jump // 2) * last_run.step
    return 4 * last_run.step if len(runs) == 2 else None


def steps_beyond(motion: Motion, settings: ResponseSettings, step: float) -> tuple[int, int]:
    """Number of steps of the results in a machine's spin-up and spin-down."""
    spin_times = motion.beyond(settings.start, settings.start + settings.duration)
    if is_traced(*spin_times):
        fix = 'give spin_up and spin_down, or start = "idle"'
        raise InputError("spin_up", "is found from the load, and JAX traces the machine", fix)
    before, after = (math.ceil(float(time) / step - 1e-6) for time in spin_times)
    return before, after
