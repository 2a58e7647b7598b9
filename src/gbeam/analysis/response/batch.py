"""Responses of many cases: those of one shape are integrated together."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import Problem, problem_of
from gbeam.analysis.response.record import response_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import (
    felt_corners,
    planned_steps,
    settings_of,
    simulate,
    steps_within,
)
from gbeam.analysis.response.steps.stepping import scheme_of
from gbeam.arrays.namespace import holds_jax
from gbeam.errors import InputError
from gbeam.integrate.driver import Trajectory
from gbeam.integrate.steps import fitted
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.parts.errors import StepErrors
from gbeam.results.response import Response

TOGETHER = 32  # cases: what they carry stays in a cache, and a processor's vectors are full


@dataclass(frozen=True, eq=False)
class _Case:
    """A case that waits for others of its shape."""

    index: int
    structure: Structure
    motion: Motion
    problem: Problem
    run: Any


def simulate_batch(
    cases: Iterable[tuple[Structure, Motion]],
    settings: ResponseSettings | None = None,
    *,
    together: int = TOGETHER,
    **options: Any,
) -> Iterator[tuple[int, Response]]:
    """Compute the responses of many cases, with a given step and without an estimate of their errors.

    Cases of one shape are integrated together, some at a time, by the same steps that :func:`simulate` takes: of one
    model with equal numbers of shapes, in environments of one kind whose corners split as many steps. A machine that
    spins up, and a case whose corrections fail, are integrated alone. No more cases are taken from `cases` than wait
    for others of their shape.

    Parameters
    ----------
    cases : iterable of (Structure, motion)
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate_batch(cases, duration=10.0, step=0.01)``; ``estimate`` is false
        then unless it is given.
    together : int
        How many cases are integrated together; by default as many as a processor's cache holds; more on a GPU.

    Yields
    ------
    int, Response
        Place among the cases, and response, in the order in which they are computed.

    Raises
    ------
    InputError
        If there is no step, an estimate is to be made, less than one case stands together, or as :func:`simulate` does.
    ComputationError
        If a case has no relative equilibrium to start from.

    Notes
    -----
    A batch judges nothing: simulate one or a few of its cases with an estimate.

    A case's digits depend neither on the cases beside it nor on their order, on one machine: with as many `together`, a
    case alone, the last of a hundred and one in other company give the same bytes.
    """
    settings = settings_of("simulate_batch", settings, options if settings else {"estimate": False, **options})
    if settings.step is None or settings.integrator == "adaptive":
        raise InputError("step", "is automatic, and cases that are integrated together share one", "give a step, s")
    if settings.estimate:
        raise InputError("estimate", "is true, and a batch estimates no errors", "give estimate = False")
    if together < 1:
        raise InputError("together", f"is {together}", "give one or more")
    return _responses(cases, settings, together)


def _responses(
    cases: Iterable[tuple[Structure, Motion]], settings: ResponseSettings, together: int
) -> Iterator[tuple[int, Response]]:
    waiting: dict[Hashable, list[_Case]] = {}
    for index, (structure, motion) in enumerate(cases):
        case, shape = _posed(index, structure, motion, settings)
        if case is None:
            yield index, simulate(structure, motion, settings)
            continue
        queue = waiting.setdefault((type(motion), structure.linear, shape), [])
        queue.append(case)
        if len(queue) == together:
            yield from _together(queue, settings, together)
            queue.clear()
    for queue in waiting.values():
        yield from _together(queue, settings, together)


def _posed(
    index: int, structure: Structure, motion: Motion, settings: ResponseSettings
) -> tuple[_Case | None, Hashable]:
    """A case and its shape; None of one that is to be integrated alone."""
    from gbeam.integrate.batch import Run

    structure.require_damping("the response")
    motion = motion.over(settings.start, settings.start + settings.duration)
    if structure.holds_jax or holds_jax(motion):
        raise InputError("simulate_batch", "is given what JAX traces", "map simulate over it with jax.vmap")
    coarse, step, before, after = planned_steps(structure, motion, settings)
    if before or after:
        return None, None
    assert step is not None
    problem = problem_of(structure, motion, settings.start, settings.begin)
    felt = felt_corners(structure, motion, settings, coarse, problem.equations.drive)
    count, scheme = round(settings.duration / step), scheme_of(settings)
    steps = fitted(settings.start, step, count, felt.felt_by(scheme))
    run = Run(problem.equations, np.asarray(problem.q), np.asarray(problem.qd), steps, scheme)
    return None if run.shape is None else _Case(index, structure, motion, problem, run), run.shape


def _together(queue: list[_Case], settings: ResponseSettings, together: int) -> Iterator[tuple[int, Response]]:
    from gbeam.integrate.batch import integrate_together

    if not queue:
        return
    # Filled with its last case: one program serves every number of them, and no digit depends on it.
    filling = [queue[-1].run] * (together - len(queue))
    trajectories = integrate_together([case.run for case in queue] + filling)
    for case, trajectory in zip(queue, trajectories, strict=False):
        yield case.index, _response(case, trajectory, settings)


def _response(case: _Case, trajectory: Trajectory | None, settings: ResponseSettings) -> Response:
    structure, motion, problem = case.structure, case.motion, case.problem
    if trajectory is not None:
        moved = np.asarray(structure.displacement(trajectory.q[:, problem.first :]))
        if steps_within(structure, moved) is None:
            base, _ = (case.run.at_times if structure.linear and not motion.free else None) or (None, None)
            runs, step = (None, trajectory, None), settings.duration / (len(trajectory.time) - 1)
            given = structure, motion, settings, problem, runs, "", step, StepErrors(), 1
            return response_of(*given, base=base, moved=moved)
    # One that leaves what its model can mean stops there.
    return simulate(structure, motion, settings)
