"""A beam with more shapes: those that a model's own leave out."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.assembly import assembled
from gbeam.mechanics.fields.adapted import Space, adapted_shapes, space
from gbeam.mechanics.fields.basis import (
    Array,
    Families,
    Family,
    Quadrature,
    Shapes,
    closed_forms,
    polynomials,
    quadrature,
)
from gbeam.mechanics.models import KINDS
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.structure.beam import Beam

LEVELS = (2, 3, 3)  # of the sequence, along x, y, z
APART = 3e-6  # of the longest period: the square of a frequency farther off takes the digits of the lowest
NEW = 1e-6  # of a vector's length: less of it is nothing that the others have not
TENSION = 1.0  # N L²/EI: from there on the axial force bends the shapes
Spaces = tuple[Space, Space, Space]


def axial_force(beam: Beam, rule: Quadrature, along: Array, spin: Array) -> Array:
    """Axial force (g,) N at the nodes when largest, under root accelerations (t,) m/s² along and squared rates (t,)
    across the beam.
    """
    line = beam.material.density * beam.section.at(rule.node).area
    until = rule.cumulative(rule.node)
    mass, moment = (rule.weight @ f - until @ f for f in (line, line * rule.node))
    for body in beam.masses:
        outboard = rule.node < body.at
        mass, moment = mass + body.mass * outboard, moment + body.mass * body.at * outboard
    k = int(np.argmax(np.abs(spin * moment[0] - along * mass[0])))
    return np.asarray(spin[k] * moment - along[k] * mass)


def enriched_shapes(
    beam: Beam, spaces: Spaces, own: Families, force: Array | None = None
) -> tuple[Families, tuple[int, int, int]]:
    """The given shapes and then those that they lack, also under an axial force (g,) N, and how many are new in each
    direction.
    """
    least = APART**2 * max(_period(beam, of, along) for along, of in enumerate(spaces))
    enriched = [_enriched(beam, spaces[along], own[along], along, force, least) for along in range(3)]
    (s, a), (v, b), (w, c) = enriched
    return (s, v, w), (a, b, c)


def _enriched(
    beam: Beam, of: Space, family: Family, along: int, force: Array | None, least: float
) -> tuple[Family, int]:
    nodes = len(of.rule.node)
    nodal = family(of.rule.node)
    strain = nodal.slope if of.axial else nodal.curvature
    size, count = len(of.stiffness), strain.shape[1]
    # The root's motion has coordinates of its own.
    basis = np.concatenate([np.eye(size)[:, nodes:], np.pad(strain, ((0, size - nodes), (0, 0)))], axis=1)
    root = np.sqrt(of.stiffness)[:, None]
    known = np.linalg.qr(root * basis)[0]

    def shortest(vectors: Array) -> float:
        """Square of the shortest period, over 4π², of vectors that are orthonormal in energy."""
        return float(np.linalg.eigvalsh((vectors / root).T @ of.mass @ (vectors / root))[0]) if vectors.size else np.inf

    least = min(least, shortest(known) / 10)
    loads, added = _loads(beam, of, along), []
    for flexibility in _flexibilities(of, force):
        vectors = flexibility @ loads
        for _ in range(LEVELS[along]):
            for vector in (root * vectors).T:
                length = np.linalg.norm(vector)
                rest = vector - known @ (known.T @ vector)
                rest = rest - known @ (known.T @ rest)
                if not np.linalg.norm(rest) > NEW * length:
                    continue
                rest = rest / np.linalg.norm(rest)
                wider = np.concatenate([known, rest[:, None]], axis=1)
                # Beside a spring of the root a bend close to it turns the beam likewise: what is left has no inertia.
                if shortest(wider) > least:
                    known = wider
                    added.append(rest)
            vectors = flexibility @ (of.mass @ vectors)
    more = of.family(np.stack(added, axis=1) / root) if added else None

    def both(x: Array) -> Shapes:
        if more is None:
            return family(x)
        return Shapes(*(np.concatenate(pair, axis=1) for pair in zip(family(x), more(x), strict=True)))

    return (family if count == 0 and more is None else both), len(added)


def _period(beam: Beam, of: Space, along: int) -> float:
    """Square of the longest period, over 4π², by the answer to an even acceleration."""
    force = _loads(beam, of, along)[:, 0]
    answer = force / of.stiffness
    return float(answer @ of.mass @ answer / (answer @ force))


def _flexibilities(of: Space, force: Array | None) -> list[Array]:
    """The inverse of the stiffness, and of that with what an axial force adds where that matters."""
    alone = np.diag(1 / of.stiffness)
    if force is None or not bends(of, force):
        return [alone]
    _, slope = of.sensitivity(of.rule.node)
    stiffness = np.diag(of.stiffness) + slope.T @ ((of.rule.weight * force)[:, None] * slope)
    if np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(of.stiffness, of.stiffness)))[0] <= 0:
        return [alone]
    return [alone, np.asarray(np.linalg.inv(stiffness))]


def bends(of: Space, force: Array) -> bool:
    """Whether an axial force (g,) is large enough beside the stiffness to change the shapes."""
    size = np.abs(force).max() * of.length**2 / np.min(of.stiffness[: len(force)] / of.rule.weight)
    return not of.axial and bool(size >= TENSION)


def _loads(beam: Beam, of: Space, along: int) -> Array:
    """Generalised forces (n, k) of what loads the beam: accelerations, even and growing along it, and its loads."""
    x, line = of.rule.node, beam.material.density * beam.section.at(of.rule.node).area * of.rule.weight
    value, slope = of.sensitivity(x)
    uniform, growing = line @ value, (line * x) @ value
    columns = []
    for body in beam.masses:
        moved, turned = of.sensitivity(np.array([body.at]))
        uniform, growing = uniform + body.mass * moved[0], growing + body.mass * body.at * moved[0]
        if along and (any(body.offset) or any(body.inertia)):
            columns.append(turned[0])
    for load in beam.loads:
        moved, turned = (value, slope) if load.at is None else of.sensitivity(np.array([load.at]))
        weight = of.rule.weight if load.at is None else np.ones(1)
        columns += [
            weight @ part for part, component in ((moved, load.force), (turned, load.moment)) if component is not None
        ]
    return np.stack([uniform, growing, *columns], axis=1)


NODES, PER_PANEL = 14, 8  # of the quadrature: over the beam with one shape, and in a panel at least


def enrichment(structure: Structure, base: Base | None = None) -> Enrichment:
    """Find a structure's own shapes and those that it lacks under what the base, at one time or many, pulls along the
    beam.
    """
    alone = _alone(structure)
    force = None if base is None else alone.bent_by(base)
    return alone if force is None else Enrichment(structure, force)


@lru_cache(maxsize=4)  # keyed by values: runs of equal structures look for what they lack once
def _alone(structure: Structure) -> Enrichment:
    return Enrichment(structure)


class Enrichment:
    """A structure's own shapes and those that it lacks under an axial force (g,) N, from which models with all are
    made.
    """

    def __init__(self, structure: Structure, force: Array | None = None) -> None:
        assert structure.source is not None
        self.structure, beam = structure, structure.source.beam
        counts = structure.counts
        marks = [m.at for m in beam.masses] + [load.at for load in beam.loads if load.at is not None]
        breaks = [*beam.section.stations, *marks]
        panels = len(quadrature(beam.length, 1, breaks).edges) - 1
        self.rule = quadrature(beam.length, max(PER_PANEL, -(-(NODES + 2 * max(counts)) // panels)), breaks)
        self.spaces = space(beam, self.rule, 0), space(beam, self.rule, 1), space(beam, self.rule, 2)
        self.families, self.new = enriched_shapes(beam, self.spaces, own_families(structure, beam, self.rule), force)
        self.beam = beam
        self._made: dict[Any, tuple[Structure, NDArray[np.int_]]] = {}

    def bent_by(self, base: Base) -> Array | None:
        """Axial force (g,) N that a motion of the base brings, where it is large enough to change the shapes."""
        along, spin = np.asarray(base.a_WO_B)[..., 0], (np.asarray(base.w_WB_B)[..., 1:] ** 2).sum(axis=-1)
        force = axial_force(self.beam, self.rule, np.atleast_1d(along), np.atleast_1d(spin))
        return force if any(bends(each, force) for each in self.spaces) else None

    def model(
        self, kind: str, *, directions: tuple[bool, bool, bool] = (True, True, True)
    ) -> tuple[Structure, NDArray[np.int_]]:
        """Make a model with new shapes along some of x, y, z, and say which coordinates are the structure's own."""
        key = kind, directions
        if key not in self._made:
            self._made[key] = self._model(kind, directions)
        return self._made[key]

    def _model(self, kind: str, directions: tuple[bool, bool, bool]) -> tuple[Structure, NDArray[np.int_]]:
        model_counts = self.structure.counts
        counts = [
            n + (more if wanted else 0) for n, more, wanted in zip(model_counts, self.new, directions, strict=True)
        ]
        if not KINDS[kind].axial:
            counts[0] = 0
        s, v, w = (_first(family, count) for family, count in zip(self.families, counts, strict=True))
        ratio = self.beam.damping_ratio
        springs = len(self.beam.root.springs)
        if isinstance(ratio, tuple):
            ratio = (*ratio, *[ratio[-1]] * (sum(counts) + springs - len(ratio)))
        beam = replace(self.beam, damping_ratio=ratio)
        at = np.asarray(self.structure.stations)
        shapes = self.structure.source.shapes  # type: ignore[union-attr]
        rich = assembled(beam, kind, (counts[0], counts[1], counts[2]), self.rule, at, (s, v, w), shapes)
        starts = np.cumsum([0, *counts])
        index = np.concatenate(
            [
                *(np.arange(n) + start for n, start in zip(model_counts, starts, strict=False)),
                np.arange(springs) + starts[-1],
            ]
        )
        return rich, index.astype(int)


def own_families(structure: Structure, beam: Beam, rule: Quadrature) -> Families:
    """The functions that the structure's shapes are."""
    if structure.source is not None and structure.source.shapes == "adapted":
        return adapted_shapes(beam, rule, structure.counts)
    forms = polynomials if KINDS[structure.kind].exact else closed_forms
    return forms(beam.length, structure.counts)


def _first(family: Family, count: int) -> Family:
    def some(x: Array) -> Shapes:
        return Shapes(*(part[:, :count] for part in family(x)))

    return some
