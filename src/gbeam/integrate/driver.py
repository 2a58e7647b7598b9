"""Run a scheme over a time span, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate import linear
from gbeam.integrate.equations import Drive, LinearEquations, NonlinearEquations
from gbeam.integrate.schemes import Scheme

CHUNK = 100  # steps per compiled call, and per look at whether to stop
_LINEAR_CHUNK = 500  # steps whose maps are found at once: as many as stay in a cache
Floats = NDArray[np.float64]
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
    pieces: list[tuple[Any, ...]] = []
    converged, stopped, done = True, False, 0
    for *piece, solved in run(equations, scheme, q, qd, start, step, count):  # type: ignore[arg-type]
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


def _times(start: float, step: float, count: int, size: int) -> Iterator[Floats]:
    """Times at the beginning of the steps of each chunk: products, not sums, so that they do not drift."""
    for done in range(0, count, size):
        yield np.asarray(start + step * np.arange(done, min(done + size, count)), dtype=np.float64)


def _linear(
    equations: LinearEquations, scheme: Scheme, q: Any, qd: Any, start: float, step: float, count: int
) -> Iterator[Piece]:
    tableau = scheme.tableau(step)
    z, qdd = linear.start(equations, tableau, start, q, qd)
    traced = is_jax(qdd)
    yield *(namespace(qdd).asarray(x)[None] for x in (q, qd, qdd)), np.array([True])
    for times in _times(start, step, count, count if traced else _LINEAR_CHUNK):
        z, piece = linear.chunk(equations, scheme, tableau, z, times, step)
        yield *piece, np.ones(len(times), dtype=bool)


def _nonlinear(
    equations: NonlinearEquations, scheme: Scheme, q: Any, qd: Any, start: float, step: float, count: int
) -> Iterator[Piece]:
    import jax

    from gbeam.integrate import newton

    tableau, residual = scheme.tableau(step), equations.residual
    qdd = newton.accelerations(residual, q[None], qd[None], equations.drive(np.array([start])))
    traced = isinstance(qdd, jax.core.Tracer)
    xp: Any = jax.numpy if traced else np
    qdd = xp.asarray(qdd)[0]
    yield *(xp.asarray(x, dtype=float)[None] for x in (q, qd, qdd)), np.array([True])
    x = xp.broadcast_to(qdd, (len(scheme.offsets), len(q)))
    carry = newton.Carry(tableau.first @ xp.stack([q, qd, qdd]), x, x)
    shape, corrections = (-1, newton.PER_JACOBIAN[scheme.order]), newton.CORRECTIONS[scheme.order]
    for times in _times(start, step, count, CHUNK):
        inside = slice(len(times))
        # Steps beyond the end fill the last chunk, so that one program serves every duration.
        filled = times[0] + step * np.arange(CHUNK)
        inputs = _stage_inputs(equations.drive, scheme, filled, step)
        at_ends = None if scheme.ends else equations.drive(filled + step)
        by_chunk = jax.tree.map(lambda leaf: leaf.reshape(*shape, *leaf.shape[1:]), inputs)
        solved: Any = np.ones(len(times), dtype=bool)
        if traced:
            after, (*piece, left) = newton.steps(residual, tableau, carry, by_chunk, at_ends, corrections)
            fine = xp.max(left[inside]) <= newton.ACCEPTED
            piece = [xp.where(fine, values[inside], xp.nan) for values in piece]
        else:
            for tries in (corrections, *newton.PATIENT):
                after, (*piece, left) = newton.quick(residual, tableau, carry, by_chunk, at_ends, tries)
                if np.all(np.asarray(left)[inside] <= newton.ACCEPTED):  # NaN is not
                    break
            else:
                after, (*piece, solved) = newton.safe(residual, tableau, carry, inputs, at_ends)
                solved = np.asarray(solved)[inside]
            piece = [np.asarray(values)[inside] for values in piece]
        carry = after
        yield *piece, solved


def _stage_inputs(drive: Drive, scheme: Scheme, times: Floats, step: float) -> Any:
    """Inputs at the stages of steps that begin at times (t,), arrays (t, s, ...)."""
    import jax

    stages = [drive(times + offset * step) for offset in scheme.offsets]
    return jax.tree.map(lambda *leaves: namespace(*leaves).stack(leaves, axis=1), *stages)
