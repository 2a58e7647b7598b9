"""The expansion of a complete model about any place, by JAX: there too its small departures are a linear model.

The places' Taylor polynomial about q, with the strain energy's, is all that the sums of :mod:`linear` read: equilibria,
modes and stability of a complete model need no derivative of its residual.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.arrays.derivatives import with_slope
from gbeam.mechanics.fields.taylor import EPSILON

Array = Any


@jax.jit
def places_about(inertia: Any, q: Array) -> tuple[Array, Array, Array]:
    """Places (k, 3) of the particles at q, and their first and second derivatives, (k, 3, n) and (k, 3, n, n)."""
    (places, slope), (_, second) = with_slope(with_slope(inertia.positions))(q)
    return places, slope, second


@jax.jit
def elastic_about(elasticity: Any, q: Array) -> tuple[Array, Array]:
    """Gradient (n,) and second derivatives (n, n) of the strain energy at q."""
    return with_slope(jax.grad(elasticity.energy))(q)


@jax.jit
def loads_about(work: Any, q: Array, like: Array) -> tuple[Array, Array]:
    """Generalised forces of unit components at q, (loads, 6, 6 + n), and their derivatives (loads, 6, 6 + n, n)."""
    loads, epsilon = like.shape[0], jnp.asarray(EPSILON)
    onto = (np.arange(loads)[:, None] == work.load) * work.weight  # (loads, p)

    def unit(q: Array) -> Array:
        (r, rotation), (slope, turn) = with_slope(lambda q: (work.field.position(q), work.field.rotation(q)))(q)
        axes = jnp.where(work.follower[:, None, None], rotation, jnp.eye(3))  # in columns: the unit components
        pull = jnp.swapaxes(axes, 1, 2)
        about = jnp.einsum("abd,pb,pdc->pca", epsilon, r, axes)
        angle = -0.5 * jnp.einsum("abe,padi,pbd->pei", epsilon, turn, rotation)  # of [δθ]× = δR Rᵀ
        force = jnp.concatenate([pull, about, pull @ slope], axis=2)
        moment = jnp.concatenate([jnp.zeros_like(pull), pull, pull @ angle], axis=2)
        return jnp.tensordot(onto, jnp.concatenate([force, moment], axis=1), axes=1)

    return with_slope(unit)(q)
