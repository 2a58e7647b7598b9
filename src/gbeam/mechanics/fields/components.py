"""Vectors and rotations by components, three arrays of one shape: they compile faster than arrays (..., 3).

A component that is zero or one by construction is the integer: products with it cost nothing, and a beam that stays in
a plane needs no larger program than its plane.
"""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

Scalar = Any
Vector = tuple[Scalar, Scalar, Scalar]
Rotation = tuple[Vector, Vector, Vector]  # rows
NONE: Vector = (0, 0, 0)
UNTURNED: Rotation = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def absent(value: Scalar) -> bool:
    """Whether a component is zero by construction."""
    return isinstance(value, int) and value == 0


def times(left: Scalar, right: Scalar) -> Scalar:
    """Product of two components."""
    if absent(left) or absent(right):
        return 0
    if isinstance(left, int) and left == 1:
        return right
    return left if isinstance(right, int) and right == 1 else left * right


def plus(left: Scalar, right: Scalar) -> Scalar:
    """Sum of two components."""
    if absent(left):
        return right
    return left if absent(right) else left + right


def minus(left: Scalar, right: Scalar) -> Scalar:
    """Difference of two components."""
    if absent(right):
        return left
    return -right if absent(left) else left - right


def add(*vectors: Vector) -> Vector:
    """Sum of vectors."""
    x, y, z = (reduce(plus, parts) for parts in zip(*vectors, strict=True))
    return x, y, z


def scaled(factor: Scalar, vector: Vector) -> Vector:
    """Product of a number, or of one at each point, and a vector."""
    x, y, z = (times(factor, part) for part in vector)
    return x, y, z


def dot(left: Vector, right: Vector) -> Scalar:
    """Scalar product."""
    return reduce(plus, (times(a, b) for a, b in zip(left, right, strict=True)))


def cross(w: Vector, r: Vector) -> Vector:
    """w × r."""
    return (
        minus(times(w[1], r[2]), times(w[2], r[1])),
        minus(times(w[2], r[0]), times(w[0], r[2])),
        minus(times(w[0], r[1]), times(w[1], r[0])),
    )


def swept(w: Vector, alpha: Vector, r: Vector) -> Vector:
    """α × r + ω × (ω × r)."""
    return add(cross(alpha, r), cross(w, cross(w, r)))


def turned(rotation: Rotation, vector: Vector) -> Vector:
    """R v."""
    x, y, z = (dot(row, vector) for row in rotation)
    return x, y, z


def turned_back(rotation: Rotation, vector: Vector) -> Vector:
    """Rᵀ v."""
    x, y, z = (dot(column, vector) for column in zip(*rotation, strict=True))
    return x, y, z


def plane_rotation(axis: int, cosine: Scalar, sine: Scalar) -> Rotation:
    """Rotations about one axis."""
    if axis == 0:
        return (1, 0, 0), (0, cosine, -sine), (0, sine, cosine)
    if axis == 1:
        return (cosine, 0, sine), (0, 1, 0), (-sine, 0, cosine)
    return (cosine, -sine, 0), (sine, cosine, 0), (0, 0, 1)


def mapped(vector: Vector, matrix: Any) -> Vector:
    """Product of a matrix (m, k) and the components (..., k), (..., m)."""
    x, y, z = (0 if absent(part) else part @ matrix.T for part in vector)
    return x, y, z


def split(vectors: Any) -> Vector:
    """Components of vectors (..., 3)."""
    return vectors[..., 0], vectors[..., 1], vectors[..., 2]


def joined(xp: Any, parts: tuple[Scalar, ...], shape: tuple[int, ...]) -> Any:
    """Array (*shape, k) of k components, of a shape that they broadcast further."""
    shape = np.broadcast_shapes(shape, *(part.shape for part in parts if not isinstance(part, int | float)))
    return xp.stack([xp.broadcast_to(float(p) if isinstance(p, int) else p, shape) for p in parts], axis=-1)
