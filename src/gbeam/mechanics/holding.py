"""Supports on many unknowns, as of a mesh or of matrices: exact conditions, springs, and what supports take up.

Conditions C u = 0 are left out once, u = N z. Let what is held move by w, while all else follows statically. The
reaction along w is wᵀ(M ü - f), since the elastic forces do no work along it. Modes that a reduction leaves out, which
move no support, are in the reaction by their inertia.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.constants import Direction
from gbeam.errors import InputError
from gbeam.guards.checks import choice
from gbeam.mechanics.equations.linear import damping_matrix
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.structure import Grip, Structure
from gbeam.numerics.conditions import free_motions, least_motions
from gbeam.structure.supports import DIRECTIONS, Support

NOTHING = 1e-9  # of the largest: a force or moment that a place does not take up


class Held(NamedTuple):
    """A place that a support holds, at `centre` (3,) m.

    Of each direction it has sparse rows (g, u) of its nodes' motions, and levers (g, 6), the force and moment about the
    centre of a unit along each. It moves by sparse rows `moved` (3, u).
    """

    support: Support
    centre: Floats
    motions: Mapping[Direction, tuple[Any, Floats]]
    moved: Any


class Holding:
    """Conditions and springs of supports on u unknowns.

    `basis` (u, f), sparse, are the motions that are left. `stiffness` and `damping` (u, u), sparse, are those of
    springs and dampers. `yielding` (j, u) are unit loads of these, by the force or moment that they make. `lifted`
    (u, s) are motions of what is held rigidly, one for each force or moment that it takes up.
    """

    def __init__(self, places: Sequence[Held], unknowns: int) -> None:
        """Tell apart what the places hold rigidly and by springs. InputError if one holds nothing that is not held."""
        from scipy.sparse import csr_array, diags_array, vstack

        self.places = places
        empty = csr_array((0, unknowns))
        rigid = [(k, way, *held.motions[way]) for k, held in enumerate(places) for way in held.support.rigid]
        rows = vstack([empty, *(motion for _, _, motion, _ in rigid)], format="csr")
        self.basis, is_new = free_motions(rows)
        ends = np.cumsum([0, *(len(levers) for *_, levers in rigid)])
        told = [is_new[start:end] for start, end in pairwise(ends)]
        for (k, way, motion, _), told_here in zip(rigid, told, strict=True):
            if not told_here.any():
                words, fix = "nothing moves so", f"leave {way} out"
                if abs(motion).max() > 0:
                    words = "it is held already"
                    fix += ", or hold by springs: how rigid supports share a load is not known"
                raise InputError(f"supports[{k}]", f"holds {way} at {places[k].support.at}, where {words}", fix)
        levers_of_all = np.concatenate([np.zeros((0, 6)), *(levers for *_, levers in rigid)])[is_new]
        owner = np.repeat([k for k, *_ in rigid], np.diff(ends))[is_new]
        self.taken, lifts = list[tuple[int, int]](), list[Floats]()
        for k in dict.fromkeys(owner.tolist()):
            levers = levers_of_all * (owner == k)[:, None]
            for component in _acting(levers):
                self.taken.append((k, component))
                lifts.append(levers[:, component])
        self.lifted = np.zeros((unknowns, 0))
        if lifts:
            self.lifted = least_motions(rows[np.flatnonzero(is_new)], np.stack(lifts, axis=1))
        self.sprung, loads, springs, dampers = list[tuple[int, int]](), [empty], list[float](), list[float]()
        self.stiffness, self.damping = csr_array((unknowns, unknowns)), csr_array((unknowns, unknowns))
        for k, place in enumerate(places):
            for way in place.support.yielding:
                motion, levers = place.motions[way]
                spring = float(place.support.stiffness.get(way, 0.0))
                damper = float(place.support.damping.get(way, 0.0))
                share = diags_array(np.full(len(levers), 1 / len(levers)))
                square = motion.T @ share @ motion
                self.stiffness, self.damping = self.stiffness + spring * square, self.damping + damper * square
                for component in _acting(levers):
                    self.sprung.append((k, component))
                    loads.append(csr_array(levers[:, [component]].T / len(levers) @ motion))
                    springs.append(spring)
                    dampers.append(damper)
        self.yielding, self.springs, self.dampers = vstack(loads, format="csr"), np.array(springs), np.array(dampers)

    def condense(self, matrix: Any) -> Any:
        """Condense a sparse matrix (u, u), or loads (u, m), to the motions that supports leave: Nᵀ A N, or Nᵀ f."""
        from scipy.sparse import issparse

        if not self.taken:
            return matrix
        narrow = self.basis.T @ matrix
        return narrow @ self.basis if issparse(matrix) else narrow

    def static_loads(self, stiffness: Any) -> Floats:
        """Loads (f, s) on what is left whose static answers join to the `lifted` motions, under a stiffness (u, u)."""
        return np.asarray(-(self.basis.T @ (stiffness @ self.lifted)))

    def expand(self, shapes: Floats, answers: Floats) -> Floats:
        """Motions (u, n + s) of all unknowns: shapes (f, n) of what is left, and lifted motions with their answers (f,
        s).
        """
        if not self.taken:
            return shapes
        motions = np.asarray(self.basis @ np.concatenate([shapes, answers], axis=1))
        motions[:, shapes.shape[1] :] += self.lifted
        return motions

    def hold(
        self,
        structure: Structure,
        free: Structure,
        motions: Floats,
        second: Floats | None = None,
        *,
        rooted: bool,
    ) -> Structure:
        """Let supports hold a structure in n coordinates, besides its root if that is `rooted`.

        `free` has the lifted motions besides, and no damping; the unknowns move by `motions` (u, n + s). `second` (s,
        n, n) are second derivatives by the coordinates of the elastic forces along the lifted motions.
        """
        n, count = structure.size, motions.shape[1]
        dampers, c = motions.T @ (self.damping @ motions), structure.coefficients
        felt = dampers.copy()
        felt[:n, :n] += c.damping
        grip = Grip(
            free=replace(free, coefficients=free.coefficients.damped(felt)),
            basis=np.eye(count, n),
            rows=np.eye(count)[n:],
            yielding=np.asarray(self.yielding @ motions),
            stiffness=self.springs,
            damping=self.dampers,
            dependents=tuple(range(n, count)),
            held=tuple(self.taken),
            sprung=tuple(self.sprung),
            labels=tuple(place.support.label for place in self.places),
            places=Places(
                np.array([held.centre for held in self.places]),
                np.stack([np.asarray(held.moved @ motions) for held in self.places]),
            ),
            rooted=rooted,
            second=None if second is None else np.pad(second, ((0, 0), (0, count - n), (0, count - n))),
        )
        return replace(structure, coefficients=c.damped(felt[:n, :n]), grip=grip)


def held_at_points(
    structure: Structure, supports: Sequence[Support], damping_ratio: Any = None, *, rooted: bool
) -> Structure:
    """Hold a linear structure at its named points, in the shapes that it has, besides its root if that is `rooted`.

    A `damping_ratio` is of the modes that are left; without one they have the damping of the structure.
    """
    from scipy.sparse import csr_array

    places = []
    for i, support in enumerate(supports):
        choice(f"supports[{i}].at", support.name, structure.points)
        station = structure.points.index(support.at)
        moved = structure.station_places.first[station]
        rows = moved if structure.turns is None else np.concatenate([moved, structure.turns[station]])
        motions = {}
        for way in (*support.rigid, *support.yielding):
            number = DIRECTIONS.index(way)
            if number >= len(rows) or not np.isfinite(rows[number]).all():
                problem = f"holds {way} at {support.at}, which does not say how it turns"
                raise InputError(f"supports[{i}]", problem, f"leave {way} out")
            motions[way] = csr_array(rows[[number]]), np.eye(6)[[number]]
        places.append(Held(support, structure.station_places.r0[station], motions, moved))
    holding, c = Holding(places, structure.size), structure.coefficients
    basis, stiffness = holding.basis.toarray(), c.stiffness + holding.stiffness.toarray()
    answers = np.linalg.solve(basis.T @ stiffness @ basis, holding.static_loads(stiffness))
    motions_of_all = holding.expand(np.eye(basis.shape[1]), answers)
    sprung = replace(structure, coefficients=replace(c, stiffness=stiffness))
    reduced, free = sprung.turned(basis), sprung.turned(motions_of_all)
    if damping_ratio is not None:
        kept = reduced.coefficients
        reduced = replace(reduced, coefficients=kept.damped(damping_matrix(damping_ratio, kept.mass, kept.stiffness)))
    return holding.hold(reduced, free, motions_of_all, rooted=rooted)


def _acting(levers: Floats) -> list[int]:
    """Forces and moments, 0 to 5, that are in levers (g, 6)."""
    sizes = np.abs(levers).max(axis=0)
    return np.flatnonzero(sizes > NOTHING * sizes.max()).tolist()
