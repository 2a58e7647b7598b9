"""The same beam with more shapes: what a model's own shapes leave out."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.assembly import assembled
from gbeam.mechanics.fields.adapted import adapted_shapes, space
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
from gbeam.mechanics.fields.enriched import axial_force, bends, enriched_shapes
from gbeam.mechanics.models import KINDS
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.structure.beam import Beam

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
        own = structure.counts
        marks = [m.at for m in beam.masses] + [load.at for load in beam.loads if load.at is not None]
        breaks = [*beam.section.stations, *marks]
        panels = len(quadrature(beam.length, 1, breaks).edges) - 1
        self.rule = quadrature(beam.length, max(PER_PANEL, -(-(NODES + 2 * max(own)) // panels)), breaks)
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
        own = self.structure.counts
        counts = [n + (more if wanted else 0) for n, more, wanted in zip(own, self.new, directions, strict=True)]
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
            [*(np.arange(n) + start for n, start in zip(own, starts, strict=False)), np.arange(springs) + starts[-1]]
        )
        return replace(rich, compiled=False), index.astype(int)


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
