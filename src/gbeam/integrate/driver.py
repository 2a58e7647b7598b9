"""Run a scheme over a time span, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate import linear
from gbeam.integrate.equations import Drive, LinearEquations, NonlinearEquations
from gbeam.integrate.fitting import added
from gbeam.integrate.schemes import Scheme
from gbeam.integrate.steps import Corners, Floats, Steps, fitted

CHUNK = 200  # steps per compiled call at most, and per look at whether to stop
_AT_ONCE = 20  # chunks whose inputs are computed at once
_LINEAR_CHUNK = 500  # steps whose maps are found at once: as many as stay in a cache
Piece = tuple[Any, ...]  # q, q̇, q̈ (k, n), and which of the steps were solved (k,)


@dataclass(frozen=True)
class Trajectory:
    """Coordinates over time, as far as the integration got.

    Parameters
    ----------
    time : (t,) s
    q, qd, qdd : (t, n)
    converged : bool
        False where the acceleration could not be computed in the step after the last time.
    stopped : bool
        Whether the caller's condition stopped it.
    """

    time: Floats
    q: Any
    qd: Any
    qdd: Any
    converged: bool = True
    stopped: bool = False

    @property
    def whole(self) -> bool:
        """Whether it came to its end."""
        return self.converged and not self.stopped


def integrate(
    equations: LinearEquations | NonlinearEquations,
    scheme: Scheme,
    q: Any,
    qd: Any,
    *,
    step: float,
    count: int,
    start: float = 0.0,
    corners: Corners | None = None,
    stop: Callable[[Floats], int | None] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate `count` steps of length `step`.

    Parameters
    ----------
    equations : LinearEquations or NonlinearEquations
    scheme : Scheme
    q, qd : (n,)
        Initial state; the accelerations follow from the equations.
    step : float
        s.
    count : int
    start : float
        Initial time, s.
    corners : Corners, optional
        Where the drive has corners and jumps: a step within which lies one that the scheme feels is split there. The
        result has the ends of whole steps.
    stop : callable, optional
        Of the coordinates (k, n) of a chunk: the number of steps after which the run ends, or None.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    Trajectory
        Of count + 1 times; fewer where a step failed, a value was not finite, or `stop` said so. Traced equations are
        run to the end without a look at their values: a step that fails leaves NaN.
    """
    steps = fitted(start, step, count, None if corners is None else corners.felt_by(scheme))
    return through(equations, scheme, q, qd, steps, stop=stop, progress=progress)


def through(
    equations: LinearEquations | NonlinearEquations,
    scheme: Scheme,
    q: Any,
    qd: Any,
    steps: Steps,
    *,
    stop: Callable[[Floats], int | None] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """The same by steps that are given; the result has the ends of those that are kept."""
    run = _linear if isinstance(equations, LinearEquations) else _nonlinear
    time = np.append(steps.begin[:1], steps.end[steps.kept])
    pieces: list[tuple[Any, ...]] = []
    converged, stopped, done = True, False, 0
    for *piece, solved in run(equations, scheme, q, qd, steps):  # type: ignore[arg-type]
        if not is_jax(piece[0]):
            good = solved & np.isfinite(piece[2]).all(axis=1)
            valid = len(good) if good.all() else int(np.argmin(good))
            converged = valid == len(good)
            last = None if stop is None or valid == 0 or not pieces else stop(piece[0][:valid])
            stopped = last is not None
            kept = valid if last is None else last
            # The initial state is kept even where it has no acceleration.
            piece = [x[: kept if pieces else 1] for x in piece]
        pieces.append(tuple(piece))
        done += len(piece[0]) if len(pieces) > 1 else 0
        if progress is not None:
            progress(done / (len(time) - 1))
        if stopped or not converged:
            break
    q, qd, qdd = (namespace(part[0]).concatenate(part) for part in zip(*pieces, strict=True))
    return Trajectory(time[: len(q)], q, qd, qdd, converged, stopped)


def _linear(equations: LinearEquations, scheme: Scheme, q: Any, qd: Any, steps: Steps) -> Iterator[Piece]:
    z, qdd = linear.start(equations, scheme, steps, q, qd)
    size, fit = len(steps) if is_jax(qdd) else _LINEAR_CHUNK, added(equations, scheme, steps.longest)
    yield *(namespace(qdd).asarray(x)[None] for x in (q, qd, qdd)), np.array([True])
    for done in range(0, len(steps), size):
        z, piece = linear.chunk(equations, scheme, z, steps[done : done + size], fit)
        yield *piece, np.ones(len(piece[0]), dtype=bool)


def _nonlinear(equations: NonlinearEquations, scheme: Scheme, q: Any, qd: Any, steps: Steps) -> Iterator[Piece]:
    import jax

    from gbeam.integrate import newton

    drive, residual = equations.drive, equations.residual
    qdd = newton.accelerations(residual, q[None], qd[None], drive(steps.first[:1]))
    traced = isinstance(qdd, jax.core.Tracer)
    xp: Any = jax.numpy if traced else np
    qdd = xp.asarray(qdd)[0]
    yield *(xp.asarray(x, dtype=float)[None] for x in (q, qd, qdd)), np.array([True])

    def begun(q: Any, qd: Any, qdd: Any, length: Any) -> newton.Carry:
        x = xp.broadcast_to(qdd, (len(scheme.offsets), len(q)))
        return newton.Carry(scheme.tableau(length).first @ xp.stack([q, qd, qdd]), x, x)

    carry, corrections = begun(q, qd, qdd, steps.length[0]), newton.CORRECTIONS[scheme.order]
    sound = True
    for chunk in chunks(drive, scheme, stretches(scheme, steps, newton.PER_JACOBIAN[scheme.order])):
        if traced:
            after, (*piece, left) = newton.steps(residual, *chunk.given(carry), corrections)
            fine = xp.max(left[chunk.inside]) <= newton.ACCEPTED
            piece, solved = [xp.where(fine, values, xp.nan) for values in piece], np.ones(len(chunk.inside), dtype=bool)
        else:
            for tries in (corrections, *newton.PATIENT):
                after, (*piece, left) = newton.quick(residual, *chunk.given(carry), tries, chunk.count)
                if np.all(np.asarray(left)[chunk.inside] <= newton.ACCEPTED):  # NaN is not
                    solved = np.ones(len(chunk.inside), dtype=bool)
                    break
            else:
                after, (*piece, solved) = newton.safe(residual, *chunk.one_by_one(scheme, carry), chunk.inside)
            piece = [np.asarray(values) for values in piece]
        carry, end = after, chunk.end
        if scheme.ends and end.anew and not traced:
            q, qd = (values[chunk.inside][-1] for values in piece[:2])
            begin, there = (
                np.asarray(newton.accelerations(residual, q[None], qd[None], drive(np.array([t]))))[0]
                for t in (end.resume, end.end)
            )
            carry = begun(q, qd, begin, end.following)
            at_end = np.arange(len(chunk.inside)) == np.flatnonzero(chunk.inside)[-1]
            piece[2] = np.where(at_end[:, None], there, piece[2])
        # A part of a step that has not been solved spoils what follows.
        solved = np.logical_and.accumulate(np.append(sound, np.asarray(solved)[chunk.inside]))[1:]
        sound = bool(solved[-1])
        yield *(values[chunk.kept] for values in piece), solved[chunk.steps.kept[chunk.inside]]


@dataclass(frozen=True)
class Chunk:
    """Steps of one compiled call, and what drives the equations in them.

    Parameters
    ----------
    steps : Steps
        With the fillings of the groups.
    last : (groups,)
        Index of the last step of each group, −1 of a group of fillings.
    tableau : Tableau
        Of the groups.
    inputs : arrays (groups, steps, s, ...)
        At the stages.
    at_ends : arrays (groups, steps, ...) or None
        At the ends of the steps, where the last stage is not there.
    """

    steps: Steps
    last: Any
    tableau: Any
    inputs: Any
    at_ends: Any

    @cached_property
    def inside(self) -> Any:
        """Which steps are no fillings."""
        return (np.arange(len(self.steps) // len(self.last)) <= self.last[:, None]).ravel()

    @cached_property
    def kept(self) -> Any:
        """Which of them belong to the result."""
        return self.inside & self.steps.kept

    @property
    def count(self) -> int:
        """Groups that are not of fillings."""
        return int(np.count_nonzero(self.last >= 0))

    @property
    def end(self) -> Steps:
        """The last step that is no filling."""
        return self.steps[np.flatnonzero(self.inside)[-1]]

    def given(self, carry: Any) -> tuple[Any, Any, Any, Any, Any]:
        """What :func:`newton.steps` takes of it."""
        return self.tableau, carry, self.inputs, self.at_ends, self.last

    def one_by_one(self, scheme: Scheme, carry: Any) -> tuple[Any, Any, Any, Any]:
        """What :func:`newton.safe` takes."""
        import jax

        flat = [
            jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:]), part) for part in (self.inputs, self.at_ends)
        ]
        return scheme.tableau(self.steps.length), carry, flat[0], flat[1]


@dataclass(frozen=True)
class Stretch:
    """Many chunks of a run's steps, without what drives the equations in them: the same for every run with these steps.

    Parameters
    ----------
    steps : Steps
        Of all groups of all chunks, with their fillings.
    shape : (groups, steps)
    lasts : list of (groups,)
        Of each chunk, as :class:`Chunk` has them.
    tableau : Tableau
        Of the groups.
    times : (steps, stages)
        At which inputs are needed, s; the end of the step is the last where the last stage is not there.
    """

    steps: Steps
    shape: tuple[int, int]
    lasts: list[Any]
    tableau: Any
    times: Any


def stretches(scheme: Scheme, steps: Steps, size: int) -> Iterator[Stretch]:
    """Steps in groups of `size`, some chunks at a time."""
    all_groups = list(_groups(steps, size, restart=scheme.ends))
    for some in (all_groups[k : k + _AT_ONCE] for k in range(0, len(all_groups), _AT_ONCE)):
        index = np.concatenate([each for each, _ in some])
        chosen, tableau = steps[index.ravel()], scheme.tableau(steps.length[index[:, 0]])
        times = [chosen.times(offset) for offset in scheme.offsets] + ([] if scheme.ends else [chosen.end])
        yield Stretch(chosen, index.shape, [last for _, last in some], tableau, np.stack(times, axis=1))


def chunks(drive: Drive, scheme: Scheme, of: Iterable[Stretch]) -> Iterator[Chunk]:
    """The chunks with what drives them, which is computed for many at once."""
    import jax

    stages = len(scheme.offsets)
    for stretch in of:
        (groups, size), first = stretch.shape, 0
        given = drive(stretch.times.ravel())
        given = jax.tree.map(lambda leaf, to=(groups, size, -1): leaf.reshape(*to, *leaf.shape[1:]), given)
        at_ends = None if scheme.ends else jax.tree.map(lambda leaf: leaf[:, :, stages], given)
        inputs = jax.tree.map(lambda leaf: leaf[:, :, :stages], given)
        for last in stretch.lasts:
            part = slice(first, first + len(last))
            own = jax.tree.map(lambda leaf, part=part: leaf[part], (stretch.tableau, inputs, at_ends))
            yield Chunk(stretch.steps[part.start * size : part.stop * size], last, *own)
            first = part.stop


def _groups(steps: Steps, size: int, *, restart: bool) -> Iterator[tuple[Any, Any]]:
    """Indices (groups, size) of the steps of each chunk, and the last (groups,) of each group that is not a filling.

    Steps of a group are of one length. Where the scheme is to `restart`, a chunk ends wherever it starts anew.
    """
    ends = np.append(np.flatnonzero(steps.anew[:-1]), len(steps) - 1)
    starts = [np.arange(a, b + 1, size) for a, b in zip(np.append(0, ends[:-1] + 1), ends, strict=True)]
    stretches = [np.stack([first, np.full(len(first), end)]) for first, end in zip(starts, ends, strict=True)]
    for run in stretches if restart else [np.concatenate(stretches, axis=1)]:
        for done in range(0, run.shape[1], CHUNK // size):
            first, end = run[:, done : done + CHUNK // size]
            # Groups beyond the last fill the chunk, so that one program serves every duration.
            fill = CHUNK // size - len(first)
            last = np.append(np.minimum(end - first, size - 1), np.full(fill, -1))
            first, end = (np.append(x, np.full(fill, end[-1])) for x in (first, end))
            yield np.minimum(first[:, None] + np.arange(size), end[:, None]), last
