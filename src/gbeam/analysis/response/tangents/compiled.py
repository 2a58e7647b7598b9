"""Jacobians and residuals of nonlinear equations at many states, compiled by JAX."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from gbeam.arrays.derivatives import with_slope

Array = Any
_BLOCK = 256  # states handled together: one compiled shape


def about(residual: Any, q: Array, qd: Array, inputs: Any) -> tuple[Array, Array, Array, Array]:
    """M, C, K (t, n, n) and the accelerations q̈ (t, n) of equations at states and inputs with a leading axis t."""
    return _by_blocks(_about, residual, q, qd, inputs)


def residuals(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
    """Residuals (t, n) at states and inputs with a leading axis t."""
    return _by_blocks(_residuals, residual, q, qd, qdd, inputs)


@jax.jit
def _about(residual: Any, q: Array, qd: Array, inputs: Any) -> Any:
    def at(q: Array, qd: Array, inputs: Any) -> Any:
        # The equations are linear in q̈.
        rest, mass = with_slope(lambda qdd: residual(q, qd, qdd, inputs))(jnp.zeros_like(q))
        qdd = jnp.linalg.solve(mass, -rest)
        k, c = jax.jacfwd(lambda q, qd: residual(q, qd, qdd, inputs), argnums=(0, 1))(q, qd)
        return mass, c, k, qdd

    return jax.vmap(at)(q, qd, inputs)


@jax.jit
def _residuals(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Any:
    return jax.vmap(residual)(q, qd, qdd, inputs)


def _by_blocks(function: Callable[..., Any], residual: Any, *values: Any) -> Any:
    size = len(values[0])
    pieces = []
    for first in range(0, size, _BLOCK):
        index = np.minimum(np.arange(first, first + _BLOCK), size - 1)  # the last fills the block
        piece = function(residual, *jax.tree.map(lambda leaf, index=index: leaf[index], values))
        pieces.append(jax.tree.map(lambda leaf, kept=size - first: np.asarray(leaf[:kept]), piece))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *pieces)
