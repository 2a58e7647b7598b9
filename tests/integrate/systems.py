"""Small systems with known solutions; drives take NumPy's times and JAX's."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from gbeam.arrays import namespace, record
from gbeam.integrate import LinearEquations, NonlinearEquations

Equations = LinearEquations | NonlinearEquations


def undriven(t: Any) -> Any:
    return namespace(t).zeros_like(t)


def driven(mass: Any, drive: Any, stiffness: float = 0.0) -> LinearEquations:
    """One coordinate without damping, m q̈ + k q = f(t)."""

    def matrices(f: Any) -> Any:
        none = 0 * f[:, None, None]
        return none, none + stiffness, f[:, None]

    return LinearEquations(np.full((1, 1), mass), matrices, drive)


OSCILLATOR = driven(1.0, undriven, (2 * np.pi) ** 2)  # period 1 s, undamped


def one(value: float) -> np.ndarray:
    """A vector of one coordinate."""
    return np.array([value])


_C, _K0, _K1 = (np.array(m) for m in ([[0.2, 0.5], [-0.5, 0.1]], [[4.0, -1.0], [0.5, 9.0]], [[2.0, 0.0], [1.0, 3.0]]))


def _varying(t: Any) -> Any:
    xp, at = namespace(t), t[:, None, None]
    c = _C * (1 + 0.3 * xp.sin(at))
    return c, _K0 + _K1 * xp.cos(2 * at), xp.stack([xp.cos(3 * t), xp.exp(-t)], axis=-1)


_MASS = np.array([[2.0, 0.3], [0.3, 1.0]])
VARYING = LinearEquations(_MASS, _varying, lambda t: t)  # C, K and F vary with time; C and K are not symmetric


@record
class Pendulum:
    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return qdd + 0.1 * qd + namespace(q).sin(q) - force[..., None]


PENDULUM = NonlinearEquations(Pendulum(), lambda t: namespace(t).cos(t))


@record
class Pushed:
    """q̈ = F(t), as a residual."""

    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return qdd - force[..., None]


@record
class Bead:
    """On a parabola: its mass depends on where it is."""

    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return (1 + q**2) * qdd + q * qd**2 + q - force[..., None]


BEAD = NonlinearEquations(Bead(), lambda t: 0.5 * np.sin(t))


def rates(system: Equations) -> Any:
    """q̈ of (t, q, q̇), with numpy's own linear algebra."""
    if system is VARYING:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            c, k, f = (np.asarray(m)[0] for m in _varying(one(t)))
            return np.linalg.solve(_MASS, f - c @ qd - k @ q)

    elif system is PENDULUM:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            return np.cos(t) - 0.1 * qd - np.sin(q)

    else:

        def acceleration(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
            return (0.5 * np.sin(t) - q - q * qd**2) / (1 + q**2)

    return acceleration


def reference(system: Equations, q: Any, qd: Any, end: float) -> np.ndarray:
    """(q, q̇) at the end by an explicit method of eighth order."""
    q, n, acceleration = np.atleast_1d(q), np.size(q), rates(system)

    def right(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[n:], acceleration(t, y[:n], y[n:])])

    start = np.concatenate([q, np.atleast_1d(qd)])
    return solve_ivp(right, (0, end), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
