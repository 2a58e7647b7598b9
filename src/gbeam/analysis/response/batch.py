"""Responses of many cases: cases whose arrays have the same shapes are integrated together."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sized
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any, TypeVar, Unpack

import numpy as np

from gbeam.analysis.response.peaks import displacement_peaks
from gbeam.analysis.response.posed import Posed, begun, pose, prepared, tries
from gbeam.analysis.response.record import response_of
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings, Settings
from gbeam.analysis.response.simulation import settings_of, simulate
from gbeam.analysis.response.stepping import Plan, scheme_of
from gbeam.arrays.namespace import holds_jax
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.progress import Bar, Progress, tell
from gbeam.results.errors import StepErrors

Item = TypeVar("Item")
TOGETHER = 32  # cases: their states stay in a processor's cache, and its vectors are full
LONGEST = 20_000_000  # numbers of that many trajectories: longer ones together would fill the memory
SHORT = 100_000  # numbers of the displacements that are read at once: more of them would leave the cache


@dataclass(frozen=True, eq=False)
class _Case:
    """A case by its index, whose plan waits for the `run` by steps of a length, s."""

    index: int
    posed: Posed
    plan: Plan[Run]
    step: float
    run: Any

    @property
    def shape(self) -> Hashable | None:
        """Key, equal for cases that can be integrated together, or None for a case to be integrated alone."""
        if 3 * self.run.q.size * len(self.run.steps) * TOGETHER > LONGEST:
            return None
        return self.run.shape


@dataclass(frozen=True, eq=False)
class _Ended:
    """A case whose runs are done: the run that counts, its errors, and displacements of its bodies, at every step, that
    are `known`.
    """

    index: int
    posed: Posed
    run: Run
    errors: StepErrors
    known: dict[str, Any]


@typed
def simulate_batch(
    cases: Iterable[tuple[Structure | System, Motion | None]],
    settings: ResponseSettings | None = None,
    *,
    together: int = TOGETHER,
    one_structure: bool = False,
    progress: Progress = None,
    **options: Unpack[Settings],
) -> Iterator[tuple[int, Any]]:
    """Compute the responses of many cases.

    Cases of one shape are integrated together, some at a time, by the same steps that :func:`simulate` takes. Such
    cases have one model with equal numbers of shapes, environments of one kind, and about as many steps. Where steps
    are automatic, or errors are estimated, a case takes several runs: it goes on to the next one beside cases that need
    about as many steps. A machine that spins up, a system with controllers, runs with error control, very long ones,
    and those whose corrections fail are integrated alone. No more cases are taken from `cases` than wait for others of
    their shape.

    Parameters
    ----------
    cases : iterable of (Structure or System, motion)
        The motion of a system is its ground's, None where it rests.
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate_batch(cases, duration=10.0, step=0.01)``; ``estimate`` is false
        then unless it is given.
    together : int
        How many cases are integrated together; by default as many as a processor's cache holds; more on a GPU.
    one_structure : bool
        Whether all cases have the same structure, one object: those of complete models then take less time.
    progress : callable or bool, optional
        Called with how many cases are done and the fraction of them, zero where their number is not known; True shows
        a bar while responses are taken.

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

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> hubs = [gb.Hub(radius=0.5, rate=gb.SmoothStep(level, 2.0)) for level in (1.0, 2.0, 3.0)]
    >>> cases = [(structure, hub) for hub in hubs]
    >>> for place, response in gb.simulate_batch(cases, duration=4.0, step=0.002):
    ...     print(place, f"{1e6 * response.peaks.max_abs[1]:.2f} µm")
    0 0.84 µm
    1 1.69 µm
    2 2.53 µm
    """
    settings = settings_of(settings, options if settings else {"estimate": False, **options})
    if together < 1:
        raise InputError("together", f"is {together}", "give one or more")
    return _told(_responses(cases, settings, together, one_structure), cases, progress)


def _told(responses: Iterator[tuple[int, Any]], cases: Iterable[Any], progress: Progress) -> Iterator[tuple[int, Any]]:
    """Yield the responses, and tell how many are done after each."""
    count = len(cases) if isinstance(cases, Sized) else 0
    total = f" of {count}" if count else ""
    with Bar() if progress is True else nullcontext(progress) as told:
        tell(told, f"0{total} cases, compiling first", 0.0)
        for done, answer in enumerate(responses, 1):
            tell(told, f"{done}{total} cases", done / count if count else 0.0)
            yield answer


def _responses(
    cases: Iterable[tuple[Structure | System, Motion | None]],
    settings: ResponseSettings,
    together: int,
    one_structure: bool,
) -> Iterator[tuple[int, Any]]:
    """Yield index and response of each case, integrating `together` cases as soon as so many of one shape wait."""
    waiting: dict[Hashable, list[_Case]] = {}

    def enqueue(case: _Case) -> list[_Case]:
        """Put a case into its queue. Returns the queue if it is full, else an empty list."""
        queue = waiting.setdefault(case.shape, [])
        queue.append(case)
        return waiting.pop(case.shape) if len(queue) == together else []

    def run(queue: list[_Case]) -> Iterator[tuple[int, Any]]:
        """Integrate a queue together, then the queues that its cases fill as they wait for their next runs."""
        ready = [queue]
        while ready:
            for answer in _integrate_queue(ready.pop(), together):
                if not isinstance(answer, _Case):
                    yield answer
                    continue
                full_queue = enqueue(answer)
                if full_queue:
                    ready.append(full_queue)

    first, last, traced = None, None, False
    structure: Any
    for index, (structure, motion) in enumerate(cases):
        first = first or structure
        if one_structure and structure is not first:
            fix = "leave out one_structure, or give the same object"
            raise InputError("one_structure", f"is true, and case {index} has another structure than the first", fix)
        if structure is not last:
            last, traced = structure, structure.holds_jax
        subject = prepared(structure, motion, settings)
        if traced or holds_jax(subject.motion):
            raise InputError("simulate_batch", "is given what JAX traces", "map simulate over it with jax.vmap")
        start = begun(subject, settings, settings.start)
        *longer, (result_step, limit) = tries(subject, settings, start)
        posed = None if longer else pose(subject, settings, result_step, limit, start)
        if (
            posed is None
            or posed.steps_before
            or posed.steps_after
            or posed.controllers is not None
            or not len(start.y)
        ):
            yield index, simulate(structure, subject.motion, settings)
            continue
        common = [body.equations for body in posed.system.flexible.values()] if one_structure else None
        case = _advance(index, posed, common, posed.plan())
        if isinstance(case, _Ended):
            yield from _responses_of([case])
            continue
        full_queue = enqueue(case)
        if full_queue:
            yield from run(full_queue)
    while waiting:
        yield from run(waiting.pop(next(iter(waiting))))


def _advance(
    index: int,
    posed: Posed,
    common: Any,
    plan: Plan[Run],
    run: Run | None = None,
    known: dict[str, Any] | None = None,
) -> _Case | _Ended:
    """Send a run to a plan, and return the case with the run that it wants next, or ended.

    `known` belongs to the run that is sent, and is kept if the plan chooses that run. Runs that cannot be integrated
    together are made at once.
    """
    from gbeam.integrate import side_by_side

    scheme = scheme_of(posed.settings)
    q, qd = np.asarray(posed.start.y), np.asarray(posed.start.yd)
    try:
        while True:
            step, _ = next(plan) if run is None else plan.send(run)
            wanted = side_by_side.Run(posed.equations, q, qd, posed.steps(step), scheme, common)
            case = _Case(index, posed, plan, step, wanted)
            if case.shape is not None:
                return case
            run, known = Run.by_steps(posed, step), None
    except StopIteration as end:
        chosen, errors = end.value
    return _Ended(index, posed, chosen, errors, known if known and chosen is run else {})


def _integrate_queue(queue: list[_Case], together: int) -> Iterator[_Case | tuple[int, Any]]:
    """Integrate a queue.

    Yields the cases that wait for another run, and index and response of those that have ended.
    """
    from gbeam.integrate.side_by_side import integrate_together

    # Filled up with the last case: one compiled program serves queues of any length, without a change of digits.
    filling = [queue[-1].run] * (together - len(queue))
    trajectories = integrate_together([case.run for case in queue] + filling)[: len(queue)]
    stations = max(sum(len(body.stations) for body in case.posed.system.flexible.values()) for case in queue)
    count = max(1, SHORT // (3 * len(queue[0].run.steps) * max(stations, 1)))
    for k in range(0, len(queue), count):
        yield from _read(queue[k : k + count], trajectories[k : k + count])


def _read(queue: list[_Case], trajectories: list[Trajectory | None]) -> Iterator[_Case | tuple[int, Any]]:
    """Send the cases their trajectories.

    Yields the cases that wait for another run, and the responses of the others.
    """
    ended = []
    for case, trajectory, moved in zip(queue, trajectories, _displaced(queue, trajectories), strict=True):
        posed, known = case.posed, dict[str, Any]()
        if trajectory is None or posed.steps_in_bounds(trajectory.q, moved) is not None:
            run = Run.by_steps(posed, case.step)  # which stops where its model ceases to hold
        else:
            run = Run(trajectory, case.step, posed)
            known = dict(moved)
        next_case = _advance(case.index, posed, case.run.common, case.plan, run, known)
        if isinstance(next_case, _Case):
            yield next_case
        else:
            ended.append(next_case)
    yield from _responses_of(ended)


def _displaced(queue: list[_Case], trajectories: list[Trajectory | None]) -> list[dict[str, Any]]:
    """Displacements (t, s, 3) m of the stations of each body at every step, by name, for each trajectory."""
    displacements: list[dict[str, Any]] = [{} for _ in queue]
    completed = []  # index, body, its columns, its name, and the trajectory
    for k, (case, trajectory) in enumerate(zip(queue, trajectories, strict=True)):
        if trajectory is not None:
            for name, body in case.posed.system.flexible.items():
                completed.append((k, body, case.posed.columns(name), name, trajectory))
    for group in _group_by(completed, lambda item: (id(item[1]), len(item[-1].time))):
        body = group[0][1]
        q = np.stack([trajectory.q[:, columns] for _, _, columns, _, trajectory in group])
        for (k, _, _, name, _), moved in zip(group, np.asarray(body.displacement(q)), strict=True):
            displacements[k][name] = moved
    return displacements


def _responses_of(ended: list[_Ended]) -> Iterator[tuple[int, Any]]:
    """Indices and responses of cases that have ended. Peaks are computed together for each structure and grid."""

    completed = [
        (k, name, body, case.posed.columns(name))
        for k, case in enumerate(ended)
        for name, body in case.posed.system.flexible.items()
        if case.known
    ]

    def key(item: tuple[int, str, Structure, slice]) -> Hashable:
        k, _, body, columns = item
        return id(body), columns.start, ended[k].run.flight.time.tobytes()

    known: list[dict[str, Any]] = [{} for _ in ended]
    for group in _group_by(completed, key):
        first, name, body, columns = group[0]
        moved = np.stack([ended[k].known[name] for k, *_ in group])
        trajectories, late = [ended[k].run.flight for k, *_ in group], ended[first].posed.settings.residual_from
        peaks = displacement_peaks(body, trajectories, columns, moved, late)
        for (k, name, *_), displacement, case_peaks in zip(group, moved, peaks, strict=True):
            known[k][name] = displacement.copy(), case_peaks
    for case, known_bodies in zip(ended, known, strict=True):
        yield case.index, response_of(case.run, case.errors, "", known=known_bodies)


def _group_by(items: Iterable[Item], key: Callable[[Item], Hashable]) -> Iterable[list[Item]]:
    """Group items by equal keys, in the order of the first of each."""
    groups: dict[Hashable, list[Item]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups.values()
