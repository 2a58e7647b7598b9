"""A beam with more shapes: those that a model's own leave out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import Array
from gbeam.arrays.types import Floats
from gbeam.mechanics.assembly import assembled, breaks_of, families_of
from gbeam.mechanics.beam_terms import particles_of, stiffness_of
from gbeam.mechanics.fields.adapted import GROUPS, Space, spaces_of, springs_for_shapes
from gbeam.mechanics.fields.basis import Counts, Families, Family, Quadrature, Shapes, joined_family, quadrature
from gbeam.mechanics.fields.strains import STRAINS, strain_field
from gbeam.mechanics.models import MODEL_KINDS
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.supports import concerns, heat_load, rigid_conditions, unit_load, yielding_conditions
from gbeam.results.parts import Base
from gbeam.structure.beam import Beam

LEVELS = (2, 3, 3, 2)  # of the sequence, along x, y, z, and about x
APART = 3e-6  # of the longest period: the square of a frequency farther off takes the digits of the lowest
NEW = 1e-6  # of a vector's length: less of it is nothing that the others have not
TENSION = 1.0  # N L²/EI: from there on the axial force bends the shapes


def axial_force(beam: Beam, rule: Quadrature, along: Array, spin: Array) -> Array:
    """Axial force (g,), N, at the nodes, at the time when it is largest at the root.

    `along` (t,), m/s², is the root's acceleration along the beam; `spin` (t,), rad²/s², the squared angular rate across
    it.
    """
    line_mass = beam.density * beam.section.at(rule.node).area
    inboard = rule.cumulative(rule.node)
    # Mass and first moment of mass outboard of each node.
    mass = rule.weight @ line_mass - inboard @ line_mass
    moment = rule.weight @ (line_mass * rule.node) - inboard @ (line_mass * rule.node)
    for body in beam.masses:
        outboard = rule.node < body.at
        mass, moment = mass + body.mass * outboard, moment + body.mass * body.at * outboard
    largest = int(np.argmax(np.abs(spin * moment[0] - along * mass[0])))
    return np.asarray(spin[largest] * moment - along[largest] * mass)


def enriched_shapes(
    beam: Beam, spaces: Sequence[Space], families: Families, force: Array | None = None
) -> tuple[Families, Counts]:
    """Add the shapes that the families lack, and count them by family.

    The lacking shapes are static answers to loads that the shapes do not contain, also under an axial force (g,), N.
    """
    threshold = APART**2 * max(_period(beam, space, direction) for direction, space in enumerate(spaces))
    enriched, counts = list(families), [0] * 6
    for direction, space in enumerate(spaces):
        for family, added in _lacking(beam, space, families, direction, force, threshold).items():
            enriched[family] = joined_family(families[family], added)
            counts[family] = added(space.rule.node).value.shape[1]
    (s, v, w, t, a, b), (axial, y, z, twist, shear_y, shear_z) = enriched, counts
    return (s, v, w, t, a, b), (axial, y, z, twist, shear_y, shear_z)


def _lacking(
    beam: Beam, space: Space, families: Families, direction: int, force: Array | None, least: float
) -> dict[int, Family]:
    """Shapes, by family, that a space's families lack: parts of static answers and of Krylov's sequence from them.
    `least` is the square of a period, over 4π², below which a vibration would take the digits of the others.
    """
    nodes, size = len(space.rule.node), len(space.stiffness)
    sprung = nodes * len(space.families)
    # The root's motion has coordinates of its own.
    columns = [np.eye(size)[:, sprung:]]
    for family in space.families:
        shapes = families[family](space.rule.node)
        strain = shapes.curvature if family in (1, 2) else shapes.slope
        columns.append(np.zeros((size, strain.shape[1])))
        columns[-1][space.block(family)] = strain
    basis = np.linalg.qr(space.scaled(np.concatenate(columns, axis=1)))[0]

    def shortest(vectors: Array) -> float:
        """Square of the shortest period, over 4π², of vectors that are orthonormal in energy."""
        if not vectors.size:
            return np.inf
        strains = space.scaled(vectors, back=True)
        return float(np.linalg.eigvalsh(strains.T @ space.mass @ strains)[0])

    least = min(least, shortest(basis) / 10)
    loads = _loads(beam, space, direction)
    added: dict[int, list[Array]] = {family: [] for family in space.families}
    for flexibility in _flexibilities(beam, space, force):
        vectors = flexibility @ loads
        for _ in range(LEVELS[direction]):
            for vector, scaled in zip(vectors.T, space.scaled(vectors).T, strict=True):
                length = np.linalg.norm(scaled)
                for family in space.families:
                    part = np.zeros((size, 1))
                    part[space.block(family), 0] = vector[space.block(family)]
                    rest = space.scaled(part)[:, 0]
                    rest = rest - basis @ (basis.T @ rest)
                    rest = rest - basis @ (basis.T @ rest)
                    if not np.linalg.norm(rest) > NEW * length:
                        continue
                    rest = rest / np.linalg.norm(rest)
                    wider = np.concatenate([basis, rest[:, None]], axis=1)
                    # Beside a spring of the root a bend close to it turns the beam likewise: what is left has no
                    # inertia.
                    if shortest(wider) > least:
                        basis = wider
                        added[family].append(rest)
            vectors = flexibility @ (space.mass @ vectors)
    return {
        family: space.family(family, space.scaled(np.stack(shape, axis=1), back=True))
        for family, shape in added.items()
        if shape
    }


def _period(beam: Beam, space: Space, direction: int) -> float:
    """Square of the longest period, over 4π², by the answer to an even acceleration."""
    force = _loads(beam, space, direction)[:, 0]
    answer = _flexibility(space) @ force
    return float(answer @ space.mass @ answer / (answer @ force))


def _flexibilities(beam: Beam, space: Space, force: Array | None) -> list[Array]:
    """Inverse of the stiffness and, if an axial force (g,), N, matters and does not buckle the beam, that with it; both
    under the beam's supports.
    """
    unloaded = _flexibility(space)
    if beam.held_places:
        unloaded = _held_flexibility(beam, space, np.zeros_like(space.mass))
    if force is None or not bends(space, force):
        return [unloaded]
    _, slope = space.sensitivity(space.rule.node)
    added = slope.T @ ((space.rule.weight * force)[:, None] * slope)
    stiffness = np.diag(space.stiffness) + added
    if np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(space.stiffness, space.stiffness)))[0] <= 0:
        return [unloaded]
    loaded = _held_flexibility(beam, space, added) if beam.held_places else np.asarray(np.linalg.inv(stiffness))
    return [unloaded, loaded]


def _held_flexibility(beam: Beam, space: Space, added: Array) -> Array:
    """Displacements (n, n) by unit forces under the beam's supports, with a stiffness (n, n) that is `added`."""
    size = np.sqrt(space.stiffness)
    true = space.stiffness.copy()
    true[list(space.loose)] = 0.0
    elastic = np.diag(true) if space.upper is None else space.upper.T @ space.upper
    stiffness = (elastic + added) / np.outer(size, size)
    for condition in yielding_conditions(beam):
        if concerns(space, condition):
            row = unit_load(space, condition) / size
            stiffness_of_support: Any = beam.supports[condition.support].stiffness
            spring = stiffness_of_support.get(condition.direction, 0.0)
            stiffness = stiffness + spring * np.outer(row, row)
    rigid = (condition for condition in rigid_conditions(beam) if concerns(space, condition))
    rows = [unit_load(space, condition) / size for condition in rigid]
    free = np.eye(len(size))
    if rows:
        free = np.linalg.svd(np.stack(rows))[2][len(rows) :].T
    flexible = free @ np.linalg.solve(free.T @ stiffness @ free, free.T)
    return np.asarray(flexible / np.outer(size, size))


def _flexibility(space: Space) -> Array:
    """Inverse (n, n) of the stiffness."""
    if space.upper is None:
        return np.diag(1 / space.stiffness)
    inverse = np.linalg.inv(space.upper)
    return np.asarray(inverse @ inverse.T)


def bends(space: Space, force: Array) -> bool:
    """True if the space has curvatures and an axial force (g,) N is large enough to change them."""
    size = np.abs(force).max() * space.length**2 / np.min(space.stiffness[: len(force)] / space.rule.weight)
    return space.bends and bool(size >= TENSION)


def coupled_space(beam: Beam, rule: Quadrature, counts: Counts) -> Space:
    """Space of all motions of a beam whose line, or section by matrices, couples the directions."""
    families = tuple(family for family in range(6) if family < 3 or counts[family])
    nodes, springs = len(rule.node), [*springs_for_shapes(beam).values()]
    strained = len(families) * nodes
    strains = np.zeros((6, nodes, strained + len(springs)))
    for k, family in enumerate(families):
        strains[STRAINS[family], :, k * nodes : (k + 1) * nodes] = np.eye(nodes) * (-1 if family == 2 else 1)
    move, turn = (np.pad(by_springs, ((0, 0), (strained, 0))) for by_springs in beam.root.directions())
    loaded = [load.place for load in beam.loads if load.at is not None]
    support_places = [support.place for support in beam.held_places.values()]
    x = np.concatenate([rule.node, [body.at for body in beam.masses], loaded, support_places])
    field = strain_field(rule, x, strains, move, turn, beam.line)
    positions, mass, offset = particles_of(beam, rule, rotary=beam.rotary_inertia)
    particles, rest = field.points(positions, offset), np.zeros(field.size)
    place, moved = particles.positions(rest), particles.slopes(rest)
    axes = np.eye(3)
    pulls = [np.broadcast_to(axis, place.shape) for axis in axes] + [np.cross(axis, place) for axis in axes]
    loads = [np.einsum("p,pai,pa->i", mass, moved, pull) for pull in pulls]  # of accelerations, along and about axes
    slopes, angles = field.jacobians(rest)
    first = len(rule.node) + len(beam.masses)
    for load in beam.loads:
        if load.at is None:
            points, weight = slice(0, nodes), rule.weight
        else:
            points, weight = slice(first, first + 1), np.ones(1)
            first += 1
        loads += [
            weight @ part[points, axis]
            for part, component in zip((slopes, angles), load.acting, strict=True)
            if component is not None
            for axis in range(3)
        ]
    for condition in (*rigid_conditions(beam), *yielding_conditions(beam)):
        part = angles if condition.direction.startswith("r") else slopes
        loads.append(part[-len(support_places) :][support_places.index(condition.at), condition.number % 3])

    def sensitivity(places: Floats) -> tuple[Floats, Floats]:
        """Displacements and angles (points, 3, n) at the nodes, or at places of supports."""
        if len(places) == 1 and places[0] in support_places:
            k = len(x) - len(support_places) + support_places.index(places[0])
            return slopes[k : k + 1], angles[k : k + 1]
        return slopes[:nodes], angles[:nodes]

    stiffnesses = beam.stiffnesses(rule.node)
    stiffness = [*(stiffnesses[STRAINS[family]] * rule.weight for family in families), springs]
    energy = stiffness_of(beam, rule, strains) if beam.material is None else None
    return Space(
        rule=rule,
        length=beam.length,
        families=families,
        line=mass[:nodes],
        turning=0 * mass[:nodes],
        mass=np.einsum("p,pai,paj->ij", mass, moved, moved),
        stiffness=np.concatenate(stiffness),
        sensitivity=sensitivity,
        loads=np.stack(loads, axis=1),
        upper=None if energy is None else np.linalg.cholesky(energy).T,
    )


def _loads(beam: Beam, space: Space, direction: int) -> Array:
    """Generalised forces (n, k): of uniform and of linearly growing accelerations, of turning bodies, and of loads."""
    if space.loads is not None:
        return space.loads
    x = space.rule.node
    value, slope = space.sensitivity(x)
    uniform = space.line @ value + space.turning @ slope
    growing = (space.line * x) @ value + (space.turning * x) @ slope
    columns = []
    for body in beam.masses:
        displacement, angle = space.sensitivity(np.array([body.at]))
        uniform, growing = uniform + body.mass * displacement[0], growing + body.mass * body.at * displacement[0]
        if direction and (any(body.offset) or any(body.inertia)):
            columns.append(angle[0])
    for condition in (*rigid_conditions(beam), *yielding_conditions(beam)):
        if condition.family in space.families:
            columns.append(unit_load(space, condition))
    if beam.temperature is not None and 0 in space.families:
        columns.append(heat_load(space))
    for load in beam.loads:
        displacement, angle = (value, slope) if load.at is None else space.sensitivity(np.array([load.at]))
        weight = space.rule.weight if load.at is None else np.ones(1)
        for part, component in zip((displacement, angle), load.acting, strict=True):  # by force and by moment
            if component is not None:
                columns.append(weight @ part)
    return np.stack([uniform, growing, *columns], axis=1)


NODES, PER_PANEL = 14, 8  # of the quadrature: over the beam with one shape, and in a panel at least


class Twin(NamedTuple):
    """The :class:`Enrichment` of a structure that comes with its `richer` one, of a mesh or matrices."""

    structure: Structure

    def model(
        self, kind: str, *, directions: tuple[bool, bool, bool] = (True, True, True)
    ) -> tuple[Structure, NDArray[np.int_]]:
        """The richer structure, or its exact model, and the indices of the structure's own coordinates in it."""
        richer = self.structure.richer
        assert richer is not None
        return richer.bent if kind == "exact" else richer, np.arange(self.structure.size)


def enrichment(structure: Structure, base: Base | None = None) -> Enrichment | Twin:
    """Return a structure's own shapes with those that it lacks; a richer structure that is given takes their place.

    Where the motion of the `base` (t, 3) makes an axial force that changes the shapes, they are found under it.
    """
    if structure.richer is not None:
        return Twin(structure)
    unloaded = _unloaded_enrichment(structure)
    force = None if base is None else unloaded.bending_force(base)
    return unloaded if force is None else Enrichment(structure, force)


@lru_cache(maxsize=4)  # keyed by values: runs of equal structures look for what they lack once
def _unloaded_enrichment(structure: Structure) -> Enrichment:
    """Enrichment of a structure without axial force."""
    return Enrichment(structure)


class Enrichment:
    """A structure's own shapes and those that it lacks under an axial force (g,) N, for models with all of them."""

    def __init__(self, structure: Structure, force: Array | None = None) -> None:
        """Find the shapes that the structure lacks, also under an axial `force` (g,), N."""
        assert structure.source is not None
        self.structure, beam = structure, structure.source.beam
        counts = structure.source.counts
        marks = [m.at for m in beam.masses] + [load.place for load in beam.loads if load.at is not None]
        breaks = [*breaks_of(beam), *marks]
        panels = len(quadrature(beam.length, 1, breaks).edges) - 1
        self.rule = quadrature(beam.length, max(PER_PANEL, -(-(NODES + 2 * max(counts)) // panels)), breaks)
        coupled = (coupled_space(beam, self.rule, counts),) if beam.coupled else None
        self.spaces = coupled or spaces_of(beam, self.rule, counts)
        self.families, self.new = enriched_shapes(beam, self.spaces, own_families(structure, beam, self.rule), force)
        self.beam = beam
        self._made: dict[Any, tuple[Structure, NDArray[np.int_]]] = {}

    def bending_force(self, base: Base) -> Array | None:
        """Axial force (g,) N that a motion of the base brings, where it is large enough to change the shapes."""
        along, spin = np.asarray(base.a_WO_B)[..., 0], (np.asarray(base.w_WB_B)[..., 1:] ** 2).sum(axis=-1)
        force = axial_force(self.beam, self.rule, np.atleast_1d(along), np.atleast_1d(spin))
        return force if any(bends(space, force) for space in self.spaces) else None

    def model(
        self, kind: str, *, directions: tuple[bool, bool, bool] = (True, True, True)
    ) -> tuple[Structure, NDArray[np.int_]]:
        """Return a model with new shapes along some of x, y and z, and in it the indices of the structure's own."""
        key = kind, directions
        if key not in self._made:
            self._made[key] = self._model(kind, directions)
        return self._made[key]

    def _model(self, kind: str, directions: tuple[bool, bool, bool]) -> tuple[Structure, NDArray[np.int_]]:
        """Build the model and indices of :meth:`model`, with new shapes of families that move along `directions`."""
        source = self.structure.source
        assert source is not None
        model_counts = source.counts
        wanted = [False] * 6
        for group, is_enriched in zip(GROUPS, (*directions, True), strict=True):
            for family in group:
                wanted[family] = is_enriched
        axial, *other_counts = (
            count + new_count if is_wanted else count
            for count, new_count, is_wanted in zip(model_counts, self.new, wanted, strict=True)
        )
        counts: Any = (axial if MODEL_KINDS[kind].axial else 0, *other_counts)
        families: Any = tuple(_truncated(family, count) for family, count in zip(self.families, counts, strict=True))
        ratio = self.beam.damping_ratio
        springs = len(self.beam.root.springs)
        if isinstance(ratio, tuple):  # new modes have the last ratio
            dependent_count = len(() if self.structure.grip is None else self.structure.grip.dependents)
            ratio = (*ratio, *[ratio[-1]] * (sum(counts) + springs - dependent_count - len(ratio)))
        beam = replace(self.beam, damping_ratio=ratio)
        stations = np.asarray(self.structure.stations)
        starts = np.cumsum([0, *counts])
        index = np.concatenate(
            [
                *(np.arange(n) + start for n, start in zip(model_counts, starts, strict=False)),
                np.arange(springs) + starts[-1],
            ]
        )
        index = index.astype(int)
        grip = self.structure.grip
        if grip is None:
            return assembled(beam, kind, counts, self.rule, stations, families, source.shapes), index
        dependents = index[list(grip.dependents)]
        rich = assembled(
            beam, kind, counts, self.rule, stations, families, source.shapes, dependents=tuple(dependents.tolist())
        )
        free_index = np.delete(index, grip.dependents)
        return rich, free_index - (dependents < free_index[:, None]).sum(axis=1)


def own_families(structure: Structure, beam: Beam, rule: Quadrature) -> Families:
    """Functions of the structure's own shapes, with those that depend on others where supports hold it."""
    assert structure.source is not None
    source = structure.source
    return families_of(beam, structure.kind, source.counts, rule, source.shapes)


def _truncated(family: Family, count: int) -> Family:
    """Family of the first `count` shapes of another."""

    def first_shapes(x: Array) -> Shapes:
        return Shapes(*(part[:, :count] for part in family(x)))

    return first_shapes
