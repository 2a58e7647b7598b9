"""Products of arrays of vectors (..., 3) and of matrices."""

from __future__ import annotations

import math

import numpy as np

from gbeam.arrays.namespace import Array

_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])  # component after each, and the one before


def cross(left: Array, right: Array) -> Array:
    """Vector product of vectors (..., 3)."""
    return left.take(_NEXT, -1) * right.take(_LAST, -1) - left.take(_LAST, -1) * right.take(_NEXT, -1)


def turned(R: Array, v: Array) -> Array:
    """R v of matrices (..., 3, 3) and vectors (..., 3)."""
    return v @ R.T if R.ndim == 2 else (R @ v[..., None])[..., 0]


def turned_back(R: Array, v: Array) -> Array:
    """Rᵀ v."""
    return v @ R if R.ndim == 2 else (v[..., None, :] @ R)[..., 0, :]


def times(tensor: Array, q: Array) -> Array:
    """T_{...ij} q_j of a constant tensor, (..., its first axes, i)."""
    products = q @ tensor.reshape(math.prod(tensor.shape[:-1]), tensor.shape[-1]).T  # -1 would fail without coordinates
    return products.reshape(*q.shape[:-1], *tensor.shape[:-1])


def quadratic(tensor: Array, q: Array) -> Array:
    """Halves of quadratic forms, ½ q T_k q (..., k), of a constant tensor (k, n, n)."""
    return (times(tensor, q) @ q[..., None])[..., 0] / 2
