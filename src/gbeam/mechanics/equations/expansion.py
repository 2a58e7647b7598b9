"""The expansion of a complete model about any place, by JAX: there too its small departures are a linear model.

The places' Taylor polynomial about q, with the strain energy's, is all that the sums of :mod:`linear` read: equilibria,
modes and stability of a complete model need no derivative of its residual.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401

Array = Any


@jax.jit
def places_about(inertia: Any, q: Array) -> tuple[Array, Array, Array]:
    """Places (k, 3) of the particles at q, and their first and second derivatives, (k, 3, n) and (k, 3, n, n)."""
    slope = jax.jacfwd(inertia.positions)
    return inertia.positions(q), slope(q), jax.jacfwd(slope)(q)


@jax.jit
def elastic_about(elasticity: Any, q: Array) -> tuple[Array, Array]:
    """Gradient (n,) and second derivatives (n, n) of the strain energy at q."""
    return jax.grad(elasticity.energy)(q), jax.hessian(elasticity.energy)(q)


@jax.jit
def loads_about(work: Any, q: Array, like: Array) -> tuple[Array, Array]:
    """Generalised forces of unit components at q, (loads, 6, 6 + n), and their derivatives (loads, 6, 6 + n, n)."""

    def unit(q: Array) -> Array:
        return jnp.moveaxis(jax.jacfwd(work.generalised, 1)(q, jnp.zeros_like(like)), 0, 2)

    return unit(q), jax.jacfwd(unit)(q)
