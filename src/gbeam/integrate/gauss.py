"""Fourth-order Gauss collocation: two stages, no damping, unconditionally stable."""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool

from gbeam.integrate.system import State, System

_ROOT = 3**0.5 / 6
_A = np.array([[0.25, 0.25 - _ROOT], [0.25 + _ROOT, 0.25]])
_C = np.array([0.5 - _ROOT, 0.5 + _ROOT])


class Gauss4(eqx.Module):
    """The two-stage Gauss method on second-order equations: order 4 (Hairer, Nørsett and Wanner, II.7)."""

    order: int = eqx.field(static=True, default=4)
    offsets: tuple[float, ...] = eqx.field(static=True, default=(float(_C[0]), float(_C[1]), 1.0))

    def start(self, system: System, state: State, inputs: Any) -> tuple[State, Bool[Array, ""]]:
        """Give the initial state the acceleration that its equations demand."""
        n = state.q.shape[0]
        qdd, ok, last = system.acceleration(state.q, state.qd, 0.0, 0.0, inputs, state.qdd, system.blank(n))
        return State(state.q, state.qd, qdd, qdd, (system.blank(2 * n), last)), ok

    def step(self, system: System, state: State, h: Array, inputs: tuple[Any, ...]) -> tuple[State, Bool[Array, ""]]:
        """One step of length h, with the inputs at its two stages and its end."""
        q, qd, (of_stages, of_end) = state.q, state.qd, state.memory
        at, moving = q + h * _C[:, None] * qd, jnp.stack([qd, qd])
        guess = jnp.stack([state.qdd, state.qdd])
        cq, cv = h**2 * (_A @ _A), h * _A
        stages, found, of_stages = system.stages(at, moving, cq, cv, inputs[:2], guess, of_stages)
        q_new, qd_new = q + h * qd + h**2 * 0.5 * (1 - _C) @ stages, qd + 0.5 * h * jnp.sum(stages, axis=0)
        qdd, ok, of_end = system.acceleration(q_new, qd_new, 0.0, 0.0, inputs[2], state.qdd, of_end)
        return State(q_new, qd_new, qdd, qdd, (of_stages, of_end)), found & ok
