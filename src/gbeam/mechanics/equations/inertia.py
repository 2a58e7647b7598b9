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
        x, y, z = (part.sum(axis=-1) for part in force)
        return field.along(q, force), (x, y, z), _summed(cross(r, force))


@record
class Sections:
    """Sections of a strain field, rigid bodies on its axis: with C, which gives their places by the field's tangents,
    `pairs` CᵀmC (G, G) kg and `first` Cᵀm (G,) kg; and principal moments of inertia `turning` (3, G) kg m², or None.
    """

    field: StrainField
    mass: Array
    pairs: Array
    first: Array
    turning: Array | None

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Vector, Vector]:
        """Forces, as of particles."""
        tangents = self.field.moving(q, qd, qdd)
        base, rate, change = split(a), split(w), split(alpha)
        relative = _relative(tangents.t, tangents.td, tangents.tdd, w, alpha)
        force = add(mapped(relative, self.pairs), scaled(self.first, base))
        x, y, z = (plus(part @ self.first, self.mass * each[..., 0]) for part, each in zip(relative, base, strict=True))
        about = _summed(cross(tangents.t, force))
        moment = NONE
        if self.turning is not None:
            turn = self._turning(tangents, rate, change)
            about = add(about, _summed(turn))
            moment = mapped(turn, self.field.node_cumulative.T)
        return self.field.pulled(tangents, force, moment), (x, y, z), about

    def _turning(self, tangents: Tangents, w: Vector, alpha: Vector) -> Vector:
        """Moments J α + ω × J ω of the sections at the nodes."""
        inward = tangents.rotation
        rate = turned_back(inward, add(tangents.w, w))
        change = turned_back(inward, add(tangents.alpha, alpha, cross(w, tangents.w)))
        assert self.turning is not None
        momentum: Vector = tuple(map(times, self.turning, rate))
        torque: Vector = tuple(map(times, self.turning, change))
        return turned(inward, add(torque, cross(rate, momentum)))


@record
class Inertia:
    """Particles (p,) kg of a field, quadrature points and bodies; `parts` have the same inertia in fewer sums."""

    field: StrainField | Places
    mass: Array
    parts: tuple[Particles | Sections, ...]

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), and resultant of m a and moment about the root (..., 3), of
        particles on a base with acceleration (or specific force), angular velocity and angular acceleration (..., 3):
        a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈.
        """
        a, w, alpha = (each[..., None, :] for each in (a, w, alpha))
        each = [part.forces(q, qd, qdd, a, w, alpha) for part in self.parts]
        along, total, moment = each[0]
        for more in each[1:]:
            along, total, moment = along + more[0], add(total, more[1]), add(moment, more[2])
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
    x, y, z = (part if isinstance(part, int) else part.sum(axis=-1) for part in vectors)
    return x, y, z


def inertia_of(field: StrainField | Places, mass: Array, line: int = 0, nodes: int = 0) -> Inertia:
    """Inertia of the particles of a field, of which the first, `line`, are the sections at the nodes of the quadrature,
    once or several times over.
    """
    if isinstance(field, Places):
        return Inertia(field, mass, (Particles(field, mass),))
    offset = field.offset
    beside = np.zeros(len(mass), bool)
    if offset is not None:
        beside[line:] = True if is_jax(offset) else np.any(offset[line:], axis=1)
    on_axis = np.flatnonzero(~beside)
    c, held = field.cumulative[on_axis], mass[on_axis]
    turning = None
    if line > nodes and offset is not None:
        squares = (mass[:line, None] * offset[:line] ** 2).reshape(-1, nodes, 3).sum(axis=0)
        principal = squares.sum(axis=1)[:, None] - squares
        turning = namespace(principal).pad(principal.T, ((0, 0), (field.strains.shape[1] - nodes, 0)))
    parts: tuple[Particles | Sections, ...] = (
        Sections(field, held.sum(), c.T @ (held[:, None] * c), c.T @ held, turning),
    )
    if beside.any():
        off_axis = np.flatnonzero(beside)
        parts += (Particles(field[off_axis], mass[off_axis]),)
    return Inertia(field, mass, parts)
