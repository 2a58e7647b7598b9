"""Derivatives by NumPy, without compiling anything: complex steps, exact to rounding, and central differences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = Any
_TINY = 1e-30
_CENTRAL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])  # of eighth order: weights of f(kh) − f(−kh), k = 1 … 4


def along(function: Callable[[Array], Array], x: Array, direction: Array) -> Array:
    """Derivative of an analytic function along a direction, by a complex step."""
    return np.imag(function(x + 1j * _TINY * np.asarray(direction))) / _TINY


def jacobian(function: Callable[[Array], Array], x: Array) -> Array:
    """Derivatives with respect to a vector, the last axis of the result, by complex steps."""
    return np.stack([along(function, x, each) for each in np.eye(len(x))], axis=-1)


def rate(function: Callable[[float], Array], t: float = 0.0, step: float = 0.01) -> Array:
    """Derivative with respect to a number, by differences of eighth order."""
    pairs = [np.asarray(function(t + k * step)) - function(t - k * step) for k in range(1, 5)]
    return sum(weight * pair for weight, pair in zip(_CENTRAL, pairs, strict=True)) / step


def hessian(function: Callable[[Array], Array], x: Array, step: float = 2e-3) -> Array:
    """Second derivatives with respect to a vector: differences of complex steps."""
    x = np.asarray(x, dtype=float)
    columns = [rate(lambda t, e=each: jacobian(function, x + t * e), step=step) for each in np.eye(len(x))]
    return np.stack(columns, axis=-1)
