"""Small systems with known solutions."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np
from scipy.integrate import solve_ivp

from gbeam.integrate import LinearSystem, NonlinearSystem, State


def undriven(t: Any) -> Any:
    return jnp.zeros_like(t)


def _oscillator(_: Any) -> Any:
    return jnp.zeros((1, 1)), jnp.full((1, 1), (2 * np.pi) ** 2), jnp.zeros(1)


OSCILLATOR = LinearSystem(jnp.eye(1), _oscillator, undriven)  # period 1 s, undamped


def state(q: Any, qd: Any) -> State:
    q, qd = jnp.atleast_1d(jnp.asarray(q, dtype=float)), jnp.atleast_1d(jnp.asarray(qd, dtype=float))
    return State(q, qd, 0 * q, 0 * q)


def _varying(t: Any) -> Any:
    c = jnp.array([[0.2, 0.5], [-0.5, 0.1]]) * (1 + 0.3 * jnp.sin(t))
    k = jnp.array([[4.0, -1.0], [0.5, 9.0]]) + jnp.array([[2.0, 0.0], [1.0, 3.0]]) * jnp.cos(2 * t)
    return c, k, jnp.stack([jnp.cos(3 * t), jnp.exp(-t)])


_MASS = jnp.array([[2.0, 0.3], [0.3, 1.0]])
VARYING = LinearSystem(_MASS, _varying, lambda t: t)  # C, K and F vary with time; C and K are not symmetric


def _pendulum(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
    return qdd + 0.1 * qd + jnp.sin(q) - force


PENDULUM = NonlinearSystem(_pendulum, jnp.cos)


def _bead(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
    return (1 + q**2) * qdd + q * qd**2 + q - force


BEAD = NonlinearSystem(_bead, lambda t: 0.5 * jnp.sin(t))  # on a parabola: its mass depends on where it is


def rates(system: LinearSystem | NonlinearSystem) -> Any:
    """q̈ of (t, q, q̇), with numpy's own linear algebra."""
    if system is VARYING:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            c, k, f = (np.asarray(m) for m in _varying(t))
            return np.linalg.solve(_MASS, f - c @ qd - k @ q)

    elif system is PENDULUM:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            return np.cos(t) - 0.1 * qd - np.sin(q)

    else:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            return (0.5 * np.sin(t) - q - q * qd**2) / (1 + q**2)

    return acceleration


def reference(system: LinearSystem | NonlinearSystem, q: Any, qd: Any, end: float) -> np.ndarray:
    """(q, q̇) at the end by an explicit method of eighth order."""
    q, n, acceleration = np.atleast_1d(q), np.size(q), rates(system)

    def right(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[n:], acceleration(t, y[:n], y[n:])])

    start = np.concatenate([q, np.atleast_1d(qd)])
    return solve_ivp(right, (0, end), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
