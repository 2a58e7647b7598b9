"""Adaptive integration by diffrax, for any system."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from gbeam.integrate.driver import Floats, Trajectory
from gbeam.integrate.system import State, System


def _rates(t: Any, y: tuple[Any, Any], system: System) -> tuple[Any, Any]:
    q, qd = y
    inputs = jax.tree.map(lambda x: x[0], system.inputs(jnp.atleast_1d(t)))
    qdd, _, _ = system.acceleration(q, qd, 0.0, 0.0, inputs, jnp.zeros_like(q), system.blank(q.shape[0]))
    return qd, qdd


@eqx.filter_jit
def _solve(system: System, state: State, times: Any, tolerance: Any, jumps: Any) -> Any:
    import diffrax  # here: it takes half a second, and few runs need it

    controller = diffrax.ClipStepSizeController(
        diffrax.PIDController(
            rtol=tolerance, atol=tolerance * 1e-3, dtmin=1e-10 * (times[-1] - times[0]), force_dtmin=False
        ),
        jump_ts=jumps,
    )
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(_rates),
        diffrax.Kvaerno5(),
        times[0],
        times[-1],
        None,
        (state.q, state.qd),
        system,
        saveat=diffrax.SaveAt(ts=times),
        stepsize_controller=controller,
        max_steps=2_000_000,
        throw=False,
    )
    q, qd = solution.ys
    qdd = jax.vmap(lambda t, q, qd: _rates(t, (q, qd), system)[1])(times, q, qd)
    return q, qd, qdd, solution.result == diffrax.RESULTS.successful


def integrate_adaptively(
    system: System,
    state: State,
    times: Floats,
    *,
    tolerance: float = 1e-8,
    jumps: Floats | None = None,
    stop: Callable[[Floats], int | None] | None = None,
) -> Trajectory:
    """Integrate with Kvaernø's 5(4) method (implicit, stiffly accurate) and error control.

    Parameters
    ----------
    system : System
    state : State
        Initial q and q̇.
    times : (t,) where the result is wanted, s, ascending
    tolerance : float
        Relative error per step; the absolute one is a thousandth of it.
    jumps : (k,), optional
        Times at which the inputs have corners: steps end there.
    stop : callable, optional
        As :func:`gbeam.integrate.integrate` takes it.
    """
    inside = np.asarray([] if jumps is None else jumps, dtype=float)
    inside = np.unique(inside[(inside > times[0]) & (inside < times[-1])])
    q, qd, qdd, ok = _solve(system, state, jnp.asarray(times), tolerance, jnp.asarray(inside) if inside.size else None)
    q, qd, qdd = (np.asarray(x) for x in (q, qd, qdd))
    good = np.isfinite(q).all(axis=1)
    valid = len(times) if good.all() else int(np.argmin(good))
    last = None if stop is None else stop(q[:valid])
    converged, valid = bool(ok) and valid == len(times), valid if last is None else last
    return Trajectory(times[:valid], q[:valid], qd[:valid], qdd[:valid], converged, last is not None)
