"""Supports of a beam as conditions on its coordinates, and the shapes that show what supports do.

A support that holds a direction rigidly says that a row of derivatives of its place or angle, times the coordinates,
is zero: A q = 0. Coordinates of shapes that depend on the others are left out, q = N p with A N = 0, so that constant
coefficients stay constant. To the shapes come the static deflections under unit loads at each support.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, holds_jax
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.fields.adapted import Space, nodal_family
from gbeam.mechanics.fields.basis import FAMILIES, Counts, Families, Family, Quadrature, joined_family
from gbeam.mechanics.fields.strains import STRAINS
from gbeam.structure.beam import Beam
from gbeam.structure.material import Material
from gbeam.structure.matrices import condensed
from gbeam.structure.section import Section
from gbeam.structure.supports import DIRECTIONS

FAMILY = {"x": 0, "y": 1, "z": 2, "rx": 3, "ry": 2, "rz": 1}  # that moves or turns sections in a direction
NEW = 1e-3  # of a static shape's length in energy: with less of it than that it is nearly one of the others
ALIKE = 1e-9  # of a condition's length: less of it is nothing that the other conditions do not say
THICK = 0.2  # radius of gyration, as a part of the length, by which sizes of stretch and bending are compared


class Condition(NamedTuple):
    """A direction in which a beam's support holds it: the index of the support, its position, m, and the direction."""

    support: int
    at: float
    direction: str

    @property
    def number(self) -> int:
        """Number of the direction, from 0 to 5."""
        return DIRECTIONS.index(self.direction)

    @property
    def family(self) -> int:
        """Family of shapes that it concerns."""
        return FAMILY[self.direction]


def rigid_conditions(beam: Beam) -> list[Condition]:
    """Conditions of a beam's rigid supports beyond its root."""
    places = beam.held_places.items()
    return [Condition(i, support.place, direction) for i, support in places for direction in support.rigid]


def yielding_conditions(beam: Beam) -> list[Condition]:
    """Directions in which springs and dampers hold a beam beyond its root."""
    places = beam.held_places.items()
    return [Condition(i, support.place, direction) for i, support in places for direction in support.yielding]


def families_of(beam: Beam, condition: Condition, counts: Counts) -> tuple[int, ...]:
    """Families of shapes that a condition concerns: of a beam whose directions are coupled all that a model has."""
    return tuple(k for k in range(6) if counts[k]) if beam.coupled else (condition.family,)


def static_counts(beam: Beam, counts: Counts) -> Counts:
    """Numbers of static shapes by family, of supports and of the temperature, in a model with `counts` of shapes."""
    conditions = [*rigid_conditions(beam), *yielding_conditions(beam)]
    concerned = [family for condition in conditions for family in families_of(beam, condition, counts)]
    if beam.temperature is not None and not beam.coupled:
        concerned.append(0)
    axial, y, z, twist, shear_y, shear_z = (concerned.count(k) for k in range(6))
    return axial, y, z, twist, shear_y, shear_z


def counts_without(counts: Counts, indices: tuple[int, ...]) -> Counts:
    """Numbers of shapes without those whose indices are taken."""
    family = np.repeat(np.arange(6), counts)
    remaining = np.delete(family, [index for index in indices if index < len(family)])
    axial, y, z, twist, shear_y, shear_z = (int((remaining == k).sum()) for k in range(6))
    return axial, y, z, twist, shear_y, shear_z


def plus(counts: Counts, added: Counts) -> Counts:
    """Sums of numbers of shapes by family."""
    axial, y, z, twist, shear_y, shear_z = (a + b for a, b in zip(counts, added, strict=True))
    return axial, y, z, twist, shear_y, shear_z


def refuse_shapeless(beam: Beam, counts: Counts) -> None:
    """Raise InputError where a support holds a direction along which a model has no shapes."""
    for condition in (*rigid_conditions(beam), *yielding_conditions(beam)):
        where, name = f"supports[{condition.support}]", FAMILIES[condition.family]
        if not beam.coupled and not counts[condition.family]:
            problem = f"holds {condition.direction}, in which the model has no shapes"
            raise InputError(where, problem, f"give modes.{name} = 1 or more, or leave {condition.direction} out")


def supported_shapes(beam: Beam, rule: Quadrature, counts: Counts, base: Callable[[Counts], Families]) -> Families:
    """Families of `counts` shapes: those of `base`, and static deflections under unit loads at the supports and under
    a rise of the temperature.

    Where the base contains a static deflection already, as polynomials do, it has one shape more instead.
    """
    lacking = list(static_counts(beam, counts))
    if not any(lacking):
        return base(counts)
    rigidities = _numbered(beam).stiffnesses(rule.node)
    statics = {
        family: _static_strains(beam, rule, rigidities, family, counts) for family in range(6) if lacking[family]
    }
    weights = {family: np.sqrt(rigidities[STRAINS[family]] * rule.weight) for family in statics}
    while True:
        plain = base(plus(counts, _negative(lacking)))
        added = {
            family: _new_columns(rule, weights[family], family, plain[family], strains)
            for family, strains in statics.items()
        }
        counted = [len(added.get(family, ())) for family in range(6)]
        if counted == lacking:
            break
        lacking = [min(pair) for pair in zip(counted, lacking, strict=True)]
    families = list(plain)
    for family, chosen in added.items():
        if chosen:
            static = nodal_family(rule, statics[family][:, chosen], beam.length, axial=family not in (1, 2))
            families[family] = joined_family(families[family], static)
    s, v, w, t, a, b = families
    return s, v, w, t, a, b


def _numbered(beam: Beam) -> Beam:
    """A beam itself; where JAX traces it, one by numbers that static deflections bend alike: they follow from how its
    rigidities change along it, and not from their size.
    """
    material, section = beam.material, beam.section
    traced = material is not None and holds_jax(vars(material)), holds_jax(section.dimensions)
    if material is None or not any(traced):
        return beam
    if traced[1] and section.stations:
        fix = "give numbers, or leave supports out"
        raise InputError("supports", "hold a beam whose section changes along it and is traced by JAX", fix)
    metal = Material(1e3, 1e9, poissons_ratio=0.3) if traced[0] else material
    uniform = Section.rectangle(width=beam.length / 50, thickness=beam.length / 100) if traced[1] else section
    return Beam(beam.length, uniform, metal)


def _negative(counts: list[int]) -> Counts:
    """Numbers with the other sign."""
    axial, y, z, twist, shear_y, shear_z = (-count for count in counts)
    return axial, y, z, twist, shear_y, shear_z


def _static_strains(
    beam: Beam, rule: Quadrature, rigidities: tuple[Floats, ...], family: int, counts: Counts
) -> Floats:
    """Strains (g, k) of a family's kind at the nodes, under unit loads at the supports and under a rise of the
    temperature, each that concerns the family. `rigidities` are those of the six strains, (g,) each.
    """
    columns = [
        _unit_strains(beam, rule, rigidities, condition, counts)[STRAINS[family]] * (-1 if family == 2 else 1)
        for condition in (*rigid_conditions(beam), *yielding_conditions(beam))
        if family in families_of(beam, condition, counts)
    ]
    if beam.temperature is not None and family == 0 and not beam.coupled:
        columns.append(np.ones(len(rule.node)))
    return np.stack(columns, axis=1)


def _unit_strains(
    beam: Beam, rule: Quadrature, rigidities: tuple[Floats, ...], condition: Condition, counts: Counts
) -> Floats:
    """Strains (6, g) at the nodes of the beam on its root alone, under a unit load along a condition's direction."""
    place, axes = beam.at_rest(rule.node)
    support_place = beam.at_rest([condition.at])[0][0]
    unit, nothing = np.eye(3)[condition.number % 3], np.zeros(3)
    turns = condition.direction.startswith("r")
    force, couple = (nothing, unit) if turns else (unit, nothing)
    moment = np.cross(support_place - place, force) + couple
    vectors = np.stack([np.broadcast_to(force, place.shape), moment], axis=1)
    carried = np.einsum("gab,gka->gkb", axes, vectors).reshape(len(place), 6)
    carried = np.where(rule.node[:, None] < condition.at, carried, 0.0)
    strains = np.zeros((6, len(place)))
    shaped = sorted({0, 4, 5, *(STRAINS[family] for family in range(6) if counts[family])})
    if beam.material is None:
        stiffness = condensed(beam.section.matrices(rule.node)[0], shaped)
        strains[shaped] = np.linalg.solve(stiffness, carried[:, shaped, None])[..., 0].T
    else:
        for strain in shaped:
            strains[strain] = carried[:, strain] / rigidities[strain]
    return strains


def unit_load(motions: Space, condition: Condition) -> Floats:
    """Generalised forces (n,) on strains of a unit load along a condition's direction."""
    value, angle = motions.sensitivity(np.array([condition.at]))
    components = (angle if condition.direction.startswith("r") else value)[0]
    return np.asarray(components if components.ndim == 1 else components[condition.number % 3])


def concerns(motions: Space, condition: Condition) -> bool:
    """True if a condition concerns motions: those in its direction, or those in all."""
    return motions.loads is not None or condition.family in motions.families


def heat_load(motions: Space) -> Floats:
    """Generalised forces (n,) on strains of a rise of the temperature, of unit strain where nothing holds the beam."""
    forces = 0 * motions.stiffness
    block = motions.block(0)
    forces[block] = motions.stiffness[block]
    return forces


def _new_columns(rule: Quadrature, weight: Floats, family: int, plain: Family, statics: Floats) -> list[int]:
    """Indices of columns of static strains (g, k) that a family's shapes and the columns before do not contain.

    The squares of strains times `weight` (g,) are their energies.
    """
    shapes = plain(rule.node)
    strain = shapes.curvature if family in (1, 2) else shapes.slope
    basis, chosen = np.linalg.qr(weight[:, None] * strain)[0], list[int]()
    for k in range(statics.shape[1]):
        vector = weight * statics[:, k]
        rest = vector - basis @ (basis.T @ vector)
        rest = rest - basis @ (basis.T @ rest)
        if np.linalg.norm(rest) > NEW * np.linalg.norm(vector):
            basis = np.concatenate([basis, rest[:, None] / np.linalg.norm(rest)], axis=1)
            chosen.append(k)
    return chosen


def strain_sizes(beam: Beam, rule: Quadrature, slopes: Floats, angles: Floats) -> Floats:
    """Squared sizes (n,) of unit coordinates by their strains, as energies of a beam that is THICK.

    Of a slender beam bending has so little energy that it would hold the end of a shallow arch along x, which it does
    not move any more as the arch snaps through. `slopes` and `angles` (p, 3, n) are the motions of its points, which
    begin with the nodes of the rule.
    """
    nodes, (_, axes) = len(rule.node), beam.at_rest(rule.node)
    angle = angles[:nodes]
    tangent = np.broadcast_to(axes[:, :, 0, None], angle.shape)
    stretch = np.gradient(slopes[:nodes], rule.node, axis=0) - np.cross(angle, tangent, axis=1)
    bend = THICK * beam.length * np.gradient(angle, rule.node, axis=0)
    return np.asarray(np.einsum("g,gan->n", rule.weight, stretch**2 + bend**2))


def chosen_dependents(conditions: list[Condition], rows: Floats, sizes: Floats, shapes: int) -> tuple[int, ...]:
    """Indices of coordinates that conditions with rows (m, n) make dependent: those that reach farthest for their size.

    `sizes` (n,) are stiffnesses, or those of :func:`strain_sizes`. The first `shapes` of the coordinates are of shapes.
    Raise InputError where a condition says nothing that those before do not say.
    """
    scaled = rows[:, :shapes] / np.sqrt(sizes[:shapes])
    for k, condition in enumerate(conditions):
        basis = np.linalg.qr(scaled[:k].T)[0]
        rest = scaled[k] - basis @ (basis.T @ scaled[k])
        if not scaled[k].any():
            problem = f"holds {condition.direction}, in which the model has no shapes"
            fix = f"give modes.{FAMILIES[condition.family]} = 1 or more, or leave {condition.direction} out"
            raise InputError(f"supports[{condition.support}]", problem, fix)
        if not np.linalg.norm(rest) > ALIKE * np.linalg.norm(scaled[k]):
            problem = f"holds {condition.direction} at {1e3 * condition.at:g} mm, where it is held already"
            fix = f"leave {condition.direction} out, or raise modes.{FAMILIES[condition.family]}"
            raise InputError(f"supports[{condition.support}]", problem, fix)
    scaled, dependents = scaled / np.linalg.norm(scaled, axis=1, keepdims=True), list[int]()
    for _ in conditions:
        chosen = int(np.linalg.norm(scaled, axis=0).argmax())
        direction = scaled[:, chosen] / np.linalg.norm(scaled[:, chosen])
        scaled = scaled - np.outer(direction, direction @ scaled)
        dependents.append(chosen)
    return tuple(sorted(dependents))


def turned(value: Any, basis: Array) -> Any:
    """Matrix of a quadratic form in coordinates p with q = basis p."""
    return basis.T @ value @ basis
