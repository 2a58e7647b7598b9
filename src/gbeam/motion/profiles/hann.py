"""The Hann kernel of unit width and its integrals: what rounds every corner in this folder."""

from __future__ import annotations

from functools import cache, partial
from math import pi
from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_jax
from gbeam.numerics.series import Series, compose, where

TURN = 2 * pi


def hann(order: int, x: Any) -> Any:
    """Return the `order`-th derivative of the rounded ramp of unit width at `x`.

    The rounded ramp is max(x, 0) convolved with the Hann kernel k(x) = 1 + cos 2πx on abs(x) < 1/2, whose integral is
    one: zero below −1/2, x above 1/2, three times continuously differentiable. Order 1 is the rounded step x + 1/2 +
    sin(2πx)/2π, order 2 the kernel itself, order 3 its continuous derivative.
    """
    x = as_array(x)
    return _differentiable()(order, x) if is_jax(x) else hann_orders(order, order, x)[0]


def hann_orders(first: int, last: int, x: Any) -> list[Any]:
    """The derivatives of orders `first` to `last` at `x`, which share their sine and cosine."""
    if is_jax(x):
        return [hann(order, x) for order in range(first, last + 1)]  # its compiler shares them
    return _orders(np, first, last, x)


def _orders(xp: Any, first: int, last: int, x: Any) -> list[Any]:
    u = xp.clip(x, -0.5, 0.5)
    orders = range(first, last + 1)
    # Orders 0 and 2 need no sine, order 1 no cosine.
    sine = xp.sin(TURN * u) if 1 in orders or last > 2 else 0.0
    cosine = xp.cos(TURN * u) if (first, last) != (1, 1) else 0.0
    inside = xp.abs(x) < 0.5 if last > 2 else True
    values = []
    for order in orders:
        match order:
            case 0:
                value = (u + 0.5) ** 2 / 2 - (1 + cosine) / TURN**2 + xp.maximum(x - 0.5, 0.0)
            case 1:
                value = u + 0.5 + sine / TURN
            case 2:
                value = 1 + cosine
            case _:
                sign = 1.0 if order % 4 in (1, 2) else -1.0
                value = xp.where(inside, sign * TURN ** (order - 2) * (cosine, sine)[order % 2], 0.0)
        values.append(value)
    return values


@cache
def _differentiable() -> Any:
    """`hann` for JAX: the derivative of one order is the next."""
    import jax
    import jax.numpy as jnp

    import gbeam.arrays.jax_setup  # noqa: F401

    @partial(jax.custom_jvp, nondiff_argnums=(0,))
    def ramp(order: int, x: Any) -> Any:
        return _orders(jnp, order, order, x)[0]

    @ramp.defjvp
    def _(order: int, primals: Any, tangents: Any) -> Any:
        (x,), (dx,) = primals, tangents
        return ramp(order, x), ramp(order + 1, x) * dx

    return ramp


def soft_floor(value: Any, floor: Any, band: Any) -> Any:
    """Return a three times differentiable max(value, floor)."""
    x = (value - floor) / band
    ramp = compose(hann_orders(0, x.order, x.value), x) if isinstance(x, Series) else hann(0, x)
    return ramp * band + floor


def soft_step(value: Series, middle: Any, band: Any) -> Series:
    """Return a twice differentiable step from 0 to 1."""
    x = (value - middle) / band
    # Beyond half a unit the integral of the kernel no longer rises; its rounding there is no step.
    return where(x.value <= -0.5, 0.0, where(x.value >= 0.5, 1.0, compose(hann_orders(1, 1 + x.order, x.value), x)))
