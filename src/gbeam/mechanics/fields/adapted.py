"""Shapes adapted to the structure: its own modes at rest, with its tapers, bodies and root springs.

The rich space in which they are found is that of all curvatures (strains, for the bar) given at the quadrature nodes,
a polynomial between two corners or bodies: where the section, the shear force or the moment jumps, the curvature may.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.fields.basis import Families, Family, Quadrature, Shapes
from gbeam.structure.beam import Beam

Array = NDArray[np.float64]


def _family(rule: Quadrature, nodal: Array, length: float, *, axial: bool) -> Family:
    """Functions of nodal curvatures (g, shapes), strains if `axial`: clamped at the root, ∫f² dx = L."""
    once = rule.cumulative(rule.node)
    slope = nodal if axial else once @ nodal
    # As the closed forms do, each shape leaves the root upwards.
    scale = np.sign(nodal[0]) / np.sqrt(rule.weight @ (once @ slope) ** 2 / length)
    nodal, slope = nodal * scale, slope * scale

    def shapes(x: Array) -> Shapes:
        first, here = rule.cumulative(x), rule.interpolation(x)
        if not axial:
            return Shapes(first @ slope, first @ nodal, here @ nodal)
        # No model needs the second derivative of a bar's shape.
        return Shapes(first @ nodal, here @ nodal, np.full((len(x), nodal.shape[1]), np.nan))

    return shapes


def adapted_shapes(beam: Beam, rule: Quadrature, counts: tuple[int, int, int]) -> Families:
    """Modes at rest of the beam, direction by direction; the root's motion is left to the springs' own coordinates.

    Parameters
    ----------
    beam : Beam
    rule : quadrature with panels that end at the section's corners and at the bodies
    counts : numbers of axial shapes, bending shapes along y, bending shapes along z

    Notes
    -----
    M κ = μ K κ is solved for the largest μ = 1/ω²: K is diagonal in nodal curvatures, M nearly singular.
    """
    section, e = beam.section.at(rule.node), beam.material.youngs_modulus
    once = rule.cumulative(rule.node)
    bodies = [(np.array([b.at]), *b.particles()) for b in beam.masses]
    springs = beam.root.springs

    def family(count: int, rigidity: Array, along: int, move: str, turn: str) -> Family:
        held = [springs.get(move), springs.get(turn)]
        free = [i for i, k in enumerate(held) if k is not None]

        def sensitivity(x: Array, sums: Array) -> tuple[Array, Array]:
            """Displacement and slope at x by nodal curvatures and by the root's displacement and rotation."""
            first = rule.cumulative(x)
            value, slope = (first, 0 * first) if along == 0 else (first @ sums, first)
            root_value, root_slope = np.stack([x**0, x], axis=1)[:, free], np.stack([0 * x, x**0], axis=1)[:, free]
            return np.concatenate([value, root_value], axis=1), np.concatenate([slope, root_slope], axis=1)

        value, _ = sensitivity(rule.node, once)
        mass = value.T @ ((beam.material.density * section.area * rule.weight)[:, None] * value)
        for at, masses, offset in bodies:
            value, slope = sensitivity(at, once)
            for m, o in zip(masses, offset, strict=True):
                # A particle off the axis moves with the section's slope: f + o_x f' across, −o_along f' along the beam.
                mass += m * sum(np.outer(d, d) for d in (value[0] + o[0] * slope[0], o[along] * slope[0]))
        stiffness = np.concatenate([e * rigidity * rule.weight, [held[i] for i in free]])
        scale = 1 / np.sqrt(stiffness)
        size = len(stiffness)
        modes = np.linalg.eigh(scale[:, None] * mass * scale)[1][:, size - count :]
        return _family(rule, (scale[:, None] * modes[:, ::-1])[: len(rule.node)], beam.length, axial=along == 0)

    def none(x: Array) -> Shapes:
        return Shapes(*np.zeros((3, len(x), 0)))

    return (
        family(counts[0], section.area, 0, "translation_x", "") if counts[0] else none,
        family(counts[1], section.inertia_z, 1, "translation_y", "rotation_z") if counts[1] else none,
        # Rotation about y turns the slope down: the sign is a matter of the springs' coordinate, not of the shape.
        family(counts[2], section.inertia_y, 2, "translation_z", "rotation_y") if counts[2] else none,
    )
