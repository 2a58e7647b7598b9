"""The field of a beam with all six strains, to first order: it stretches, shears, twists and bends.

r' = R (e₁ + ε), R' = R [κ]×, with ε = (stretch, shears along y and z) and κ = (twist, curvatures about y and z), sums
of shapes that are given by their values at the quadrature nodes. Places and turns are linear in the coordinates; their
second derivatives are there for the geometric stiffness and for loads.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.tree import record
from gbeam.mechanics.fields.rotation import rotation_matrix
from gbeam.mechanics.fields.taylor import EPSILON, Places, Turns

Array = Any


@record
class StrainedField:
    """Points x (p,) m of the axis by strains (6, g, n) ε and κ at the nodes, and the root's displacement and rotation
    (3, n).
    """

    x: Array
    cumulative: Array
    node_cumulative: Array
    strains: Array
    move: Array
    turn: Array

    def sampled(self, at: Any) -> StrainedField:
        """The field at some of the points."""
        return replace(self, x=self.x[at], cumulative=self.cumulative[at])

    def angles(self, onto: Array) -> Array:
        """Rotation vectors (3, points, n) where a matrix of integrals leads."""
        return onto @ self.strains[3:] + self.turn[:, None]

    def displacements(self) -> Array:
        """Displacements of the points, (3, points, n)."""
        angle = self.angles(self.node_cumulative)
        slope = self.strains[:3].copy()
        slope[1] += angle[2]
        slope[2] -= angle[1]
        return self.cumulative @ slope + self.move[:, None]

    def places(self) -> Places:
        """Places of the points."""
        straight = np.stack([self.x, 0 * self.x, 0 * self.x], axis=-1)
        return Places(straight, np.moveaxis(self.displacements(), 0, 1))

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotation matrices of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        return rotation_matrix(np.einsum("api,...i->...pa", self.angles(self.cumulative[at]), q))

    def curved(self) -> tuple[Places, Turns]:
        """Places and turns of the points with their second derivatives."""
        count = len(self.x)
        even, arms = np.eye(count), np.zeros((count, 3, count))
        places = self.places()
        turn = -np.einsum("abc,cpi->pabi", EPSILON, self.angles(self.cumulative))
        bend = np.stack([self.weighted(0 * even, _unit(arms, axis)) for axis in range(3)], axis=2)
        return Places(places.r0, places.first, self.weighted(even, arms)), Turns(turn, bend)

    def weighted(self, weight: Array, arm: Array) -> Array:
        """Σ w H of the points plus Σ (∂²R/∂q²) a, (k, 3, n, n), for weights (k, p) and section arms (k, 3, p)."""
        (*strain, twist, bend_y, bend_z), angle = self.strains, self.angles(self.node_cumulative)
        kappa, n = (twist, bend_y, bend_z), self.strains.shape[-1]
        at_nodes = weight @ self.cumulative
        along = arm @ self.cumulative
        along[:, 0] += at_nodes @ self.node_cumulative
        out = np.zeros((len(weight), 3, n, n))

        def add(onto: int, by: Array, left: Array, right: Array) -> None:
            out[:, onto] += (left.T[None] * by[:, None]) @ right

        for a, b, c in np.argwhere(EPSILON):  # R' ε = θ × ε
            add(a, EPSILON[a, b, c] * at_nodes, angle[b], strain[c])
        for a in range(3):  # θ × (κ × d) = κ (θ·d) − d (θ·κ)
            for b in range(3):
                add(a, along[:, b], angle[b], kappa[a])
                add(a, -along[:, a], angle[b], kappa[b])
        whole = arm.sum(axis=2)
        whole[:, 0] += weight @ self.x
        turn = self.turn  # of the root: ½ φ × (φ × d)
        out += 0.5 * np.einsum("ai,bj,kb->kaij", turn, turn, whole)
        out -= 0.5 * np.einsum("bi,bj,ka->kaij", turn, turn, whole)
        return out + np.swapaxes(out, -1, -2)


def _unit(arms: Array, axis: int) -> Array:
    """An arm of 1 along an axis, at one point after the other."""
    arms = arms.copy()
    arms[:, axis] = np.eye(len(arms))
    return arms
