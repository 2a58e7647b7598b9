"""A complete model's residual and its derivatives: compiled once per size."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from gbeam.arrays.derivatives import with_slope

Array = Any


@jax.jit
def evaluated(residual: Any, z: Array, u: Array) -> tuple[Array, Array]:
    """A residual (n,) at (y, ẏ, ÿ) and its inputs' vector u, and its derivatives there, (n, 3n + inputs)."""
    n = z.shape[0] // 3

    def stacked(x: Array) -> Array:
        return residual(x[:n], x[n : 2 * n], x[2 * n : 3 * n], residual.unpack(x[3 * n :]))

    # One derivative with respect to everything: the residual is compiled once, not four times.
    return with_slope(stacked)(jnp.concatenate([z, u]))
