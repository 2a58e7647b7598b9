"""The equations of a model under supports whose conditions are curved: those of the free one, along what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.contraction import Reach
from gbeam.mechanics.equations.dalembert import Complete, Demanding
from gbeam.mechanics.equations.inertia import Inertia, inertia_of
from gbeam.mechanics.equations.linear import Geometric, geometric_by, geometric_of
from gbeam.mechanics.equations.moments import Moments
from gbeam.mechanics.fields.held import Conditions, HeldField, projection
from gbeam.mechanics.fields.measures import Measures
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import Places


@record
class HeldInertia:
    """Inertia of a free beam's particles, along the coordinates that conditions leave."""

    free: Inertia
    conditions: Conditions

    @property
    def mass(self) -> Array:
        """Masses of the particles (p,), kg."""
        return self.free.mass

    @property
    def field(self) -> HeldField:
        """Field of the particles."""
        return HeldField(self.free.field, self.conditions)

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces on the coordinates (..., n), resultant of m a, and moment about the root (..., 3)."""
        coordinates, rate, change, basis = self.conditions.moving(q, qd, qdd)
        generalised, force, moment = self.free.forces(coordinates, rate, change, a, w, alpha)
        return projection(basis, generalised), force, moment

    def expand(self, q: Array) -> tuple[Places, Geometric]:
        """Places about coordinates (n,), and geometric stiffness."""
        coordinates, dependent = self.conditions.lifted(q), np.array(self.conditions.dependent, dtype=int)
        places, geometric = self.free.expand(coordinates)
        if geometric is None:
            geometric = geometric_by(self.mass, places)
        phi = self.conditions.basis(coordinates)
        weights = np.concatenate([self.mass[None], self.mass * places.r0.T])
        by_held = np.einsum("wp,pad->wad", weights, places.first[..., dependent])
        bent = np.einsum("wad,dij->waij", by_held, self.conditions.curvature(coordinates, phi))
        return Places(places.r0, places.first @ phi), geometric.turned(phi) + geometric_of(bent[0], bent[1:])


def held_inertia(
    field: StrainField | SeriesField | HeldField | Places,
    mass: Array,
    line: int = 0,
    nodes: int = 0,
    *,
    symmetric: bool = False,
) -> Inertia | HeldInertia:
    """Inertia of a field's particles, held or not, as :func:`gbeam.mechanics.equations.inertia.inertia_of` makes it."""
    if isinstance(field, HeldField):
        free = inertia_of(field.free, mass, line, nodes, symmetric=symmetric)
        return HeldInertia(free, field.conditions)
    return inertia_of(field, mass, line, nodes, symmetric=symmetric)


@record
class Springs:
    """Springs and dampers at supports: stiffness and damping (j,) of what is measured."""

    measures: Measures
    stiffness: Array
    damping: Array

    def energy(self, q: Array) -> Array:
        """Strain energy (...) J, at coordinates of the free beam (..., n)."""
        return (self.stiffness * self.measures.values(q) ** 2).sum(axis=-1) / 2

    def elastic(self, q: Array) -> Array:
        """Forces of the springs on the coordinates, (..., n)."""
        values, rows = self.measures.values_and_rows(q)
        return ((self.stiffness * values)[..., None, :] @ rows)[..., 0, :]

    def forces(self, q: Array, qd: Array) -> Array:
        """Forces of springs and dampers on the coordinates, (..., n)."""
        values, rows = self.measures.values_and_rows(q)
        efforts = self.stiffness * values + self.damping * (rows @ qd[..., None])[..., 0]
        return (efforts[..., None, :] @ rows)[..., 0, :]


@record
class HeldComplete(Demanding):
    """The equations of a model under supports, from those of the `free` one: rigid ones are `conditions`."""

    free: Complete | Moments
    conditions: Conditions
    springs: Springs | None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.conditions.size - len(self.conditions.dependent)

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        """Mass kg, and its first moment (..., 3) kg m about the root, its axes."""
        return self.free.mass_moment(self.conditions.lifted(q))

    def strain_energy(self, q: Array) -> Array:
        """U, J, at coordinates (..., n)."""
        coordinates = self.conditions.lifted(q)
        energy = self.free.strain_energy(coordinates)
        return energy if self.springs is None else energy + self.springs.energy(coordinates)

    def elastic(self, q: Array) -> Array:
        """Forces of the strain energy on the coordinates (..., n)."""
        coordinates = self.conditions.lifted(q)
        forces = self.free.elastic(coordinates)
        if self.springs is not None:
            forces = forces + self.springs.elastic(coordinates)
        return self.conditions.projected(coordinates, forces)

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces that a motion demands, less those of the loads: on the coordinates (..., n), and force, N, and moment,
        N m, at the root (..., 3) by root and supports together.
        """
        coordinates, rate, change, basis = self.conditions.moving(q, qd, qdd)
        generalised, force, moment = self.whole(coordinates, rate, change, a, w, alpha, loads)
        return projection(basis, generalised), force, moment

    def contracted(self, reach: Reach) -> HeldComplete:
        """Contract the free model's equations with what the root can do; return these where that is no faster."""
        free = self.free.contracted(reach)
        return self if free is self.free else replace(self, free=free)

    def whole(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces along its own coordinates and at the root that a motion of the free beam demands, springs included."""
        along, force, moment = self.free.demanded(q, qd, qdd, a, w, alpha, loads)
        if self.springs is not None:
            along = along + self.springs.forces(q, qd)
        return along, force, moment
