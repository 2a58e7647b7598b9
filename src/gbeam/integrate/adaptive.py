"""Adaptive integration by diffrax, for any equations."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from gbeam.integrate.equations import LinearEquations, NonlinearEquations
from gbeam.integrate.steps import Floats
from gbeam.integrate.trajectory import Trajectory


def integrate_adaptively(
    equations: LinearEquations | NonlinearEquations,
    q: Any,
    qd: Any,
    times: Floats,
    *,
    tolerance: float = 1e-8,
    jumps: Floats | None = None,
    stop: Callable[[Floats], int | None] | None = None,
) -> Trajectory:
    """Integrate with Kvaernø's 5(4) method (implicit, stiffly accurate) and error control.

    Parameters
    ----------
    equations : LinearEquations or NonlinearEquations
    q, qd : (n,)
        Initial state.
    times : (t,) where the result is put out, s, ascending
    tolerance : float
        Relative error per step; the absolute one is a thousandth of it.
    jumps : (k,), optional
        Times at which the inputs have corners: steps end there.
    stop : callable, optional
        As :func:`gbeam.integrate.integrate` takes it.
    """
    import jax.numpy as jnp

    import gbeam.arrays.jax_setup  # noqa: F401

    inside = np.asarray([] if jumps is None else jumps, dtype=float)
    inside = np.unique(inside[(inside > times[0]) & (inside < times[-1])])
    state = jnp.asarray(q, dtype=float), jnp.asarray(qd, dtype=float)
    q, qd, qdd, ok = (np.asarray(x) for x in _solver(equations)(*state, times, inside, tolerance))
    good = np.isfinite(q).all(axis=1)
    valid = len(times) if good.all() else int(np.argmin(good))
    last = None if stop is None else stop(q[:valid])
    converged, valid = bool(ok) and valid == len(times), valid if last is None else last
    return Trajectory(times[:valid], q[:valid], qd[:valid], qdd[:valid], converged, last is not None)


@lru_cache(maxsize=2)
def _solver(equations: LinearEquations | NonlinearEquations) -> Callable[..., Any]:
    """One program for equations: two tolerances, which give an error estimate, share it."""
    import diffrax  # here: it takes half a second, and few runs need it
    import jax

    acceleration = _acceleration(equations)

    def rates(t: Any, y: tuple[Any, Any], _: Any) -> tuple[Any, Any]:
        return y[1], acceleration(t, *y)

    @jax.jit
    def solve(q: Any, qd: Any, times: Any, jumps: Any, tolerance: Any) -> Any:
        span = times[-1] - times[0]
        controller = diffrax.ClipStepSizeController(
            diffrax.PIDController(rtol=tolerance, atol=tolerance * 1e-3, dtmin=1e-10 * span, force_dtmin=False),
            jump_ts=jumps if jumps.size else None,
        )
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rates),
            diffrax.Kvaerno5(),
            times[0],
            times[-1],
            None,
            (q, qd),
            saveat=diffrax.SaveAt(ts=times),
            stepsize_controller=controller,
            adjoint=diffrax.ForwardMode(),  # its loops are plain ones, half as long to compile
            max_steps=2_000_000,
            throw=False,
        )
        q, qd = solution.ys
        return q, qd, jax.vmap(acceleration)(times, q, qd), solution.result == diffrax.RESULTS.successful

    return solve


def _acceleration(equations: LinearEquations | NonlinearEquations) -> Callable[[Any, Any, Any], Any]:
    """q̈ at a time and state; the drive is evaluated inside the program."""
    import jax.numpy as jnp

    def inputs(t: Any) -> Any:
        return equations.drive(jnp.atleast_1d(t))

    if isinstance(equations, LinearEquations):

        def linear(t: Any, q: Any, qd: Any) -> Any:
            c, k, f = (x[0] for x in equations.matrices(inputs(t)))
            return jnp.linalg.solve(equations.mass, f - k @ q - c @ qd)

        return linear

    from gbeam.integrate.compiled.newton import accelerations

    def nonlinear(t: Any, q: Any, qd: Any) -> Any:
        return accelerations(equations.residual, q[None], qd[None], inputs(t))[0]

    return nonlinear
