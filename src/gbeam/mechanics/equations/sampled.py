"""A complete model's places, forces and stiffness at many times at once, by NumPy: nothing is compiled.

A field computes with complex numbers, so that a step along the imaginary axis differentiates it. Along a path
q + iτ q̇ − ½ τ² q̈ that is the path itself at the imaginary time iτ: r + iτ ṙ − ½ τ² r̈ up to terms of third order.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.equations.inertia import Elasticity, Inertia
from gbeam.mechanics.equations.virtual_work import LoadWork
from gbeam.mechanics.fields.exact import ExactField
from gbeam.mechanics.fields.rotation import Field, Strains
from gbeam.mechanics.fields.taylor import Places

Array = NDArray[np.float64]
STEP = 1e-30
BEND = 1e-2  # rad, of differences of fourth order
TURN = 1e-3  # by which a coordinate moves in the imaginary time τ, as a share of its largest size


def paths(place: Any, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
    """Places, velocities and accelerations (t, p, 3) of points placed by a function of q; q, qd, qdd (t, n)."""
    r = np.asarray(place(q))
    fast = max(np.abs(qd).max(initial=0.0), np.sqrt(np.abs(qdd).max(initial=0.0)))
    if fast == 0:
        return r, np.zeros_like(r), np.zeros_like(r)
    tau = TURN / fast
    moved = np.asarray(place(q - 0.5 * tau**2 * qdd + 1j * tau * qd))
    return r, moved.imag / tau, 2 * (r - moved.real) / tau**2


def pulled_back(function: Any, q: Array, force: Array) -> Array:
    """Σ (∂f/∂q)·force over all that a function of coordinates gives at each time, (t, n)."""
    out = np.empty_like(q)
    flat = force.reshape(len(q), -1)
    for k in range(q.shape[1]):
        moved = q.astype(complex)
        moved[:, k] += 1j * STEP
        out[:, k] = ((np.asarray(function(moved)).imag / STEP).reshape(len(q), -1) * flat).sum(axis=1)
    return out


def along_places(field: Field, q: Array, force: Array) -> Array:
    """Generalised forces (t, n) of forces (t, p, 3) at a field's points."""
    if not isinstance(field, ExactField):
        return pulled_back(field.position, q, force)
    at_nodes = np.matmul(field.cumulative.T, force)
    values = [q @ shapes.T for shapes in field.nodal]
    total = np.zeros_like(q)
    for k, shapes in enumerate(field.nodal):
        moved = [value + (1j * STEP if i == k else 0) for i, value in enumerate(values)]
        slope = np.asarray(field.tangents(*moved)).imag / STEP
        total += (slope * at_nodes).sum(axis=-1) @ shapes
    return total


def inertia_forces(inertia: Inertia, q: Array, force: Array) -> Array:
    """Generalised forces (t, n) of forces (t, k, 3) on the particles."""
    if inertia.offset is None:
        return along_places(inertia.field, q, force)
    total, off = along_places(inertia.field, q, force), inertia.off_axis
    return total + pulled_back(partial(inertia.arms, at=off), q, force[:, off]) if off.size else total


def elastic_forces(elasticity: Elasticity, q: Array, stiffness: Array) -> Array:
    """∂U/∂q at coordinates (t, n)."""
    field = elasticity.field
    if field.linear_strains:
        return q @ stiffness
    inner: Any = getattr(field, "inner", field)  # within a root's springs, whose coordinates come last
    beam, root = np.split(q, [inner.nodal.shape[-1]], axis=1)
    return np.concatenate([_bent(inner, elasticity.rigidity, beam), root * elasticity.rigidity.root], axis=1)


def _bent(field: ExactField, rigidity: Strains, q: Array) -> Array:
    """Elastic forces of an exact field in three dimensions: through the twist, which is an integral."""
    shapes = [*field.nodal[1:], *field.node_slopes]
    values = [q @ each.T for each in shapes]
    bend_y, bend_z, rate = field.bending(*values)
    twist = rate @ field.node_cumulative.T
    c, s = np.cos(twist), np.sin(twist)
    about_y, about_z = c * bend_y + s * bend_z, c * bend_z - s * bend_y
    m_y, m_z = about_y * rigidity.about_y, about_z * rigidity.about_z
    of_rate = (m_y * about_z - m_z * about_y) @ field.node_cumulative
    of_y, of_z = c * m_y - s * m_z, s * m_y + c * m_z
    total = ((q @ field.nodal[0].T) * rigidity.axial) @ field.nodal[0]
    for k, each in enumerate(shapes):
        moved = [value + (1j * STEP if i == k else 0) for i, value in enumerate(values)]
        slopes = [part.imag / STEP for part in field.bending(*moved)]
        total += (slopes[0] * of_y + slopes[1] * of_z + slopes[2] * of_rate) @ each
    return np.asarray(total)


def load_forces(work: LoadWork, q: Array, values: Array) -> tuple[Array, Array, Array]:
    """Forces on the coordinates (t, n) of loads with components (t, loads, 6); their resultants at the root (t, 3)."""
    r, rotation = work.field.position(q), work.field.rotation(q)
    force, moment = work.forces(rotation, values)
    along = along_places(work.field, q, force)
    if np.any(moment):
        turning = 0.5 * np.cross(moment[..., :, None], rotation, axis=-2)
        along = along + pulled_back(work.field.rotation, q, turning)
    return along, force.sum(axis=1), (np.cross(r, force) + moment).sum(axis=1)


def places_about(inertia: Inertia, q: Array) -> tuple[Array, Array, Array]:
    """Places (k, 3) of the particles at q (n,), and their first and second derivatives, (k, 3, n) and (k, 3, n, n)."""
    field = inertia.field
    if not isinstance(field, ExactField):
        return about(inertia.positions, q, _steps(field, len(q)))
    axis = _axis_about(field, q)
    if inertia.offset is None:
        return axis
    off = inertia.off_axis
    for whole, of_arms in zip(axis, about(partial(inertia.arms, at=off), q, _steps(field, len(q))), strict=True):
        whole[off] += of_arms
    return axis


def slopes(place: Any, q: Array) -> Array:
    """Derivatives with respect to q (n,) of points (p, 3), the last axis of the result, to rounding."""
    return np.moveaxis(np.asarray(place(q + 1j * STEP * np.eye(len(q)))).imag / STEP, 0, -1)


def about(place: Any, q: Array, steps: Array) -> tuple[Array, Array, Array]:
    """Points (p, 3) at q (n,) and their first and second derivatives by fourth-order complex steps (i h), of any
    places.
    """
    n, (j, k) = len(q), np.tril_indices(len(q), -1)
    r = np.asarray(place(q))
    ways = steps * np.concatenate([np.eye(n), (np.eye(n)[j] + np.eye(n)[k]) / 2])  # none turns further than one step
    near, far = (2 * (r - np.asarray(place(q + 1j * size * ways)).real) / size**2 for size in (0.5, 1))
    alone, both = np.split((4 * near - far) / 3, [n])
    second = np.empty((n, n, *r.shape))
    second[np.arange(n), np.arange(n)] = alone
    second[j, k] = second[k, j] = 2 * both - (alone[j] + alone[k]) / 2
    second /= np.multiply.outer(steps, steps).reshape(n, n, *[1] * r.ndim)
    return r, slopes(place, q), np.moveaxis(second, (0, 1), (-2, -1))


def _axis_about(field: ExactField, q: Array) -> tuple[Array, Array, Array]:
    """Expand an exact field's points: a tangent depends on its own strain and angles, three numbers."""
    values, unit, n = field.nodal @ q, np.eye(3)[..., None], len(q)

    def slopes(values: Array) -> Array:  # (..., 3, g) -> (..., 3, g, 3)
        moved = values[..., None, :, :] + 1j * STEP * unit
        return np.asarray(field.tangents(*np.moveaxis(moved, -2, 0))).imag / STEP

    far, near = (slopes(values + k * BEND * unit) - slopes(values - k * BEND * unit) for k in (2, 1))
    second = (8 * near - far) / (12 * BEND)  # by two of them, (3, 3, g, 3)
    slope = np.einsum("kga,kgi->gai", slopes(values), field.nodal)
    once = np.einsum("lkga,lgj->kgaj", second, field.nodal)
    twice = np.matmul(np.moveaxis(field.nodal, 0, -1)[:, None], np.moveaxis(once, 0, -2))  # (g, 3, n, n)
    first, second = (field.cumulative @ x.reshape(len(x), -1) for x in (slope, twice))
    return field.cumulative @ field.tangents(*values), first.reshape(-1, 3, n), second.reshape(-1, 3, n, n)


def elastic_about(elasticity: Elasticity, q: Array, stiffness: Array) -> tuple[Array, Array]:
    """Gradient (n,) and second derivatives (n, n) of the strain energy at q (n,)."""

    def gradient(q: Array) -> Array:
        return elastic_forces(elasticity, q, stiffness)

    return gradient(q[None])[0], _differences(gradient, q, _steps(elasticity.field, len(q)))


def loads_about(work: LoadWork, q: Array, loads: int) -> tuple[Array, Array]:
    """Generalised forces of unit components at q, (loads, 6, 6 + n), and their derivatives (loads, 6, 6 + n, n)."""
    field = work.field

    def place(q: Array) -> Array:
        """Places of the loaded points and rotations of their sections, side by side."""
        return np.concatenate([field.position(q)[..., None], field.rotation(q)], axis=-1)

    values, slope, second = about(place, q, _steps(field, len(q)))
    places = Places(values[..., 0], slope[:, :, 0], second[:, :, 0])
    terms = work.about(loads, places, values[..., 1:], slope[:, :, 1:], second[:, :, 1:])
    return terms.constant, terms.slope


def _steps(field: Any, n: int) -> Array:
    """Steps of the coordinates by which no section turns by more than BEND."""
    inner = getattr(field, "inner", field)
    slopes = inner.nodal[1:] if isinstance(inner, ExactField) else inner.node_slopes
    largest = np.abs(slopes).max(axis=(0, 1))
    return BEND / np.concatenate([np.where(largest > 0, largest, 1.0), np.ones(n - len(largest))])


def _differences(function: Any, q: Array, steps: Array) -> Array:
    """Derivative of a function of coordinates (p, n), by differences of fourth order; last axis: the coordinate."""
    moves = np.diag(steps)
    far, near = (function(q + k * moves) - function(q - k * moves) for k in (2, 1))
    slope = (8 * near - far) / 12
    return np.moveaxis(slope / steps.reshape(-1, *[1] * (slope.ndim - 1)), 0, -1)
