"""Newton's method for the equilibrium of a complete model, and derivatives of its residual: compiled once per size."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.motion.bases.base import Base

Array = Any
_ITERATIONS = 30


@jax.jit
def newton(equations: Any, base: Base, values: Array | None, share: Array, q: Array) -> tuple[Array, Array, Array]:
    """Solve at a share of all loads: accelerations and what is applied by the share, rates by its root.

    Returns
    -------
    coordinates (n,), whether the method converged, and the tangent stiffness (n, n)
    """
    loads = None if values is None else share * values

    def residual(q: Array) -> Array:
        o = jnp.zeros_like(q)
        rate = jnp.sqrt(share) * base.w_WB_B
        return equations.residual(q, o, o, share * base.a_WO_B, rate, share * base.alpha_WB_B, loads)

    def iterate(carry: tuple[Array, ...]) -> tuple[Array, ...]:
        q, _, count, _ = carry
        stiffness = jax.jacfwd(residual)(q)
        correction = jnp.linalg.solve(stiffness, residual(q))
        return q - correction, jnp.max(jnp.abs(correction)), count + 1, stiffness

    def go_on(carry: tuple[Array, ...]) -> Array:
        q, size, count, _ = carry
        return (size > 1e-13 + 1e-12 * jnp.max(jnp.abs(q))) & (count < _ITERATIONS)

    begin = (q, jnp.array(jnp.inf), jnp.array(0), jnp.zeros((len(q), len(q))))
    q, _, count, stiffness = jax.lax.while_loop(go_on, iterate, begin)
    return q, (count < _ITERATIONS) & jnp.all(jnp.isfinite(q)), stiffness


@jax.jit
def jacobian(residual: Any, z: Array, u: Array) -> Array:
    """Derivatives of a residual with respect to (y, ẏ, ÿ) and its inputs' vector u, (n, 3n + inputs)."""
    n = z.shape[0] // 3

    def stacked(x: Array) -> Array:
        return residual(x[:n], x[n : 2 * n], x[2 * n : 3 * n], residual.unpack(x[3 * n :]))

    # One derivative with respect to everything: the residual is compiled once, not four times.
    return jax.jacfwd(stacked)(jnp.concatenate([z, u]))


@jax.jit
def evaluated(residual: Any, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
    """The residual (n,) at a state and inputs' vector."""
    return residual(y, yd, ydd, residual.unpack(u))


@jax.jit
def momentum(equations: Any, y: Array, yd: Array) -> Array:
    """Angular momentum of a free hub and its beam, N m s."""
    return equations.momentum(y, yd)
