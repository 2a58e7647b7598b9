"""Vectors and rotations by components, three arrays of one shape: they compile faster than arrays (..., 3).

A component that is zero or one by construction is the integer: products with it cost nothing, and a beam that stays in
a plane needs no larger program than its plane.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace

Scalar = Any
Vector = tuple[Scalar, Scalar, Scalar]
Rotation = tuple[Vector, Vector, Vector]  # rows
NONE: Vector = (0, 0, 0)
UNTURNED: Rotation = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def absent(value: Scalar) -> bool:
    """True if a component is zero by construction."""
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
    """Product of a factor, one number or one at each point, and a vector."""
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
    """Rotations about one of the axes 0, 1 and 2."""
    if axis == 0:
        return (1, 0, 0), (0, cosine, -sine), (0, sine, cosine)
    if axis == 1:
        return (cosine, 0, sine), (0, 1, 0), (-sine, 0, cosine)
    return (cosine, -sine, 0), (sine, cosine, 0), (0, 0, 1)


def mapped(vector: Vector, matrix: Any) -> Vector:
    """Vector of components (..., m): products of a matrix (m, k) and the components (..., k)."""
    x, y, z = (0 if absent(part) else part @ matrix.T for part in vector)
    return x, y, z


def split(vectors: Any) -> Vector:
    """Components of vectors (..., 3)."""
    return vectors[..., 0], vectors[..., 1], vectors[..., 2]


def joined(xp: Any, parts: tuple[Scalar, ...], shape: tuple[int, ...]) -> Any:
    """Join k components to an array (*shape, k). Components that are larger than `shape` enlarge it."""
    sizes = {shape, *(part.shape for part in parts if not isinstance(part, int | float))}
    shape = np.broadcast_shapes(*sizes) if len(sizes) > 1 else shape
    if xp is not np:
        return xp.stack([xp.broadcast_to(float(p) if isinstance(p, int) else p, shape) for p in parts], axis=-1)
    stacked = np.empty((*shape, len(parts)), dtype=np.result_type(float, *parts))
    for k, part in enumerate(parts):
        stacked[..., k] = part
    return stacked


def rotation_matrix(angle: Array) -> Array:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3)."""
    xp = namespace(angle)
    sinc, versine, _ = exponential_of(xp.sum(angle**2, axis=-1))
    skew_matrix = skew(xp, angle)
    return xp.eye(3) + sinc[..., None, None] * skew_matrix + versine[..., None, None] * (skew_matrix @ skew_matrix)


def skew(xp: Any, w: Array) -> Array:
    """[w]× of vectors (..., 3), (..., 3, 3)."""
    x, y, z = w[..., 0], w[..., 1], w[..., 2]
    o = xp.zeros_like(x)
    return xp.stack([xp.stack([o, -z, y], -1), xp.stack([z, o, -x], -1), xp.stack([-y, x, o], -1)], -2)


def sine_cosine(angle: Array) -> tuple[Array, Array]:
    """Sines and cosines of angles."""
    return _compiled()(angle) if is_jax(angle) else (np.sin(angle), np.cos(angle))


@cache
def _compiled() -> Any:
    """Sine and cosine for XLA, with their derivatives.

    The product with the unit matrix keeps XLA from computing the polynomials again wherever they are used.
    """
    import jax

    import gbeam.arrays.jax_setup  # noqa: F401

    @jax.custom_jvp
    def compiled(angle: Array) -> tuple[Array, Array]:
        sine, cosine = _polynomials(angle)
        if not angle.ndim:
            return sine, cosine
        pair = np.eye(2) @ jax.numpy.stack([sine, cosine], axis=-2)
        return pair[..., 0, :], pair[..., 1, :]

    @compiled.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        sine, cosine = compiled(primals[0])
        return (sine, cosine), (cosine * tangents[0], -sine * tangents[0])

    return compiled


# pi/2 in two parts, the first of 33 bits: its products with whole numbers up to a million are exact (Cody and Waite).
_QUARTER = 1.57079632673412561417e00, 6.07710050650619224932e-11
_SINE = [(2 * k) * (2 * k + 1) for k in range(8, 0, -1)]  # of the last terms: 2e-18 of one at a quarter of pi
_COSINE = [(2 * k - 1) * (2 * k) for k in range(8, 0, -1)]


def _polynomials(angle: Array) -> tuple[Array, Array]:
    """Sines and cosines to 2e-16, up to a million quarter turns: Taylor's polynomials about the nearest one."""
    xp = namespace(angle)
    quarters = xp.round(angle * (2 / np.pi))
    remainder = (angle - quarters * _QUARTER[0]) - quarters * _QUARTER[1]
    sine, cosine = remainder * _series(remainder**2, 1.0, _SINE), _series(remainder**2, 1.0, _COSINE)
    quadrant = quarters - 4 * xp.floor(quarters / 4)
    odd = (quadrant == 1) | (quadrant == 3)
    sine, cosine = xp.where(odd, cosine, sine), xp.where(odd, sine, cosine)
    return xp.where(quadrant >= 2, -sine, sine), xp.where((quadrant == 1) | (quadrant == 2), -cosine, cosine)


_SERIES = 0.1  # of φ²: below, six terms of the series are all digits
_SINC = [(2 * k) * (2 * k + 1) for k in range(6, 0, -1)]
_VERSINE = [(2 * k + 1) * (2 * k + 2) for k in range(6, 0, -1)]


def _series(square: Array, first: float, divisors: list[int]) -> Array:
    """first (1 − φ²/d₁ (1 − φ²/d₂ (…))), the smallest divisor last."""
    total: Any = 1.0
    for divisor in divisors:
        total = 1 - square * (1 / divisor) * total
    return first * total


def exponential_of(square: Array) -> tuple[Array, Array, Array]:
    """The functions sin φ/φ, (1 − cos φ)/φ² and cos φ of φ² = `square`, smooth through zero."""
    xp = namespace(square)
    if xp is np and np.abs(square).max(initial=0.0) < _SERIES:  # a fifth of the time of the functions
        versine = _series(square, 0.5, _VERSINE)
        return _series(square, 1.0, _SINC), versine, 1 - square * versine
    small = xp.abs(square) < 1e-4
    theta = xp.sqrt(xp.where(small, 1.0, square))
    sine, cosine = sine_cosine(theta)
    sinc = xp.where(small, 1 - square / 6 * (1 - square / 20 * (1 - square / 42)), sine / theta)
    versine = xp.where(small, 0.5 - square / 24 * (1 - square / 30 * (1 - square / 56)), (1 - cosine) / theta**2)
    return sinc, versine, 1 - square * versine
