"""Run a scheme over a time span, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate import linear
from gbeam.integrate.equations import LinearEquations, NonlinearEquations, Trajectory
from gbeam.integrate.schemes import Scheme, added
from gbeam.integrate.steps import Corners, Floats, Steps, fitted

_LINEAR_CHUNK = 500  # steps whose maps are found at once: as many as stay in a cache
Piece = tuple[Any, ...]  # q, q̇, q̈ (k, n), and which of the steps were solved (k,)


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
    """Integrate `count` steps from q, qd (n,), split at `corners`, until `stop` says after how many steps of a chunk
    (k, n) to end; a failed step ends the trajectory, or where JAX traces the equations leaves NaN.
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
    """Integrate by given steps; the result has the ends of those that are kept."""
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
    from gbeam.integrate.chunks import chunks, stretches

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
    if traced:
        yield _traced(equations, scheme, carry, steps)
        return
    sound = True
    for chunk in chunks(drive, scheme, stretches(scheme, steps, newton.PER_JACOBIAN[scheme.order])):
        for tries in (corrections, *newton.PATIENT):
            after, (*piece, left) = newton.quick(residual, *chunk.given(carry), tries, chunk.count)
            if np.all(np.asarray(left)[chunk.inside] <= newton.ACCEPTED):  # NaN is not
                solved = np.ones(len(chunk.inside), dtype=bool)
                break
        else:
            after, (*piece, solved) = newton.safe(residual, *chunk.one_by_one(scheme, carry), chunk.inside)
        piece = [np.asarray(values) for values in piece]
        carry, end = after, chunk.end
        if scheme.ends and end.anew:
            q, qd = (values[chunk.inside][-1] for values in piece[:2])
            begin, final = (
                np.asarray(newton.accelerations(residual, q[None], qd[None], drive(np.array([t]))))[0]
                for t in (end.resume, end.end)
            )
            carry = begun(q, qd, begin, end.following)
            at_end = np.arange(len(chunk.inside)) == np.flatnonzero(chunk.inside)[-1]
            piece[2] = np.where(at_end[:, None], final, piece[2])
        # A part of a step that has not been solved spoils what follows.
        solved = np.logical_and.accumulate(np.append(sound, np.asarray(solved)[chunk.inside]))[1:]
        sound = bool(solved[-1])
        yield *(values[chunk.kept] for values in piece), solved[chunk.steps.kept[chunk.inside]]


def _traced(equations: NonlinearEquations, scheme: Scheme, carry: Any, steps: Steps) -> Piece:
    """All steps in one program; from one that fails on, the values are NaN, and so are their derivatives."""
    import jax
    import jax.numpy as jnp

    from gbeam.integrate import newton

    times = np.stack([steps.times(offset) for offset in scheme.offsets], axis=1)
    inputs = jax.tree.map(lambda leaf: leaf.reshape(*times.shape, *leaf.shape[1:]), equations.drive(times.ravel()))
    at_ends = None if scheme.ends else equations.drive(steps.end)
    every = np.ones(len(steps), dtype=bool)
    tableau = scheme.tableau(steps.length)
    _, (*piece, solved) = newton.safe(equations.residual, tableau, carry, inputs, at_ends, every)
    sound = jnp.where(jnp.cumprod(solved), 1.0, jnp.nan)[:, None]
    return *(sound * values for values in piece), every
