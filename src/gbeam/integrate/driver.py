"""Run a scheme over a time span, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_tracer, is_jax, namespace
from gbeam.arrays.types import Floats
from gbeam.integrate import linear
from gbeam.integrate.equations import Demanded, LinearEquations, NonlinearEquations, Trajectory
from gbeam.integrate.sampled import sampling_of
from gbeam.integrate.schemes import Scheme, fitting_terms
from gbeam.integrate.steps import Corners, Steps, make_steps
from gbeam.integrate.windows import windows

LINEAR_CHUNK = 500  # steps whose maps are found at once: as many as stay in a cache
Piece = tuple[Any, ...]  # q, q̇ and, unless they are computed later, q̈ (k, n), and flags of steps that were solved (k,)


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
    """Integrate `count` steps of length `step` from q, qd (n,), split at `corners`.

    `stop` maps q (k, n) of a chunk of steps to the number of steps after which to end, or None. A failed step ends the
    trajectory. Where JAX traces the equations, it leaves NaN.
    """
    steps = make_steps(start, step, count, None if corners is None else corners.felt_by(scheme))
    return integrate_steps(equations, scheme, q, qd, steps, stop=stop, progress=progress)


def integrate_steps(
    equations: LinearEquations | NonlinearEquations,
    scheme: Scheme,
    q: Any,
    qd: Any,
    steps: Steps,
    *,
    stop: Callable[[Floats], int | None] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate by `steps` as :func:`integrate` does. The result has the start and the ends of the kept ones."""
    time = np.append(steps.begin[:1], steps.end[steps.kept])
    if not np.size(q):
        return Trajectory(time, *np.zeros((3, len(time), 0)))
    if isinstance(equations, LinearEquations):
        run, samples = _linear_pieces(equations, scheme, q, qd, steps), None
    else:
        run, samples = _nonlinear_pieces(equations, scheme, q, qd, steps)
    pieces: list[tuple[Any, ...]] = []
    converged, stopped, done = True, False, 0
    for *piece, solved in run:
        if not is_jax(piece[0]):
            good = solved & np.isfinite(piece[-1]).all(axis=1)
            valid = len(good) if good.all() else int(np.argmin(good))
            converged = valid == len(good)
            stop_after = None if stop is None or valid == 0 or not pieces else stop(piece[0][:valid])
            stopped = stop_after is not None
            last = valid if stop_after is None else stop_after
            # The initial state is kept even where it has no acceleration.
            piece = [x[: last if pieces else 1] for x in piece]
        pieces.append(tuple(piece))
        done += len(piece[0]) if len(pieces) > 1 else 0
        if progress is not None:
            progress(done / (len(time) - 1))
        if stopped or not converged:
            break
    q, qd, *qdd = (namespace(parts[0]).concatenate(parts) for parts in zip(*pieces, strict=True))
    accelerations = qdd[0] if qdd else Demanded(equations, steps, q, qd, samples)  # q̈, or how to compute it
    trajectory = Trajectory(time[: len(q)], q, qd, accelerations, converged, stopped, samples)
    return replace(trajectory, stopped=stopped or trajectory.failure is not None)


def _linear_pieces(equations: LinearEquations, scheme: Scheme, q: Any, qd: Any, steps: Steps) -> Iterator[Piece]:
    """Pieces of a run of linear equations: first the initial state, then the kept steps of each chunk."""
    z, state = linear.start(equations, scheme, steps, q, qd)
    size = len(steps) if is_jax(state[-1]) else LINEAR_CHUNK
    fit = fitting_terms(equations, scheme, steps.longest)
    yield *(namespace(state[-1]).asarray(x)[None] for x in state), np.array([True])
    for done in range(0, len(steps), size):
        z, piece = linear.chunk(equations, scheme, z, steps[done : done + size], fit)
        yield *piece, np.ones(len(piece[0]), dtype=bool)


def _nonlinear_pieces(
    equations: NonlinearEquations, scheme: Scheme, q: Any, qd: Any, steps: Steps
) -> tuple[Iterator[Piece], Any]:
    """Pieces of a run of nonlinear equations, and the samples of its controllers or None, which are taken meanwhile."""
    controlled = equations.controllers is not None and equations.controllers.traced
    if controlled or holds_tracer(equations.residual, q, qd, equations.drive(steps.drive_begin[:1])):
        from gbeam.integrate.traced import traced

        run, loop = traced(equations, scheme, q, qd, steps)
        solved = np.ones(1 + np.count_nonzero(steps.kept), dtype=bool)
        first = (*(history[:1] for history in run), solved[:1])
        following = (*(history[1:][steps.kept] for history in run), solved[1:])
        return iter([first, following]), loop
    samples = sampling_of(equations, steps)
    q, qd = np.asarray(q, dtype=float), np.asarray(qd, dtype=float)
    return windows(equations, scheme, q, qd, steps, samples), samples
