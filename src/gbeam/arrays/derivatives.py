"""Derivatives by JAX of what is read itself as well."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax

import gbeam.arrays.jax_setup  # noqa: F401

Array = Any


def with_slope(function: Callable[[Array], Any]) -> Callable[[Array], tuple[Any, Any]]:
    """A function's values and their derivatives with respect to its vector: traced, and compiled, once for both."""

    def twice(x: Array) -> tuple[Any, Any]:
        values = function(x)
        return values, values

    def both(x: Array) -> tuple[Any, Any]:
        slope, values = jax.jacfwd(twice, has_aux=True)(x)
        return values, slope

    return both


def linear_root(function: Callable[[Array], Array], right: Array) -> Array:
    """x of g(x) = y of a linear function g: what :func:`jax.lax.custom_root` differentiates a solution by."""
    return jax.numpy.linalg.solve(jax.jacfwd(function)(right), right)
