"""The inertia of a complete model: the particles of its field, and what their motions and forces sum to."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.linear import Geometric, geometric_of
from gbeam.mechanics.fields.components import (
    NONE,
    Vector,
    absent,
    add,
    cross,
    joined,
    mapped,
    plus,
    scaled,
    split,
    swept,
    times,
    turned,
    turned_back,
)
from gbeam.mechanics.fields.strains import StrainField, Tangents
from gbeam.mechanics.fields.taylor import Places

Array = Any


@record
class Particles:
    """Particles (p,) kg of a field."""

    field: StrainField | Places
    mass: Array

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Vector, Vector]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), and resultant and moment about the root, by components, on
        a base with components (..., 1).
        """
        field: Any = self.field
        r, rd, rdd = field.components(q, qd, qdd)
        force = scaled(self.mass, add(_relative(r, rd, rdd, w, alpha), split(a)))
        return field.along(q, force), _summed(force), _summed(cross(r, force))


@record
class Bodies:
    """Rigid sections on the axis of a strain field, and particles beside it, the field's points (p,) kg.

    The places of sections are constant sums C t of the field's tangents: `pairs` CᵀmC (G, G) and `first` Cᵀm (G,), kg,
    have their `mass`. `turning` (3, G) kg m² are principal moments of inertia of the sections, or None.
    """

    field: StrainField
    beside: Array
    mass: Array
    pairs: Array
    first: Array
    turning: Array | None

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Vector, Vector]:
        """Forces, resultant and moment, as of particles."""
        tangents = self.field.moving(q, qd, qdd)
        base = split(a)
        relative = _relative(tangents.t, tangents.td, tangents.tdd, w, alpha)
        force, moment = add(mapped(relative, self.pairs), scaled(self.first, base)), NONE
        x, y, z = (plus(part @ self.first, self.mass * each[..., 0]) for part, each in zip(relative, base, strict=True))
        total: Vector = (x, y, z)
        about = _summed(cross(tangents.t, force))
        if self.turning is not None:
            turn = self._turning(tangents, split(w), split(alpha))
            moment, about = mapped(turn, self.field.node_cumulative.T), add(about, _summed(turn))
        if len(self.beside):
            r, rd, rdd = self.field.carried(tangents)
            push = scaled(self.beside, add(_relative(r, rd, rdd, w, alpha), base))
            along, bent = self.field.at_nodes(tangents, push)
            force, moment = add(force, along), add(moment, bent)
            total, about = add(total, _summed(push)), add(about, _summed(cross(r, push)))
        return self.field.pulled(tangents, force, moment), total, about

    def _turning(self, tangents: Tangents, w: Vector, alpha: Vector) -> Vector:
        """Moments J α + ω × J ω of the sections at the nodes."""
        inward = tangents.rotation
        rate = turned_back(inward, add(tangents.w, w))
        change = turned_back(inward, add(tangents.alpha, alpha, cross(w, tangents.w)))
        momentum, torque = self._about_axes(rate), self._about_axes(change)
        return turned(inward, add(torque, cross(rate, momentum)))

    def _about_axes(self, vector: Vector) -> Vector:
        x, y, z = (times(moment, part) for moment, part in zip(self.turning, vector, strict=True))  # type: ignore[arg-type]
        return x, y, z


@record
class Inertia:
    """Particles (p,) kg of a field, quadrature points and bodies; `same` have the same inertia in fewer sums."""

    field: StrainField | Places
    mass: Array
    same: Particles | Bodies

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), and resultant of m a and moment about the root (..., 3), of
        particles on a base with acceleration (or specific force), angular velocity and angular acceleration (..., 3):
        a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈.
        """
        along, total, moment = self.same.forces(q, qd, qdd, *(each[..., None, :] for each in (a, w, alpha)))
        xp, shape = namespace(self.mass, q, a), along.shape[:-1]
        return along, joined(xp, total, shape), joined(xp, moment, shape)

    def about(self, q: Array) -> tuple[Places, Geometric | None]:
        """Places of the particles about coordinates (n,), and their geometric stiffness unless they have second
        derivatives.
        """
        if isinstance(self.field, Places):
            return Places(self.field.positions(q), self.field.slopes(q), self.field.second), None
        places, bent = self.field.about(q, self.mass)
        return places, geometric_of(bent[0], bent[1:])


def _relative(r: Vector, rd: Vector, rdd: Vector, w: Array, alpha: Array) -> Vector:
    """α × r + ω × (ω × r) + 2 ω × ṙ + r̈."""
    rate, change = split(w), split(alpha)
    return add(swept(rate, change, r), scaled(2.0, cross(rate, rd)), rdd)


def _summed(vectors: Vector) -> Vector:
    x, y, z = (0 if absent(part) else part.sum(axis=-1) for part in vectors)
    return x, y, z


def inertia_of(field: StrainField | Places, mass: Array, line: int = 0, nodes: int = 0) -> Inertia:
    """Inertia of the particles of a field, of which the first, `line`, are the sections at the nodes of the quadrature,
    once or several times over.
    """
    if isinstance(field, Places):
        return Inertia(field, mass, Particles(field, mass))
    offset = field.offset
    beside = np.zeros(len(mass), bool)
    if offset is not None:
        beside[line:] = True if is_jax(offset) else np.any(offset[line:], axis=1)
    on_axis, off_axis = np.flatnonzero(~beside), np.flatnonzero(beside)
    c, held = field.cumulative[on_axis], mass[on_axis]
    turning = None
    if line > nodes and offset is not None:
        squares = (mass[:line, None] * offset[:line] ** 2).reshape(-1, nodes, 3).sum(axis=0)
        principal = squares.sum(axis=1)[:, None] - squares
        turning = namespace(principal).pad(principal.T, ((0, 0), (field.strains.shape[1] - nodes, 0)))
    points = field[off_axis] if len(off_axis) else field.points(off_axis)
    pairs, first = c.T @ (held[:, None] * c), c.T @ held
    return Inertia(field, mass, Bodies(points, mass[off_axis], held.sum(), pairs, first, turning))
