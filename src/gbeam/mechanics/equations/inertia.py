"""The inertia of a complete model: the particles of its field, and what their motions and forces sum to."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.linear import Geometric, geometric_of
from gbeam.mechanics.fields.components import Vector, add, cross, joined, mapped, scaled, split, swept
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import Places

Array = Any


@record
class Inertia:
    """Particles (p,) kg of a field, quadrature points and bodies; `pairs` CᵀmC (G, G) kg and `first` Cᵀm (G,) kg where
    their places are constant sums C t of the field's tangents, else None and m.
    """

    field: StrainField | Places
    mass: Array
    pairs: Array | None
    first: Array

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), and resultant of m a and moment about the root (..., 3), of
        particles on a base with acceleration (or specific force), angular velocity and angular acceleration (..., 3):
        a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈.
        """
        field: Any = self.field
        if self.pairs is None:
            r, rd, rdd = field.components(q, qd, qdd)
        else:
            tangents = field.moving(q, qd, qdd)
            r, rd, rdd = tangents.t, tangents.td, tangents.tdd
        rate, change = (split(each[..., None, :]) for each in (w, alpha))
        relative = add(swept(rate, change, r), scaled(2.0, cross(rate, rd)), rdd)
        root = scaled(self.first, split(a[..., None, :]))
        if self.pairs is None:
            force = add(scaled(self.mass, relative), root)
            along = field.along(q, force)
            total: Vector = tuple(part.sum(axis=-1) for part in force)
        else:
            force = add(mapped(relative, self.pairs), root)
            along = field.pulled(tangents, force)
            total = tuple(part @ self.first + self.mass.sum() * a[..., axis] for axis, part in enumerate(relative))
        moment = [part.sum(axis=-1) for part in cross(r, force)]
        xp, shape = namespace(self.mass, q, a), total[0].shape
        return along, joined(xp, total, shape), joined(xp, tuple(moment), shape)

    def about(self, q: Array) -> tuple[Places, Geometric | None]:
        """Places of the particles about coordinates (n,), and their geometric stiffness unless they have second
        derivatives.
        """
        if isinstance(self.field, Places):
            return Places(self.field.positions(q), self.field.slopes(q), self.field.second), None
        places, bent = self.field.about(q, self.mass)
        return places, geometric_of(bent[0], bent[1:])


def inertia_of(field: StrainField | Places, mass: Array) -> Inertia:
    """Inertia of the particles of a field."""
    if isinstance(field, Places) or field.offset is not None:
        return Inertia(field, mass, None, mass)
    c = field.cumulative
    return Inertia(field, mass, c.T @ (mass[:, None] * c), c.T @ mass)
