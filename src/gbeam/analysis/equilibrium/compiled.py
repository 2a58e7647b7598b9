"""A complete model's residual, its derivatives and its momentum: compiled once per size."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401

Array = Any


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
