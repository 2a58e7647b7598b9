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
NOTHING = 1e-13  # of the moments of inertia: a smaller product is rounding


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
    have their `mass`. `turning` kg m² are the sections' moments of inertia about the axis, the principal ones (3, G) or
    those and the products xy, yz, zx (6, G), or None; `aside` (3, G) kg m their first moments, or None.
    """

    field: StrainField
    beside: Array
    mass: Array
    pairs: Array
    first: Array
    turning: Array | None
    aside: Array | None = None

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
            if self.aside is not None:
                push, lever = self._aside(tangents, relative, base, split(w), split(alpha))
                force, turn = add(force, mapped(push, self.field.node_cumulative.T)), add(turn, lever)
                place = mapped(tangents.t, self.field.node_cumulative)
                total, about = add(total, _summed(push)), add(about, _summed(cross(place, push)))
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
        x, y, z, *products = self.turning  # type: ignore[misc]
        if not products:
            return times(x, vector[0]), times(y, vector[1]), times(z, vector[2])
        xy, yz, zx = products
        rows = (x, xy, zx), (xy, y, yz), (zx, yz, z)
        return turned(rows, vector)

    def _aside(
        self, tangents: Tangents, relative: Vector, base: Vector, w: Vector, alpha: Vector
    ) -> tuple[Vector, Vector]:
        """Forces of the sections' mass beside the axis, and moments about it of the whole, that the nodes' motion asks
        for.
        """
        assert self.aside is not None
        x, y, z = self.aside
        arm = turned(tangents.rotation, (x, y, z))
        change = add(tangents.alpha, alpha, cross(w, tangents.w))
        axis = add(mapped(relative, self.field.node_cumulative), base)
        return swept(add(tangents.w, w), change, arm), cross(arm, axis)


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
    turning, aside = None, None
    if offset is not None and (line > nodes or not is_jax(offset)) and line:
        turning, aside = _moments(mass[:line], offset[:line], nodes, field.strains.shape[1] - nodes)
    points = field[off_axis] if len(off_axis) else field.points(off_axis)
    pairs, first = c.T @ (held[:, None] * c), c.T @ held
    return Inertia(field, mass, Bodies(points, mass[off_axis], held.sum(), pairs, first, turning, aside))


def _moments(mass: Array, offset: Array, nodes: int, before: int) -> tuple[Array | None, Array | None]:
    """Moments of inertia about the axis and first moments of sections by their particles, behind `before` nodes of the
    root; None where they have none.
    """
    xp = namespace(mass, offset)

    def at_nodes(values: Array) -> Array:
        return xp.pad(values.reshape(-1, nodes, values.shape[-1]).sum(axis=0).T, ((0, 0), (before, 0)))

    squares = at_nodes(mass[:, None] * offset**2)
    principal = squares.sum(axis=0) - squares
    if is_jax(principal):  # shapes of sections that can be traced are symmetric
        return principal, None
    size = principal.max(initial=0.0)
    if size == 0:
        return None, None
    products = at_nodes(-mass[:, None] * offset * np.roll(offset, -1, axis=1))
    aside = at_nodes(mass[:, None] * offset)
    coupled, beside = (np.abs(each).max() > NOTHING * most for each, most in ((products, size), (aside, mass.max())))
    turning = np.concatenate([principal, products]) if coupled else principal
    return turning, aside if beside else None
