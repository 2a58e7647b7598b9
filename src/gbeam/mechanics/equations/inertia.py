"""Inertia and elasticity: the particles of a displacement field, and its strain energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.fields.rotation import Field, Strains
from gbeam.mechanics.fields.taylor import Places

Array = Any


@record
class Inertia:
    """The particles of a field, quadrature points and bodies: masses (p,) kg and offsets (p, 3) m from the axis,
    section axes.
    """

    field: Field
    mass: Array
    offset: Array | None

    def positions(self, q: Array) -> Array:
        """Positions of the particles at coordinates (..., n), base axes, (..., particles, 3) m."""
        r = self.field.position(q)
        if self.offset is None:
            return r
        xp = namespace(r, self.offset)
        if xp is not np:
            return r + xp.einsum("...kij,kj->...ki", self.field.rotation(q), self.offset)
        off = self.off_axis  # few: the sections of the others need not turn
        r[..., off, :] += self.arms(q, off)
        return r

    @property
    def off_axis(self) -> Array:
        """Indices of the particles off the axis."""
        return np.flatnonzero(np.any(self.offset != 0, axis=1))

    def arms(self, q: Array, at: Array) -> Array:
        """From the axis to some particles at coordinates (..., n), base axes, (..., len(at), 3) m."""
        offset: Any = self.offset
        return np.einsum("...kij,kj->...ki", self.field.rotation(q, at), offset[at])

    def places(self) -> Places:
        """Taylor polynomial of the positions at the straight beam."""
        axis = self.field.places()
        return axis if self.offset is None else self.field.turns().carry(axis, self.offset)


@record
class Weighed:
    """The particles as time steps read them: where their places are constant combinations C t(q) of points, the masses
    enter as `pairs` CᵀmC (p, p) kg and `first` Cᵀm (p,) kg.
    """

    inertia: Inertia
    pairs: Array | None
    first: Array

    def points(self, q: Array) -> tuple[Array, Array, Array]:
        """The points at coordinates (n,), by components (p,)."""
        if self.pairs is not None:
            return self.inertia.field.components(q)
        r = self.inertia.positions(q)
        return r[:, 0], r[:, 1], r[:, 2]

    def forces(self, relative: Any, root: Array) -> tuple[Array, ...]:
        """Inertia forces on the points by components (p,), of accelerations relative to the root's, and that, (3,)."""
        if self.pairs is None:
            relative_forces = [self.first * a for a in relative]
        else:  # which is symmetric
            relative_forces = list(namespace(self.pairs, *relative).stack(relative) @ self.pairs)
        return tuple(f + self.first * a for f, a in zip(relative_forces, root, strict=True))

    def total(self, relative: Any, root: Array) -> Array:
        """Their resultant, (3,) N."""
        xp = namespace(self.first, root, *relative)
        return xp.stack(relative) @ self.first + self.inertia.mass.sum() * root


def weighed(inertia: Inertia) -> Weighed:
    """Weigh the particles at the points of their field."""
    field, mass = inertia.field, inertia.mass
    if inertia.offset is not None or not field.cumulates:
        return Weighed(inertia, None, mass)
    return Weighed(inertia, field.cumulative.T @ (mass[:, None] * field.cumulative), field.cumulative.T @ mass)


@record
class Elasticity:
    """Strain energy U = ½ ∫ EA ε² + EI_y κ_y² + EI_z κ_z² dx + ½ Σ k s² (2009 (10); 2020 (8), corrected); rigidities
    times weights (g,).
    """

    field: Field
    rigidity: Strains

    def energy(self, q: Array) -> Array:
        """Strain energy at coordinates (n,), J."""
        parts = [(k * e**2).sum() for k, e in zip(self.rigidity, self.field.strains(q), strict=True)]
        return 0.5 * (parts[0] + parts[1] + parts[2] + parts[3])

    def stiffness(self) -> Array:
        """Second derivatives of the energy at the straight beam, (n, n)."""
        slopes = self.field.strain_slopes()
        parts = [b.T @ (k[:, None] * b) for k, b in zip(self.rigidity, slopes, strict=True) if len(k)]
        return sum(parts[1:], start=parts[0])
