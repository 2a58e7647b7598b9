"""Shapes adapted to the structure: its own modes at rest, with its tapers, bodies and root springs.

They are found in a rich space of curvatures, or of strains for the bar. These are given at the quadrature nodes, and
are a polynomial between two corners or bodies. Where the section, the shear force or the moment jumps, the curvature
may jump.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import is_jax
from gbeam.arrays.types import Floats
from gbeam.mechanics.fields.basis import Counts, Families, Family, Quadrature, Shapes
from gbeam.mechanics.fields.strains import STRAINS
from gbeam.structure.beam import Beam


def nodal_family(rule: Quadrature, nodal: Floats, length: float, *, axial: bool) -> Family:
    """Shapes with nodal curvatures (g, shapes), or slopes if `axial`: clamped at the root, scaled to ∫f² dx = L."""
    integral = rule.cumulative(rule.node)
    slope = nodal if axial else integral @ nodal
    # As the closed forms do, each shape leaves the root upwards: by its curvature there, whatever the nodes are.
    upwards = np.sign(rule.interpolation(np.zeros(1))[0] @ nodal)
    scale = upwards / np.sqrt(rule.weight @ (integral @ slope) ** 2 / length)
    nodal, slope = nodal * scale, slope * scale

    def shapes(x: Floats) -> Shapes:
        first, interpolation = rule.cumulative(x), rule.interpolation(x)
        if not axial:
            return Shapes(first @ slope, first @ nodal, interpolation @ nodal)
        # No model needs the second derivative of a bar's shape.
        return Shapes(first @ nodal, interpolation @ nodal, np.full((len(x), nodal.shape[1]), np.nan))

    return shapes


class Space(NamedTuple):
    """Motions in one direction, or about x, by coordinates (n,): nodal strains of some `families`, then springs of the
    root.

    `mass` is (n, n). `stiffness` (n,) is the diagonal of K, unless `upper` (n, n) makes it upperᵀ upper. `sensitivity`
    gives displacements and angles (points, n) at positions. `line` (g,) kg and `turning` (g,) kg m² are the sections'
    inertia. `loads` (n, k) are None unless it has motions in all directions. Coordinates that are `loose` move the root
    where nothing holds it. Their stiffness is one like the beam's.
    """

    rule: Quadrature
    length: float
    families: tuple[int, ...]
    line: Floats
    turning: Floats
    mass: Floats
    stiffness: Floats
    sensitivity: Callable[[Floats], tuple[Floats, Floats]]
    loads: Floats | None = None
    upper: Floats | None = None
    loose: tuple[int, ...] = ()

    def scaled(self, strains: Floats, *, back: bool = False) -> Floats:
        """Strains (n, k) scaled so that their energy is half their square, or scaled `back` from that."""
        if self.upper is None:
            root = np.sqrt(self.stiffness)[:, None]
            return strains / root if back else root * strains
        return np.asarray(np.linalg.solve(self.upper, strains) if back else self.upper @ strains)

    @property
    def bends(self) -> bool:
        """True if curvatures are among the strains."""
        return self.families[0] in (1, 2)

    def block(self, family: int) -> slice:
        """Slice of a family's nodal strains among the coordinates."""
        start, nodes = self.families.index(family), len(self.rule.node)
        return slice(start * nodes, (start + 1) * nodes)

    def family(self, family: int, modes: Floats) -> Family:
        """Shapes of one family with the nodal strains of columns (n, k)."""
        return nodal_family(self.rule, modes[self.block(family)], self.length, axial=family not in (1, 2))


def springs_for_shapes(beam: Beam) -> dict[str, Any]:
    """Stiffnesses of the root's springs by name, with one like the beam's where a root is free to move, so that static
    answers exist. The root's motion itself is a coordinate anyway.
    """
    axial, about_y, about_z = (rigidity[0] for rigidity in beam.rigidities(np.zeros(1)))
    about_x, length = float(beam.stiffnesses(np.zeros(1))[3][0]), beam.length
    like_the_beam = {
        "translation_x": axial / length,
        "translation_y": about_z / length**3,
        "translation_z": about_y / length**3,
        "rotation_x": (about_y + about_z if np.isnan(about_x) else about_x) / length,
        "rotation_y": about_y / length,
        "rotation_z": about_z / length,
    }
    springs = dict[str, Any]()
    for name, stiffness in beam.root.springs.items():
        free = not is_jax(stiffness) and stiffness == 0
        springs[name] = like_the_beam[name] if free else stiffness
    return springs


GROUPS = ((0,), (1, 4), (2, 5), (3,))  # families that move the beam along x, y and z, and turn it about x
_HELD = (("translation_x", ""), ("translation_y", "rotation_z"), ("translation_z", "rotation_y"), ("", "rotation_x"))


def spaces_of(beam: Beam, rule: Quadrature, counts: Counts) -> tuple[Space, ...]:
    """Spaces of displacements along x, y and z, and about x of a model that twists, without strains that are rigid."""
    return tuple(space(beam, rule, direction, counts) for direction in range(4 if counts[3] else 3))


def space(beam: Beam, rule: Quadrature, direction: int, counts: Counts) -> Space:
    """Space of displacements along x, y or z (`direction` 0, 1, 2), or of turning about x (3), by nodal strains.

    Panels of `rule` end at corners and bodies.
    """
    first, *other_families = GROUPS[direction]
    families = (first, *(family for family in other_families if counts[family]))
    section, stiffnesses = beam.section.at(rule.node), beam.stiffnesses(rule.node)
    line = beam.density * section.area * rule.weight
    second_moment = (0 * line, section.inertia_z, section.inertia_y, section.inertia_y + section.inertia_z)[direction]
    rotary = beam.density * second_moment * rule.weight * beam.rotary_inertia
    springs = springs_for_shapes(beam)
    springs_at_root = [springs.get(name) for name in _HELD[direction]]
    free = [i for i, k in enumerate(springs_at_root) if k is not None]
    sums = rule.cumulative(rule.node)

    def sensitivity(x: Floats) -> tuple[Floats, Floats]:
        """Displacements and section angles (points, n) of unit nodal strains, then of unit motions of the root."""
        first = rule.cumulative(x)
        move, turn = {0: (first, 0 * first), 3: (0 * first, first)}.get(direction, (first @ sums, first))
        value, angle = [move, *[first] * len(families[1:])], [turn, *[0 * first] * len(families[1:])]
        carried = 0 * x if direction == 3 else x  # by a turn of the root
        value.append(np.stack([x**0, carried], axis=1)[:, free])
        angle.append(np.stack([0 * x, x**0], axis=1)[:, free])
        return np.concatenate(value, axis=1), np.concatenate(angle, axis=1)

    value, angle = sensitivity(rule.node)
    mass = value.T @ (line[:, None] * value) + angle.T @ (rotary[:, None] * angle)
    for body in beam.masses:
        value, angle = sensitivity(np.array([body.at]))
        for m, o in zip(*body.particles(), strict=True):
            # A particle off the axis moves with the section's angle: f + o_x f' across, −o_along f' along the beam.
            arms = (
                (o[1] * angle[0], o[2] * angle[0])
                if direction == 3
                else (value[0] + o[0] * angle[0], o[direction] * angle[0])
            )
            mass += m * sum(np.outer(d, d) for d in arms)
    strained = [stiffnesses[STRAINS[family]] * rule.weight for family in families]
    stiffness = np.concatenate([*strained, [springs_at_root[i] for i in free]])
    first_spring, values = len(stiffness) - len(free), [beam.root.springs.get(_HELD[direction][i]) for i in free]
    loose = tuple(first_spring + k for k, value in enumerate(values) if not is_jax(value) and value == 0)
    return Space(rule, beam.length, families, line, rotary, mass, stiffness, sensitivity, loose=loose)


def adapted_shapes(beam: Beam, rule: Quadrature, counts: Counts) -> Families:
    """Modes at rest of the beam by direction, as shapes.

    They solve M κ = μ K κ with μ = 1/ω² for the nodal strains κ: K is diagonal and M is nearly singular.
    """
    families: list[Family] = [lambda x: Shapes(*np.zeros((3, len(x), 0)))] * 6
    for motions in spaces_of(beam, rule, counts):
        scale = 1 / np.sqrt(motions.stiffness)
        modes = scale[:, None] * np.linalg.eigh(scale[:, None] * motions.mass * scale)[1][:, ::-1]
        for family in motions.families:
            if counts[family]:
                families[family] = motions.family(family, modes[:, : counts[family]])
    axial, along_y, along_z, twist, shear_y, shear_z = families
    return axial, along_y, along_z, twist, shear_y, shear_z
