"""Shapes adapted to the structure: its own modes at rest, with its tapers, bodies and root springs.

The rich space in which they are found is that of all curvatures (strains, for the bar) given at the quadrature nodes,
a polynomial between two corners or bodies: where the section, the shear force or the moment jumps, the curvature may.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.fields.basis import Families, Family, Quadrature, Shapes
from gbeam.structure.beam import Beam

Array = NDArray[np.float64]


def _family(rule: Quadrature, nodal: Array, length: float, *, axial: bool) -> Family:
    """Functions of nodal curvatures (g, shapes), strains if `axial`: clamped at the root, ∫f² dx = L."""
    once = rule.cumulative(rule.node)
    slope = nodal if axial else once @ nodal
    # As the closed forms do, each shape leaves the root upwards: by its curvature there, whatever the nodes are.
    scale = np.sign(rule.interpolation(np.zeros(1))[0] @ nodal) / np.sqrt(rule.weight @ (once @ slope) ** 2 / length)
    nodal, slope = nodal * scale, slope * scale

    def shapes(x: Array) -> Shapes:
        first, interpolation = rule.cumulative(x), rule.interpolation(x)
        if not axial:
            return Shapes(first @ slope, first @ nodal, interpolation @ nodal)
        # No model needs the second derivative of a bar's shape.
        return Shapes(first @ nodal, interpolation @ nodal, np.full((len(x), nodal.shape[1]), np.nan))

    return shapes


class Space(NamedTuple):
    """All displacements in one direction that nodal curvatures (strains, of a bar) and the free root make; K (n,) is
    diagonal.
    """

    rule: Quadrature
    length: float
    axial: bool
    mass: Array
    stiffness: Array
    sensitivity: Callable[[Array], tuple[Array, Array]]

    def family(self, modes: Array) -> Family:
        """The shapes that columns (n, k) are without the root's motion."""
        return _family(self.rule, modes[: len(self.rule.node)], self.length, axial=self.axial)


_HELD = (("translation_x", ""), ("translation_y", "rotation_z"), ("translation_z", "rotation_y"))


def space(beam: Beam, rule: Quadrature, along: int) -> Space:
    """The space of displacements along x, y or z (0, 1, 2); the panels of the rule end at corners and bodies."""
    area, (axial, about_y, about_z) = beam.section.at(rule.node).area, beam.rigidities(rule.node)
    rigidity = (axial, about_z, about_y)[along]
    springs = beam.root.springs
    held = [springs.get(name) for name in _HELD[along]]
    free = [i for i, k in enumerate(held) if k is not None]
    sums = rule.cumulative(rule.node)

    def sensitivity(x: Array) -> tuple[Array, Array]:
        first = rule.cumulative(x)
        value, slope = (first, 0 * first) if along == 0 else (first @ sums, first)
        root_value, root_slope = np.stack([x**0, x], axis=1)[:, free], np.stack([0 * x, x**0], axis=1)[:, free]
        return np.concatenate([value, root_value], axis=1), np.concatenate([slope, root_slope], axis=1)

    value, _ = sensitivity(rule.node)
    mass = value.T @ ((beam.material.density * area * rule.weight)[:, None] * value)
    for body in beam.masses:
        value, slope = sensitivity(np.array([body.at]))
        for m, o in zip(*body.particles(), strict=True):
            # A particle off the axis moves with the section's slope: f + o_x f' across, −o_along f' along the beam.
            mass += m * sum(np.outer(d, d) for d in (value[0] + o[0] * slope[0], o[along] * slope[0]))
    stiffness = np.concatenate([rigidity * rule.weight, [held[i] for i in free]])
    return Space(rule, beam.length, along == 0, mass, stiffness, sensitivity)


def adapted_shapes(beam: Beam, rule: Quadrature, counts: tuple[int, int, int]) -> Families:
    """Modes at rest of the beam, direction by direction, from M κ = μ K κ with μ = 1/ω²: K is diagonal, M nearly
    singular.
    """

    def family(along: int) -> Family:
        count = counts[along]
        if not count:
            return lambda x: Shapes(*np.zeros((3, len(x), 0)))
        of = space(beam, rule, along)
        scale = 1 / np.sqrt(of.stiffness)
        modes = np.linalg.eigh(scale[:, None] * of.mass * scale)[1][:, len(scale) - count :]
        return of.family(scale[:, None] * modes[:, ::-1])

    return family(0), family(1), family(2)
