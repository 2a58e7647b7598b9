"""Elementary motions, of which joints are chains: slides, rotations by a vector, and balls.

A step gives the motion of a frame relative to the frame before it, by its coordinates (..., k) and their rates, and the
forces on these coordinates that do the work of a wrench.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from gbeam.arrays.namespace import Array, as_array, concatenated, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.fields.products import cross, turned_back
from gbeam.mechanics.fields.taylor import EPSILON
from gbeam.mechanics.tree.frames import Relative, Wrench, product

SMALL = 0.05  # rad²: below it functions of an angle's square are their Taylor series, to rounding


class Step(Protocol):
    """One elementary motion."""

    @property
    def size(self) -> int:
        """Number of coordinates."""
        ...

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        """Return the motion of the frame behind the step, by coordinates and rates (..., k)."""
        ...

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        """Return the forces (..., k) on the coordinates that do the work of a wrench on the frame behind the step."""
        ...

    def spring_values(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Return the values (..., h) on which springs and stops act, and the rates on which dampers and friction do."""
        ...

    def coordinate_forces(self, q: Array, by_values: Array, by_rates: Array) -> Array:
        """Return the forces (..., k) on the coordinates that do the work of forces (..., h) on values and rates."""
        ...

    def minimal_form(self, q: Array, qd: Array, qdd: Array) -> tuple[Step, Array, Array, Array]:
        """Return the same motion with as many coordinates as degrees of freedom, and these with their two rates."""
        ...


class Minimal:
    """A motion with as many coordinates as degrees of freedom: springs and dampers act on these themselves."""

    def spring_values(self, q: Array, qd: Array) -> tuple[Array, Array]:
        return q, qd

    def coordinate_forces(self, q: Array, by_values: Array, by_rates: Array) -> Array:
        return by_values + by_rates

    def minimal_form(self, q: Array, qd: Array, qdd: Array) -> tuple[Any, Array, Array, Array]:
        return self, q, qd, qdd


@record
class Slide(Minimal):
    """Displacements along the columns of `axes` (3, k)."""

    axes: Array

    @property
    def size(self) -> int:
        return int(self.axes.shape[1])

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        return Relative(*(values @ self.axes.T for values in (q, qd, qdd)))

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        return wrench.force @ self.axes


@record
class Rotation(Minimal):
    """Rotation by the vector Σ q_i u_i, with u_i the columns of `axes` (3, k), after a constant rotation R0 (3, 3).

    R0 is None about one axis where nothing depends on how far it has turned.
    """

    axes: Array
    R0: Array | None

    @property
    def size(self) -> int:
        return int(self.axes.shape[1])

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        if self.size == 1:
            R = None if self.R0 is None else self._rotation_matrix(q)
            return Relative(None, None, None, R, qd @ self.axes.T, qdd @ self.axes.T)
        R, w, alpha = rotation_by_vector(*(values @ self.axes.T for values in (q, qd, qdd)), plane=False)
        return Relative(None, None, None, product(self.R0, R), w, alpha)

    def _rotation_matrix(self, q: Array) -> Array:
        """Rotation matrices R0 (1 + sin θ [u]× + (1 − cos θ) [u]×²) (..., 3, 3) by angles q (..., 1) about one axis."""
        xp, axis = namespace(q, self.axes, self.R0), self.axes[:, 0]
        size = xp.sqrt(axis @ axis)
        once = self.R0 @ (EPSILON.reshape(9, 3) @ (-axis / size)).reshape(3, 3)
        twice = once @ (EPSILON.reshape(9, 3) @ (-axis / size)).reshape(3, 3)
        angle = size * q
        functions = concatenated([xp.sin(angle), 2 * xp.sin(angle / 2) ** 2])
        turns = functions @ xp.stack([once.reshape(9), twice.reshape(9)])
        return self.R0 + turns.reshape(*q.shape[:-1], 3, 3)

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        if self.size == 1:
            return wrench.moment @ self.axes
        phi = q @ self.axes.T
        return component_moments(phi, wrench.moment) @ self.axes


@record
class Ball:
    """Any rotation by Euler parameters (e0, e1, e2, e3), of which the size does not matter.

    The first of their four equations keeps the size at one, e·ë + ė·ė + 2 e·ė + (e·e − 1)/2 = 0. The others are those
    of moments about the turned axes. Springs and stops act on the rotation vector, of half a turn at most, dampers and
    friction on the angular velocity.
    """

    @property
    def size(self) -> int:
        return 4

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        """Return the rotation of the body and its rates, by Euler parameters, which need not have unit length."""
        xp = namespace(q)
        size = xp.sqrt((q * q).sum(axis=-1, keepdims=True))
        n = q / size
        growth = (n * qd).sum(axis=-1, keepdims=True) / size
        rate = 2 / size * _half_angular_velocity(n, qd)
        change = 2 / size * _half_angular_velocity(n, qdd) - 2 * growth * rate
        return Relative(None, None, None, rotation_by_parameters(n), rate, change)

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        unit_size = (q * qdd + qd * qd + 2 * q * qd + q * q / 2).sum(axis=-1, keepdims=True) - 0.5
        return concatenated([unit_size, wrench.moment])

    def spring_values(self, q: Array, qd: Array) -> tuple[Array, Array]:
        size = namespace(q).sqrt((q * q).sum(axis=-1, keepdims=True))
        return rotation_vector(q / size), 2 / size * _half_angular_velocity(q / size, qd)

    def coordinate_forces(self, q: Array, by_values: Array, by_rates: Array) -> Array:
        size = namespace(q).sqrt((q * q).sum(axis=-1, keepdims=True))
        return concatenated([0 * size, body_moment(rotation_vector(q / size), by_values) + by_rates])

    def minimal_form(self, q: Array, qd: Array, qdd: Array) -> tuple[Step, Array, Array, Array]:
        relative = self.motion(q, qd, qdd)
        step = Turning(q / np.sqrt(q @ q), relative.w, relative.alpha)
        return step, np.zeros(3), relative.w, relative.alpha


@record
class Turning:
    """Rotation by a vector φ (..., 3) after a ball's unit Euler parameters, `initial_parameters` (4,).

    Its axes turn on at the angular velocity `spin` (3,) rad/s and the acceleration `spin_acceleration` (3,) rad/s². Its
    rates are φ̇ + spin, those of the body where φ is zero: departures from a steady spin are departures in the body's
    axes. Its rows are moments about the turned axes, so that a drive turns on with the body. Its springs act on the
    whole rotation, as the ball's do.
    """

    initial_parameters: Array
    spin: Array
    spin_acceleration: Array

    @property
    def size(self) -> int:
        return 3

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        R, w, alpha = rotation_by_vector(q, qd - self.spin, qdd - self.spin_acceleration, plane=False)
        spin, spin_rate = (turned_back(R, vector + 0 * q) for vector in (self.spin, self.spin_acceleration))
        R = product(rotation_by_parameters(self.initial_parameters), R)
        return Relative(None, None, None, R, w + spin, alpha + spin_rate + cross(spin, w))

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        return wrench.moment

    def spring_values(self, q: Array, qd: Array) -> tuple[Array, Array]:
        return self._total_rotation(q), self.motion(q, qd, 0 * qd).w

    def coordinate_forces(self, q: Array, by_values: Array, by_rates: Array) -> Array:
        return body_moment(self._total_rotation(q), by_values) + by_rates

    def minimal_form(self, q: Array, qd: Array, qdd: Array) -> tuple[Step, Array, Array, Array]:
        return self, q, qd, qdd

    def _total_rotation(self, q: Array) -> Array:
        """Rotation vectors (..., 3) of the initial Euler parameters followed by rotations by the vectors q."""
        return rotation_vector(composed_parameters(self.initial_parameters, parameters_of_vector(q)))


@record
class Placed(Minimal):
    """A constant place r (3,) m and rotation R (3, 3) or None, without coordinates."""

    r: Array
    R: Array | None

    @property
    def size(self) -> int:
        return 0

    def motion(self, q: Array, qd: Array, qdd: Array) -> Relative:
        shape = q.shape[:-1]
        xp = namespace(q, self.r)
        return Relative(xp.broadcast_to(self.r, (*shape, 3)), None, None, self.R)

    def rows(self, q: Array, qd: Array, qdd: Array, wrench: Wrench) -> Array:
        return q


def _half_angular_velocity(n: Array, rate: Array) -> Array:
    """G(n) ė: half the angular velocity, turned axes, of unit Euler parameters whose rate is ė."""
    scalar, vector = n[..., :1], n[..., 1:]
    return scalar * rate[..., 1:] - vector * rate[..., :1] - cross(vector, rate[..., 1:])


def composed_parameters(first: Array, second: Array) -> Array:
    """Euler parameters (..., 4) of the `first` rotation, followed by the `second` about the turned axes."""
    s, v, t, u = first[..., :1], first[..., 1:], second[..., :1], second[..., 1:]
    return concatenated([s * t - (v * u).sum(axis=-1, keepdims=True), s * u + t * v + cross(v, u)])


def parameters_of_vector(phi: Array) -> Array:
    """Unit Euler parameters (..., 4) of rotation vectors (..., 3), rad."""
    quarter = (phi * phi).sum(axis=-1, keepdims=True) / 4
    a, b = functions_of_angle(quarter, plane=True)
    return concatenated([1 - quarter * b, a * phi / 2])


def parameter_rates(e: Array, w: Array) -> Array:
    """Rates (..., 4) of Euler parameters that turn at w (..., 3) rad/s, turned axes."""
    return composed_parameters(e, concatenated([0 * w[..., :1], w / 2]))


def turn_steadily(state: Array, time: Any) -> Array:
    """Euler parameters and their two derivatives (3, 4) after a time, s, at constant angular velocity in body axes."""
    w = 2 * composed_parameters(state[0] * np.array([1.0, -1.0, -1.0, -1.0]), state[1])[1:]
    return composed_parameters(state, parameters_of_vector(w * time))


def rotation_by_parameters(n: Array) -> Array:
    """Rotation matrices (..., 3, 3) of unit Euler parameters (..., 4)."""
    xp = namespace(n)
    s, x, y, z = (n[..., i] for i in range(4))
    rows = [
        xp.stack([1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)], axis=-1),
        xp.stack([2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)], axis=-1),
        xp.stack([2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)], axis=-1),
    ]
    return xp.stack(rows, axis=-2)


def _products_of_parameters() -> Array:
    """Matrix (9, 16) that maps the elements of a rotation matrix to 4 e_j e_k − δ_jk of its Euler parameters e."""
    (a, b, c), (d, e, f), (g, h, i) = np.eye(9).reshape(3, 3, 9)
    rows = [
        (a + e + i, h - f, c - g, d - b),
        (h - f, a - e - i, b + d, c + g),
        (c - g, b + d, e - a - i, f + h),
        (d - b, c + g, f + h, i - a - e),
    ]
    return np.array(rows).reshape(16, 9).T


_PRODUCTS = _products_of_parameters()


def parameters_of_matrices(R: Array) -> Array:
    """Unit Euler parameters (t, 4) of rotation matrices (t, 3, 3), without jumps of sign from one to the next."""
    xp = namespace(R)
    products = np.eye(4) + (R.reshape(*R.shape[:-2], 9) @ _PRODUCTS).reshape(*R.shape[:-2], 4, 4)
    # Row j of 4 e_j e_k is 4 e_j times e: it is safe to divide by the largest e_j.
    largest = xp.diagonal(products, axis1=-2, axis2=-1).argmax(axis=-1)[..., None, None]
    row = xp.take_along_axis(products, largest, axis=-2)[..., 0, :]
    unit = row / xp.sqrt((row * row).sum(axis=-1, keepdims=True))
    return remove_sign_jumps(xp.where(unit[:1, :1] >= 0, unit, -unit))


def rotation_vector(e: Array) -> Array:
    """Rotation vectors (..., 3), rad, of half a turn at most, of unit Euler parameters (..., 4)."""
    xp = namespace(e)
    e = xp.where(e[..., :1] < 0, -e, e)
    tangent = e[..., 1:] / (1 + e[..., :1])  # along the axis, tan θ/4 long
    s = (tangent * tangent).sum(axis=-1, keepdims=True)
    small = s < SMALL**4
    size = xp.sqrt(xp.where(small, 1.0, s))
    # θ = 4 arctan(size), by its Taylor series where the size is small.
    return 4 * tangent * xp.where(small, 1 - s / 3 * (1 - 3 * s / 5), xp.arctan(size) / size)


def remove_sign_jumps(e: Array) -> Array:
    """Return Euler parameters (t, ..., 4) without jumps of sign."""
    xp = namespace(e)
    turn = xp.where((e[1:] * e[:-1]).sum(axis=-1) < 0, -1.0, 1.0)
    return e * xp.cumprod(xp.concatenate([xp.ones_like(turn[:1]), turn]), axis=0)[..., None] if len(e) > 1 else e


def functions_of_angle(s: Array, *, plane: bool = False) -> tuple[Array, ...]:
    """Functions a = sin θ/θ and b = (1 − cos θ)/θ² of s = θ², by their Taylor series where s is small.

    Unless in a `plane` also c = (θ − sin θ)/θ³ and the derivatives of b and c with respect to s.
    """
    xp = namespace(s)
    small = s < SMALL
    safe = xp.where(small, 1.0, s)
    angle = xp.sqrt(safe)
    a, b = xp.sin(angle) / angle, (1 - xp.cos(angle)) / safe
    a_series = 1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110))))
    b_series = 0.5 - s / 24 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90 * (1 - s / 132))))
    if plane:
        return xp.where(small, a_series, a), xp.where(small, b_series, b)
    c = (1 - a) / safe
    c_series = (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110 * (1 - s / 156))))) / 6
    db_series = -1 / 24 * (1 - s / 15 * (1 - 3 * s / 112 * (1 - 2 * s / 135 * (1 - 5 * s / 528))))
    dc_series = -1 / 120 * (1 - s / 21 * (1 - s / 48 * (1 - 2 * s / 165 * (1 - 5 * s / 624))))
    db, dc = (a - 2 * b) / (2 * safe), (b - 3 * c) / (2 * safe)
    pairs = (a_series, a), (b_series, b), (c_series, c), (db_series, db), (dc_series, dc)
    return tuple(xp.where(small, series, closed) for series, closed in pairs)


def rotation_by_vector(phi: Array, rate: Array, change: Array, *, plane: bool) -> tuple[Array, Array, Array]:
    """Rotation R = exp [φ]× (..., 3, 3), and angular velocity and acceleration in turned axes, of rotation vectors φ.

    They are T φ̇ and T φ̈ + Ṫ φ̇ with T = 1 − b [φ]× + c [φ]×². In a `plane`, where φ keeps its direction, T is one.
    """
    xp = namespace(phi)
    s = (phi * phi).sum(axis=-1)
    a, b, *spatial = (values[..., None] for values in functions_of_angle(s, plane=plane))
    x, y, z = (phi[..., i] for i in range(3))
    zero = xp.zeros_like(x)
    skew = xp.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*phi.shape, 3)
    square = phi[..., :, None] * phi[..., None, :] - s[..., None, None] * xp.eye(3)
    R = xp.eye(3) + a[..., None] * skew + b[..., None] * square
    if plane:
        return R, rate, change
    c, db, dc = spatial
    cross_rate, twice_crossed = cross(phi, rate), cross(phi, cross(phi, rate))
    growth = 2 * (phi * rate).sum(axis=-1, keepdims=True)  # of s
    w = rate - b * cross_rate + c * twice_crossed
    angular_rate_change = -growth * db * cross_rate + growth * dc * twice_crossed + c * cross(rate, cross_rate)
    alpha = change - b * cross(phi, change) + c * cross(phi, cross(phi, change)) + angular_rate_change
    return R, w, alpha


def component_moments(phi: Array, moment: Array) -> Array:
    """Tᵀ M, the moments on a rotation vector's components φ that do the work of a moment M (..., 3), turned axes."""
    _, b, c, *_ = (function[..., None] for function in functions_of_angle((phi * phi).sum(axis=-1)))
    crossed = cross(phi, moment)
    return moment + b * crossed + c * cross(phi, crossed)


def body_moment(phi: Array, forces: Array) -> Array:
    """Moment (..., 3) in turned axes, T⁻ᵀ f, that does the work of forces f on the components of φ."""
    s = (phi * phi).sum(axis=-1, keepdims=True)
    xp, small = namespace(phi), s < SMALL
    safe = xp.where(small, 1.0, s)
    a, b = functions_of_angle(safe, plane=True)
    series = (1 + s / 60 * (1 + s / 42 * (1 + s / 40 * (1 + 5 * s / 198)))) / 12
    phi_f = cross(phi, forces)
    return forces - phi_f / 2 + xp.where(small, series, (1 - a / (2 * b)) / safe) * cross(phi, phi_f)


def rotation_matrix(v: Any) -> Array:
    """Rotation matrix (3, 3) of a rotation vector (3,), rad."""
    zero = np.zeros(3)
    return rotation_by_vector(as_array(v), zero, zero, plane=True)[0]
