"""Run a scheme over a time span, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate import linear
from gbeam.integrate.equations import Drive, LinearEquations, NonlinearEquations
from gbeam.integrate.schemes import Scheme
from gbeam.integrate.steps import Corners, Floats, Steps, fitted

CHUNK = 100  # steps per compiled call, and per look at whether to stop
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
    run = _linear if isinstance(equations, LinearEquations) else _nonlinear
    steps = fitted(start, step, count, None if corners is None else corners.felt_by(scheme))
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
            progress(done / count)
        if stopped or not converged:
            break
    q, qd, qdd = (namespace(part[0]).concatenate(part) for part in zip(*pieces, strict=True))
    time = np.asarray(start + step * np.arange(len(q)), dtype=np.float64)
    return Trajectory(time, q, qd, qdd, converged, stopped)


def _linear(equations: LinearEquations, scheme: Scheme, q: Any, qd: Any, steps: Steps) -> Iterator[Piece]:
    z, qdd = linear.start(equations, scheme, steps, q, qd)
    size = len(steps) if is_jax(qdd) else _LINEAR_CHUNK
    yield *(namespace(qdd).asarray(x)[None] for x in (q, qd, qdd)), np.array([True])
    for done in range(0, len(steps), size):
        z, piece = linear.chunk(equations, scheme, z, steps[done : done + size])
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
    for index, last in _groups(steps, newton.PER_JACOBIAN[scheme.order], restart=scheme.ends):
        inside = (np.arange(index.shape[1]) <= last[:, None]).ravel()  # the others fill their groups
        chosen = steps[index.ravel()]
        inputs = _stage_inputs(drive, scheme, chosen)
        by_group = jax.tree.map(lambda leaf, shape=index.shape: leaf.reshape(*shape, *leaf.shape[1:]), inputs)
        at_ends = None if scheme.ends else drive(chosen.end)
        tableau = scheme.tableau(steps.length[index[:, 0]])
        solved: Any = np.ones(len(inside), dtype=bool)
        if traced:
            after, (*piece, left) = newton.steps(residual, tableau, carry, by_group, at_ends, last, corrections)
            fine = xp.max(left[inside]) <= newton.ACCEPTED
            piece = [xp.where(fine, values, xp.nan) for values in piece]
        else:
            for tries in (corrections, *newton.PATIENT):
                after, (*piece, left) = newton.quick(residual, tableau, carry, by_group, at_ends, last, tries)
                if np.all(np.asarray(left)[inside] <= newton.ACCEPTED):  # NaN is not
                    break
            else:
                each = scheme.tableau(chosen.length)
                after, (*piece, solved) = newton.safe(residual, each, carry, inputs, at_ends, inside)
            piece = [np.asarray(values) for values in piece]
        carry = after
        end = steps[index[-1, last[-1]]]
        if scheme.ends and end.anew and not traced:
            q, qd = (values[inside][-1] for values in piece[:2])
            begin, there = (
                np.asarray(newton.accelerations(residual, q[None], qd[None], drive(np.array([t]))))[0]
                for t in (end.resume, end.end)
            )
            carry = begun(q, qd, begin, end.following)
            piece[2] = np.where((np.arange(len(inside)) == np.flatnonzero(inside)[-1])[:, None], there, piece[2])
        # A part of a step that has not been solved spoils what follows.
        solved = np.logical_and.accumulate(np.append(sound, np.asarray(solved)[inside]))[1:]
        sound, kept = bool(solved[-1]), inside & chosen.kept
        yield *(values[kept] for values in piece), solved[chosen.kept[inside]]


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


def _stage_inputs(drive: Drive, scheme: Scheme, steps: Steps) -> Any:
    """Inputs at the stages of steps, arrays (t, s, ...)."""
    import jax

    stages = [drive(steps.times(offset)) for offset in scheme.offsets]
    return jax.tree.map(lambda *leaves: namespace(*leaves).stack(leaves, axis=1), *stages)
