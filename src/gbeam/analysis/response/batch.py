"""Responses of many cases: those of one shape are integrated together."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.analysis.response.record import response_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import settings_of, simulate
from gbeam.analysis.response.steps.posed import Posed, pose, steps_within
from gbeam.analysis.response.steps.step_errors import Run
from gbeam.analysis.response.steps.stepping import Plan, scheme_of
from gbeam.arrays.namespace import holds_jax
from gbeam.errors import InputError
from gbeam.integrate.trajectory import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.response import Response

TOGETHER = 32  # cases: what they carry stays in a cache, and a processor's vectors are full
LONGEST = 20_000_000  # numbers of as many trajectories: longer ones together would fill the memory


@dataclass(frozen=True, eq=False)
class _Case:
    """A case whose plan waits for a run.

    Parameters
    ----------
    index : int
        Its place among the cases.
    posed : Posed
    plan : Plan
    step : float
        Of the run that the plan waits for, s.
    run : gbeam.integrate.compiled.batch.Run
        The same, to be integrated.
    """

    index: int
    posed: Posed
    plan: Plan
    step: float
    run: Any

    @property
    def shape(self) -> Hashable | None:
        """What cases have in common that stand together; None of one that is to be integrated alone."""
        if 3 * self.run.q.size * len(self.run.steps) * TOGETHER > LONGEST:
            return None
        return None if self.run.shape is None else (self.posed.motion.kind, self.posed.structure.linear, self.run.shape)


def simulate_batch(
    cases: Iterable[tuple[Structure, Motion]],
    settings: ResponseSettings | None = None,
    *,
    together: int = TOGETHER,
    one_structure: bool = False,
    **options: Any,
) -> Iterator[tuple[int, Response]]:
    """Compute the responses of many cases.

    Cases of one shape are integrated together, some at a time, by the same steps that :func:`simulate` takes: of one
    model with equal numbers of shapes, in environments of one kind whose corners split as many steps. Where steps are
    automatic, or errors are estimated, the runs that this takes are: a case goes on to its next one beside those that
    need as many steps. A machine that spins up, runs with error control, very long ones, and those whose corrections
    fail are integrated alone. No more cases are taken from `cases` than wait for others of their shape.

    Parameters
    ----------
    cases : iterable of (Structure, motion)
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate_batch(cases, duration=10.0, step=0.01)``; ``estimate`` is false
        then unless it is given.
    together : int
        How many cases are integrated together; by default as many as a processor's cache holds; more on a GPU.
    one_structure : bool
        Whether all cases have the same structure, one object: those of complete models then take less time.

    Yields
    ------
    int, Response
        Place among the cases, and response, in the order in which they are computed.

    Raises
    ------
    InputError
        If less than one case stands together, a case has another structure than the first although they should have
        one, or as :func:`simulate` does.
    ComputationError
        If a case has no relative equilibrium to start from.

    Notes
    -----
    Errors are estimated where ``estimate=True`` says so, which costs more than a run; of a few of the cases, mostly.

    A case's digits depend neither on the cases beside it nor on their order, on one machine: with as many `together`,
    and `one_structure` alike, a case alone, the last of a hundred and one in other company give the same bytes.
    """
    settings = settings_of("simulate_batch", settings, options if settings else {"estimate": False, **options})
    if together < 1:
        raise InputError("together", f"is {together}", "give one or more")
    return _responses(cases, settings, together, one_structure)


def _responses(
    cases: Iterable[tuple[Structure, Motion]], settings: ResponseSettings, together: int, one_structure: bool
) -> Iterator[tuple[int, Response]]:
    waiting: dict[Hashable, list[_Case]] = {}

    def full(case: _Case) -> list[_Case]:
        """Let a case wait for others; these, if they are enough now."""
        queue = waiting.setdefault(case.shape, [])
        queue.append(case)
        return waiting.pop(case.shape) if len(queue) == together else []

    def through(queue: list[_Case]) -> Iterator[tuple[int, Response]]:
        """Integrate cases together, and what becomes enough by those that go on."""
        ready = [queue]
        while ready:
            for answer in _together(ready.pop(), together):
                if not isinstance(answer, _Case):
                    yield answer
                elif more := full(answer):
                    ready.append(more)

    first = None
    for index, (structure, motion) in enumerate(cases):
        first = first or structure
        if one_structure and structure is not first:
            fix = "leave out one_structure, or give the same object"
            raise InputError("one_structure", f"is true, and case {index} has another structure than the first", fix)
        structure.require_damping("the response")
        motion = motion.over(settings.start, settings.start + settings.duration)
        if structure.holds_jax or holds_jax(motion):
            raise InputError("simulate_batch", "is given what JAX traces", "map simulate over it with jax.vmap")
        posed, before, after = pose(structure, motion, settings)
        if before or after or settings.integrator == "adaptive":
            yield index, simulate(structure, motion, settings)
            continue
        case = _going_on(index, posed, structure.equations if one_structure else None, posed.plan())
        if not isinstance(case, _Case):
            yield case
        elif queue := full(case):
            yield from through(queue)
    while waiting:
        yield from through(waiting.pop(next(iter(waiting))))


def _going_on(
    index: int, posed: Posed, common: Any, plan: Plan, run: Run | None = None, known: dict[str, Any] | None = None
) -> _Case | tuple[int, Response]:
    """A case with the run that its plan wants after another; its response where there is no more to wait for.

    `known` is what :func:`response_of` need not compute if that run is the one that counts.
    """
    from gbeam.integrate.compiled import batch

    scheme = scheme_of(posed.settings)
    q, qd = (np.asarray(x) for x in (posed.problem.q, posed.problem.qd))
    try:
        while True:
            step, _ = next(plan) if run is None else plan.send(run)
            wanted = batch.Run(posed.problem.equations, q, qd, posed.steps(step), scheme, common)
            case = _Case(index, posed, plan, step, wanted)
            if case.shape is not None:
                return case
            run, known = posed.run(step, stop=posed.too_far), None
    except StopIteration as end:
        made, errors = end.value
    runs, stride = (None, made.trajectory, None), posed.stride(made.step)
    given = posed.structure, posed.motion, posed.settings, posed.problem, runs, "", made.step, errors, stride
    return index, response_of(*given, **(known if known and made is run else {}))


def _together(queue: list[_Case], together: int) -> Iterator[_Case | tuple[int, Response]]:
    from gbeam.integrate.compiled.batch import integrate_together

    # Filled with its last case: one program serves every number of them, and no digit depends on it.
    filling = [queue[-1].run] * (together - len(queue))
    trajectories = integrate_together([case.run for case in queue] + filling)
    for case, trajectory in zip(queue, trajectories, strict=False):
        posed, known = case.posed, None if trajectory is None else _known(case, trajectory)
        if trajectory is None or known is None:  # one that leaves what its model can mean stops there
            run = posed.run(case.step, stop=posed.too_far)
        else:
            run = posed.read(trajectory, case.step)
        yield _going_on(case.index, posed, case.run.common, case.plan, run, known)


def _known(case: _Case, trajectory: Trajectory) -> dict[str, Any] | None:
    """What is known of a run's response; None where it moves too far for its model."""
    posed = case.posed
    moved = np.asarray(posed.structure.displacement(trajectory.q[:, posed.problem.first :]))
    if steps_within(posed.structure, moved) is not None:
        return None
    alone = posed.structure.linear and not posed.motion.free and posed.stride(case.step) == 1
    base, _ = (case.run.at_times if alone else None) or (None, None)
    return {"base": base, "moved": moved}
