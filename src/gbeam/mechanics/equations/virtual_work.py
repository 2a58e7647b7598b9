"""Virtual work of loads on the beam: their generalised forces, complete, and to first order in the coordinates.

A load has six components, force and moment. `values` (loads, 6) holds those of all loads at one time.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.linear import LoadTerms
from gbeam.mechanics.fields.held import HeldField
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import EPSILON, Places, Polynomials
from gbeam.mechanics.fields.vectors import cross, joined, split
from gbeam.motion.profiles.piecewise import constant


@record
class LoadWork:
    """Loads on a field, δW = Σ F·δr + M·δθ.

    Each of its points (p,) has the index of the load that acts there, the weight (1, or m of a load per metre), and a
    flag, true if the load turns with the section.

    The last load may be the rise of a temperature, K, in its first component. `heat` (m,) are the forces of 1 K on the
    coordinates, or on those of the free beam where conditions hold it.
    """

    field: StrainField | SeriesField | HeldField | Polynomials
    load: Array
    weight: Array
    follower: Array
    heat: Array | None = None

    def generalised(self, q: Array, values: Array) -> tuple[Array, Array, Array]:
        """Forces on the coordinates (..., n) of loads with components (..., loads, 6), and their resultant force N and
        moment N m at the root, base axes, (..., 3).
        """
        force, moment = self.forces(self.field.rotation(q), values)
        generalised_forces = self.field.generalised_forces(q, split(force), split(moment))
        if self.heat is not None:
            generalised_forces = generalised_forces + values[..., -1, 0, None] * self._heating(q)
        return generalised_forces, *self.resultant(self.field.positions(q), force, moment)

    def _heating(self, q: Array) -> Array:
        """Forces (n,) or (..., n) of a rise of the temperature by 1 K on the coordinates (..., n)."""
        if not isinstance(self.field, HeldField):
            return self.heat
        conditions = self.field.conditions
        return conditions.projected(conditions.lifted(q), self.heat)

    @staticmethod
    def resultant(r: Array, force: Array, moment: Array) -> tuple[Array, Array]:
        """Force and moment at the root, (..., 3), of forces and moments (..., p, 3) at places r."""
        turn = joined(namespace(r, force), cross(split(r), split(force)), force.shape[:-1])
        return force.sum(axis=-2), (turn + moment).sum(axis=-2)

    def forces(self, rotation: Array, values: Array) -> tuple[Array, Array]:
        """Forces and moments (..., p, 3) at the loaded points, base axes.

        The points' sections have the rotations (..., p, 3, 3), with which follower loads turn. `values` (..., loads, 6)
        are the components of the loads, each given to its points by their weights.
        """
        xp = namespace(rotation, values, self.weight)
        local = xp.asarray(self.weight)[:, None] * values[..., self.load, :]
        axes = self._axes(rotation)
        return (
            xp.einsum("...pij,...pj->...pi", axes, local[..., :3]),
            xp.einsum("...pij,...pj->...pi", axes, local[..., 3:]),
        )

    def _axes(self, rotation: Array) -> Array:
        """Axes of the loads in columns (..., p, 3, 3): those of the section where they follow it, else the base's."""
        xp = namespace(rotation, self.weight)
        return xp.where(xp.asarray(self.follower)[:, None, None], rotation, xp.eye(3))

    def linearise(self, count: int, q: Array) -> LoadTerms:
        """Generalised forces of the unit components of all `count` loads, to first order about coordinates (n,)."""
        places, rotation, turns = self.field.curved(q)
        terms = self.terms(count, places, rotation, turns.first, turns.second)
        if self.heat is None:
            return terms
        n, xp = q.shape[-1], namespace(terms.constant, self.heat)
        last = np.zeros((count, 6))
        last[-1, 0] = 1.0
        heating = xp.concatenate([np.zeros(6), self._heating(q)])
        constant = terms.constant + last[..., None] * heating
        if not isinstance(self.field, HeldField):
            return LoadTerms(constant, terms.slope)
        conditions = self.field.conditions
        coordinates = conditions.lifted(q)
        curved = conditions.curvature(coordinates, conditions.basis(coordinates))
        bent = np.tensordot(self.heat[np.array(conditions.dependent, dtype=int)], curved, axes=1)
        return LoadTerms(constant, terms.slope + last[..., None, None] * np.concatenate([np.zeros((6, n)), bent]))

    def terms(self, count: int, places: Places, rotation: Array, turn: Array, bend: Array) -> LoadTerms:
        """Constant part and slope of the loads' generalised forces about a shape, for each of `count` loads.

        The shape is given by `places`, by section rotations (p, 3, 3), and by their first and second derivatives `turn`
        and `bend`.
        """
        xp = namespace(places.first, rotation, self.weight)
        r, slope, second = places.r0, places.first, places.second
        epsilon = xp.asarray(EPSILON)
        # In columns: the unit components, and how those of a follower turn.
        axes, turned = self._axes(rotation), xp.asarray(self.follower)[:, None, None, None] * turn

        def rows(columns: Array) -> Array:
            return xp.swapaxes(columns, 1, 2)

        def vector_products(left: Array, right: Array, form: str) -> Array:
            return xp.einsum(f"abd,{form}", epsilon, left, right)

        def angle(outer: Array, inner: Array, form: str) -> Array:
            """Vector θ of the skew matrix [θ]× = outer innerᵀ."""
            return -0.5 * xp.einsum("abe,pab...->pe...", epsilon, xp.einsum(form, outer, inner))

        # Resultant, moment about the root, and forces on the coordinates: of unit forces, then of unit moments.
        force = [rows(axes), vector_products(r, axes, "pb,pdc->pca"), xp.einsum("pai,pac->pci", slope, axes)]
        force_slope = [
            rows(turned),
            vector_products(slope, axes, "pbj,pdc->pcaj") + vector_products(r, turned, "pb,pdcj->pcaj"),
            xp.einsum("paij,pac->pcij", second, axes) + xp.einsum("pai,pacj->pcij", slope, turned),
        ]
        # A moment works along θ_i of [θ_i]× = ∂R/∂q_i Rᵀ.
        first_angle = angle(turn, rotation, "padi,pbd->pabi")
        second_angle = angle(bend, rotation, "padij,pbd->pabij") + angle(turn, turn, "padi,pbdj->pabij")
        moment = [xp.zeros_like(axes), rows(axes), xp.einsum("pei,pec->pci", first_angle, axes)]
        moment_slope = [
            xp.zeros_like(turned),
            rows(turned),
            xp.einsum("peij,pec->pcij", second_angle, axes) + xp.einsum("pei,pecj->pcij", first_angle, turned),
        ]
        weight_of_load = (np.arange(count)[:, None] == xp.asarray(self.load)) * xp.asarray(self.weight)  # (loads, p)

        def summed(force: list[Array], moment: list[Array]) -> Array:
            return xp.tensordot(
                weight_of_load, xp.concat([xp.concat(force, axis=2), xp.concat(moment, axis=2)], axis=1), axes=1
            )

        return LoadTerms(summed(force, moment), summed(force_slope, moment_slope))


@record
class LoadHistory:
    """The components of all loads over time, from a force and a moment profile each; called as ``history(t)``."""

    profiles: tuple[tuple[Any, Any], ...]

    def __call__(self, t: Array) -> Array:
        """Components (..., loads, 6) at times t, s: N, N m; per metre where the load is."""
        parts = [[p(t) for p in pair] for pair in self.profiles]
        xp = namespace(*(part for pair in parts for part in pair))
        return xp.stack([xp.concatenate(pair, axis=-1) for pair in parts], axis=-2)

    def freeze(self, time: float) -> LoadHistory:
        """Return constant loads, those of a time, s."""
        return LoadHistory(tuple((constant(force(time)), constant(moment(time))) for force, moment in self.profiles))

    def corners(self, step: float) -> np.ndarray:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        return np.unique(np.concatenate([p.corners(step) for pair in self.profiles for p in pair]))
