"""Supports of a beam as conditions on its coordinates, and the shapes that show what supports do.

A support that holds a direction rigidly says that a row of derivatives of its place or angle, times the coordinates,
is zero: A q = 0. Coordinates of shapes that depend on the others are left out, q = N p with A N = 0, so that constant
coefficients stay constant. To the shapes come the static deflections under unit loads at each support.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.fields.adapted import Space, space
from gbeam.mechanics.fields.basis import FAMILIES, Counts, Families, Family, Quadrature, joined_family
from gbeam.structure.beam import Beam
from gbeam.structure.supports import DIRECTIONS

FAMILY = {"x": 0, "y": 1, "z": 2, "rx": 3, "ry": 2, "rz": 1}  # that moves or turns sections in a direction
NEW = 1e-3  # of a static shape's length in energy: with less of it than that it is nearly one of the others
ALIKE = 1e-9  # of a condition's length: less of it is nothing that the other conditions do not say


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
    held = beam.held_places.items()
    return [Condition(i, support.place, direction) for i, support in held for direction in support.rigid]


def yielding_conditions(beam: Beam) -> list[Condition]:
    """Directions in which springs and dampers hold a beam beyond its root."""
    held = beam.held_places.items()
    return [Condition(i, support.place, direction) for i, support in held for direction in support.yielding]


def counts_by_family(conditions: list[Condition]) -> Counts:
    """Numbers of conditions on each family of shapes."""
    axial, y, z, twist, shear_y, shear_z = (sum(each.family == k for each in conditions) for k in range(6))
    return axial, y, z, twist, shear_y, shear_z


def static_counts(beam: Beam) -> Counts:
    """Numbers of static shapes, by family, that no condition takes: of springs and dampers, and of the temperature."""
    heated = int(beam.temperature is not None and not beam.coupled)
    return plus(counts_by_family(yielding_conditions(beam)), (heated, 0, 0, 0, 0, 0))


def counts_without(counts: Counts, taken: tuple[int, ...]) -> Counts:
    """Numbers of shapes without those whose indices are taken."""
    family = np.repeat(np.arange(6), counts)
    left = np.delete(family, [index for index in taken if index < len(family)])
    axial, y, z, twist, shear_y, shear_z = (int((left == k).sum()) for k in range(6))
    return axial, y, z, twist, shear_y, shear_z


def plus(counts: Counts, more: Counts) -> Counts:
    """Sums of numbers of shapes by family."""
    axial, y, z, twist, shear_y, shear_z = (a + b for a, b in zip(counts, more, strict=True))
    return axial, y, z, twist, shear_y, shear_z


def refuse_stretched(beam: Beam, kind: str) -> None:
    """Raise InputError where supports hold a beam whose directions are coupled, or a model that does not know them."""
    if beam.held_places and beam.coupled:
        fix = "leave supports out, or give the beam as a mesh, [solid]"
        raise InputError("supports", "hold a beam that its line or its matrices couple: not computed yet", fix)
    for condition in (*rigid_conditions(beam), *yielding_conditions(beam)):
        where, fix = f"supports[{condition.support}]", 'choose model.kind = "exact", with modes.axial = 1 or more'
        if kind == "fourth-order":
            raise InputError(where, "is not known to fourth-order models", fix)


def refuse_shapeless(beam: Beam, counts: Counts) -> None:
    """Raise InputError where a support holds a direction along which a model has no shapes."""
    for condition in (*rigid_conditions(beam), *yielding_conditions(beam)):
        name = FAMILIES[condition.family]
        if not counts[condition.family]:
            where = f"supports[{condition.support}]"
            problem = f"holds {condition.direction}, in which the model has no shapes"
            raise InputError(where, problem, f"give modes.{name} = 1 or more, or leave {condition.direction} out")


def supported_shapes(beam: Beam, rule: Quadrature, counts: Counts, base: Callable[[Counts], Families]) -> Families:
    """Families of `counts` shapes: those of `base`, and static deflections under unit loads at the supports and under
    a rise of the temperature.

    Where the base contains a static deflection already, as polynomials do, it has one shape more instead.
    """
    conditions = [*rigid_conditions(beam), *yielding_conditions(beam)]
    lacking = list(plus(counts_by_family(rigid_conditions(beam)), static_counts(beam)))
    statics: dict[int, Floats] = {}
    spaces: dict[int, Space] = {}
    for family, number in enumerate(lacking):
        if number:
            spaces[family] = space(beam, rule, family, counts)
            loads = [unit_load(spaces[family], condition) for condition in conditions if condition.family == family]
            if len(loads) < number:
                loads.append(heat_load(spaces[family]))
            statics[family] = np.stack(loads, axis=1) / spaces[family].stiffness[:, None]
    while True:
        plain = base(plus(counts, _negative(lacking)))
        new = {family: _new(spaces[family], family, plain[family], each) for family, each in statics.items()}
        counted = [len(new.get(family, ())) for family in range(6)]
        if counted == lacking:
            break
        lacking = [min(pair) for pair in zip(counted, lacking, strict=True)]
    families = list(plain)
    for family, chosen in new.items():
        if chosen:
            static = spaces[family].family(family, statics[family][:, chosen])
            families[family] = joined_family(families[family], static)
    s, v, w, t, a, b = families
    return s, v, w, t, a, b


def _negative(counts: list[int]) -> Counts:
    """Numbers with the other sign."""
    axial, y, z, twist, shear_y, shear_z = (-count for count in counts)
    return axial, y, z, twist, shear_y, shear_z


def unit_load(motions: Space, condition: Condition) -> Floats:
    """Generalised forces (n,) on strains of a unit load along a condition's direction."""
    value, angle = motions.sensitivity(np.array([condition.at]))
    return np.asarray(angle[0] if condition.direction.startswith("r") else value[0])


def heat_load(motions: Space) -> Floats:
    """Generalised forces (n,) on strains of a rise of the temperature, of unit strain where nothing holds the beam."""
    forces = 0 * motions.stiffness
    block = motions.block(0)
    forces[block] = motions.stiffness[block]
    return forces


def _new(motions: Space, family: int, plain: Family, statics: Floats) -> list[int]:
    """Indices of columns of static strains (n, k) that a family's shapes and the columns before do not contain."""
    shapes, size = plain(motions.rule.node), len(motions.stiffness)
    strain = shapes.curvature if family in (1, 2) else shapes.slope
    block = motions.block(family)
    columns = np.zeros((size, strain.shape[1]))
    columns[block] = strain
    known, new = np.linalg.qr(motions.scaled(columns))[0], list[int]()
    for k in range(statics.shape[1]):
        part = np.zeros((size, 1))
        part[block, 0] = statics[block, k]
        vector = motions.scaled(part)[:, 0]
        rest = vector - known @ (known.T @ vector)
        rest = rest - known @ (known.T @ rest)
        if np.linalg.norm(rest) > NEW * np.linalg.norm(vector):
            known = np.concatenate([known, rest[:, None] / np.linalg.norm(rest)], axis=1)
            new.append(k)
    return new


def chosen_dependents(conditions: list[Condition], rows: Floats, sizes: Floats, shapes: int) -> tuple[int, ...]:
    """Indices of coordinates that conditions with rows (m, n) make dependent: those that reach farthest by unit energy.

    `sizes` (n,) are the coordinates' stiffnesses; the first `shapes` of them are of shapes. Raise InputError where a
    condition says nothing that those before do not say.
    """
    scaled = rows[:, :shapes] / np.sqrt(sizes[:shapes])
    for k, condition in enumerate(conditions):
        before = np.linalg.qr(scaled[:k].T)[0]
        rest = scaled[k] - before @ (before.T @ scaled[k])
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
