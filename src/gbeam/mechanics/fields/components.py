"""Vectors and rotations by components, three arrays of one shape: they compile faster than arrays (..., 3).

A component that is zero or one by construction is the integer: products with it cost nothing, and a beam that stays in
a plane needs no larger program than its plane.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Scalar = Any
Vector = tuple[Scalar, Scalar, Scalar]
Rotation = tuple[Vector, Vector, Vector]  # rows
NONE: Vector = (0, 0, 0)
UNTURNED: Rotation = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def absent(value: Scalar) -> bool:
    """Whether a component is zero by construction."""
    return type(value) is int and value == 0


def times(left: Scalar, right: Scalar) -> Scalar:
    """Product of two components."""
    if type(left) is int:
        return right if left else 0
    if type(right) is int:
        return left if right else 0
    return left * right


def plus(left: Scalar, right: Scalar) -> Scalar:
    """Sum of two components."""
    if type(left) is int and left == 0:
        return right
    return left if type(right) is int and right == 0 else left + right


def minus(left: Scalar, right: Scalar) -> Scalar:
    """Difference of two components."""
    if type(right) is int and right == 0:
        return left
    return -right if type(left) is int and left == 0 else left - right


def add(*vectors: Vector) -> Vector:
    """Sum of vectors."""
    x, y, z = vectors[0]
    for u, v, w in vectors[1:]:
        x, y, z = plus(x, u), plus(y, v), plus(z, w)
    return x, y, z


def scaled(factor: Scalar, vector: Vector) -> Vector:
    """Product of a number, or of one at each point, and a vector."""
    x, y, z = vector
    return times(factor, x), times(factor, y), times(factor, z)


def dot(left: Vector, right: Vector) -> Scalar:
    """Scalar product."""
    (a, b, c), (x, y, z) = left, right
    return plus(plus(times(a, x), times(b, y)), times(c, z))


def cross(w: Vector, r: Vector) -> Vector:
    """w × r."""
    (a, b, c), (x, y, z) = w, r
    return (
        minus(times(b, z), times(c, y)),
        minus(times(c, x), times(a, z)),
        minus(times(a, y), times(b, x)),
    )


def swept(w: Vector, alpha: Vector, r: Vector) -> Vector:
    """α × r + ω × (ω × r)."""
    return add(cross(alpha, r), cross(w, cross(w, r)))


def turned(rotation: Rotation, vector: Vector) -> Vector:
    """R v."""
    x, y, z = rotation
    return dot(x, vector), dot(y, vector), dot(z, vector)


def turned_back(rotation: Rotation, vector: Vector) -> Vector:
    """Rᵀ v."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    return dot((a, d, g), vector), dot((b, e, h), vector), dot((c, f, i), vector)


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
    sizes = {shape, *(part.shape for part in parts if not isinstance(part, int | float))}
    shape = np.broadcast_shapes(*sizes) if len(sizes) > 1 else shape
    if xp is not np:
        return xp.stack([xp.broadcast_to(float(p) if isinstance(p, int) else p, shape) for p in parts], axis=-1)
    out = np.empty((*shape, len(parts)), dtype=np.result_type(float, *parts))
    for k, part in enumerate(parts):
        out[..., k] = part
    return out
