"""The Hann kernel of unit width and its integrals: what rounds every corner in this folder."""

from __future__ import annotations

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

import gbeam.arrays.jax_setup  # noqa: F401

TURN = 2 * jnp.pi


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def hann(order: int, x: Float[Array, "*t"]) -> Float[Array, "*t"]:
    """Return the `order`-th derivative of the rounded ramp of unit width at `x`.

    The rounded ramp is max(x, 0) convolved with the Hann kernel k(x) = 1 + cos 2πx on abs(x) < 1/2, whose
    integral is one: zero below −1/2, x above 1/2, three times continuously differentiable. Order 1 is the
    rounded step x + 1/2 + sin(2πx)/2π, order 2 the kernel itself, order 3 its continuous derivative.

    Parameters
    ----------
    order : int
        0 or more; derivatives by `jax.jvp` raise it by one, so they are exact and free of ties at ±1/2.
    x : array, any shape
        Dimensionless: time over the width.

    Returns
    -------
    array, shape of `x`
    """
    u = jnp.clip(x, -0.5, 0.5)
    if order == 0:
        return (u + 0.5) ** 2 / 2 - (1 + jnp.cos(TURN * u)) / TURN**2 + jnp.maximum(x - 0.5, 0.0)
    if order == 1:
        return u + 0.5 + jnp.sin(TURN * u) / TURN
    if order == 2:
        return 1 + jnp.cos(TURN * u)
    wave = (jnp.cos, jnp.sin)[order % 2](TURN * u)
    sign = 1.0 if order % 4 in (1, 2) else -1.0
    return jnp.where(jnp.abs(x) < 0.5, sign * TURN ** (order - 2) * wave, 0.0)


@hann.defjvp
def _hann_jvp(order, primals, tangents):  # type: ignore[no-untyped-def]
    (x,), (dx,) = primals, tangents
    return hann(order, x), hann(order + 1, x) * dx


@jax.jit
def soft_floor(value: Float[Array, "*t"], floor: Array | float, band: Array | float) -> Float[Array, "*t"]:
    """Return a three times differentiable max(value, floor).

    Parameters
    ----------
    value : array, any shape
    floor, band : float
        In the unit of `value`: the result is `floor` below floor − band/2 and `value` above floor + band/2.
    """
    return floor + band * hann(0, (value - floor) / band)
