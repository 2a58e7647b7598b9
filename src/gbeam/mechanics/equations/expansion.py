"""The expansion of a complete model about any place, by JAX: there too its small departures are a linear model.

The places' Taylor polynomial about q, with the strain energy's, is all that the sums of :mod:`linear` read: equilibria,
modes and stability of a complete model need no derivative of its residual.
"""

from __future__ import annotations

from typing import Any

import jax

from gbeam.arrays.derivatives import with_slope
from gbeam.mechanics.fields.taylor import Places

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
    (place, slope), (_, second) = with_slope(with_slope(lambda q: (work.field.position(q), work.field.rotation(q))))(q)
    (r, rotation), (first, turn), (bend, twice) = place, slope, second
    terms = work.about(like.shape[0], Places(r, first, bend), rotation, turn, twice)
    return terms.constant, terms.slope
