"""Fourth-order Gauss collocation for linear systems: two stages, no damping, unconditionally stable."""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool

from gbeam.integrate.system import LinearSystem, State

_ROOT = 3**0.5 / 6
_A = ((0.25, 0.25 - _ROOT), (0.25 + _ROOT, 0.25))
_C = (0.5 - _ROOT, 0.5 + _ROOT)
_A2 = tuple(tuple(sum(_A[i][k] * _A[k][j] for k in range(2)) for j in range(2)) for i in range(2))


class Gauss4(eqx.Module):
    """The two-stage Gauss method on M q̈ + C q̇ + K q = F: order 4 (Hairer, Nørsett and Wanner, II.7)."""

    order: int = eqx.field(static=True, default=4)
    offsets: tuple[float, ...] = eqx.field(static=True, default=(*_C, 1.0))

    def start(self, system: LinearSystem, state: State, inputs: Any) -> tuple[State, Bool[Array, ""]]:
        """Give the initial state the acceleration that its equations demand."""
        qdd, ok = system.acceleration(state.q, state.qd, 0.0, 0.0, inputs, state.qdd)
        return State(state.q, state.qd, qdd, qdd), ok

    def step(
        self, system: LinearSystem, state: State, h: Array, inputs: tuple[Any, ...]
    ) -> tuple[State, Bool[Array, ""]]:
        """One step of length h, with the inputs at its two stages and its end."""
        q, qd = state.q, state.qd
        n = q.shape[0]
        rows, right = [], []
        for i in range(2):
            c, k, f = system.matrices(inputs[i])
            rows.append([(i == j) * system.mass + h * _A[i][j] * c + h**2 * _A2[i][j] * k for j in range(2)])
            right.append(f - k @ (q + _C[i] * h * qd) - c @ qd)
        stages = jnp.linalg.solve(jnp.block(rows), jnp.concatenate(right)).reshape(2, n)
        weights = jnp.array([0.5 * (1 - _C[0]), 0.5 * (1 - _C[1])])
        q_new, qd_new = q + h * qd + h**2 * weights @ stages, qd + 0.5 * h * jnp.sum(stages, axis=0)
        qdd, ok = system.acceleration(q_new, qd_new, 0.0, 0.0, inputs[2], state.qdd)
        return State(q_new, qd_new, qdd, qdd), ok
