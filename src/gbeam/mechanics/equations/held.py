"""The equations of an exact model that supports hold: those of the free one, along what the supports leave."""

from __future__ import annotations

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.dalembert import Complete, Demanding
from gbeam.mechanics.equations.inertia import Inertia, inertia_of
from gbeam.mechanics.equations.linear import Geometric, geometric_of
from gbeam.mechanics.fields.held import Conditions, HeldStrainField, projection
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
    def field(self) -> HeldStrainField:
        """Field of the particles."""
        assert isinstance(self.free.field, StrainField)
        return HeldStrainField(self.free.field, self.conditions)

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces on the coordinates (..., n), resultant of m a, and moment about the root (..., 3)."""
        whole, rate, change, basis = self.conditions.moving(q, qd, qdd)
        along, force, moment = self.free.forces(whole, rate, change, a, w, alpha)
        return projection(basis, along), force, moment

    def expand(self, q: Array) -> tuple[Places, Geometric | None]:
        """Places about coordinates (n,), and geometric stiffness."""
        places, bent = self.field.expand(q, self.mass)
        return places, geometric_of(bent[0], bent[1:])


def held_inertia(
    field: StrainField | SeriesField | HeldStrainField | Places,
    mass: Array,
    line: int = 0,
    nodes: int = 0,
    *,
    symmetric: bool = False,
) -> Inertia | HeldInertia:
    """Inertia of a field's particles, held or not, as :func:`gbeam.mechanics.equations.inertia.inertia_of` makes it."""
    if isinstance(field, HeldStrainField):
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
    """The equations of a complete model under supports, from those of the `free` one: rigid ones are `conditions`."""

    free: Complete
    conditions: Conditions
    springs: Springs | None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.conditions.size - len(self.conditions.dependent)

    @property
    def inertia(self) -> HeldInertia:
        """Inertia of the particles."""
        assert isinstance(self.free.inertia, Inertia)
        return HeldInertia(self.free.inertia, self.conditions)

    def strain_energy(self, q: Array) -> Array:
        """U, J, at coordinates (..., n)."""
        whole = self.conditions.lifted(q)
        energy = self.free.strain_energy(whole)
        return energy if self.springs is None else energy + self.springs.energy(whole)

    def elastic(self, q: Array) -> Array:
        """Forces of the strain energy on the coordinates (..., n)."""
        whole = self.conditions.lifted(q)
        forces = self.free.elastic(whole)
        if self.springs is not None:
            forces = forces + self.springs.elastic(whole)
        return self.conditions.projected(whole, forces)

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces that a motion demands, less those of the loads: on the coordinates (..., n), and force, N, and moment,
        N m, at the root (..., 3) by root and supports together.
        """
        whole, rate, change, basis = self.conditions.moving(q, qd, qdd)
        along, force, moment = self.whole(whole, rate, change, a, w, alpha, loads)
        return projection(basis, along), force, moment

    def whole(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces along its own coordinates and at the root that a motion of the free beam demands, springs included."""
        along, force, moment = self.free.demanded(q, qd, qdd, a, w, alpha, loads)
        if self.springs is not None:
            along = along + self.springs.forces(q, qd)
        return along, force, moment
