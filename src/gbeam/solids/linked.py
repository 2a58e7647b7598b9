"""Displacements of a mesh by what moves on its own: free nodes, rigid links, and nodes of shells."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.mechanics.holding import Held
from gbeam.mechanics.reduction import Reduced
from gbeam.solids.geometry import Mesh
from gbeam.solids.held import HeldPlace
from gbeam.solids.links import ON_A_LINE, coupling, six_particles
from gbeam.structure.supports import DIRECTIONS

CROSS = np.zeros((3, 3, 3))  # θ × r = θ_a r_b CROSS[a, b]
for _a, _b, _c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    CROSS[_a, _b, _c], CROSS[_b, _a, _c] = 1.0, -1.0


class Linked:
    """Displacements of all points as linear maps of the independent unknowns. The points are those of a mesh, of its
    bodies and of the ends of springs. The unknowns are displacements of free nodes, and displacement and rotation of
    each link.

    A node of a shell is a link of its points, which does not turn about the line on which they are. Tied points are
    those of links.
    """

    def __init__(self, mesh: Mesh) -> None:
        from scipy.sparse import coo_array

        links, self.count = mesh.links, len(mesh.points)
        self._links, self._number = links, {name: i for i, name in enumerate(links.nodes)}
        members = {name: [] if name in links.weights else list(nodes) for name, nodes in links.nodes.items()}
        named = np.array(
            [
                links.places[name] if name in links.places else mesh.points[nodes].mean(axis=0)
                for name, nodes in links.nodes.items()
            ]
        ).reshape(-1, 3)
        points, masses, self._ends = [*mesh.points], [*mesh.point_masses], list[tuple[int, ...]]()

        def add(name: str, place: Floats, mass: float) -> int:
            """Add a point to a link, and return its number."""
            members[name].append(len(points))
            points.append(place)
            masses.append(mass)
            return len(points) - 1

        for name, body in links.bodies.items():
            for place, mass in zip(*six_particles(body), strict=True):
                add(name, named[self._number[name]] + place, mass)
        for ends_by_name, _, spring_place in links.springs.values():
            place = named[self._number[ends_by_name[0]]] if spring_place is None else spring_place
            self._ends.append(tuple(add(name, place, 0.0) for name in ends_by_name))
        self.points, self.masses = np.array(points), np.array(masses)
        of_link = np.full(len(points), -1)  # of each point, named links first, then nodes of shells
        for name, linked in members.items():
            of_link[linked] = self._number[name]
        _, node, point_counts = np.unique(mesh.numbers, return_inverse=True, return_counts=True)
        of_shell = (point_counts[node] > 1) & ~mesh.clamped & (of_link[: self.count] < 0)
        shell_number = np.unique(node[of_shell], return_inverse=True)[1]
        of_link[np.flatnonzero(of_shell)] = len(named) + shell_number
        self._tied = np.flatnonzero(of_link >= 0)
        self._of = link_of_tied = of_link[self._tied]  # the link of each tied point
        count = np.bincount(link_of_tied, minlength=len(named))
        sums = [np.bincount(link_of_tied, x, minlength=len(named)) for x in self.points[self._tied].T]
        middles = np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]
        middles[: len(named)] = named
        for name, weights in links.weights.items():
            middles[self._number[name]] = coupling("", mesh.points[links.nodes[name]], weights)[0]
        self._arms = self.points[self._tied] - middles[link_of_tied]
        second = np.zeros((len(middles), 3, 3))
        on_mesh = self._tied < self.count
        np.add.at(second, link_of_tied[on_mesh], (self._arms[:, :, None] * self._arms[:, None])[on_mesh])
        size, axes = np.linalg.eigh(second)
        on_line = (size[:, 1] <= ON_A_LINE * size[:, 2]) & (size[:, 2] > 0)
        self._axes = np.where(on_line[:, None, None], axes, np.eye(3))
        turning = np.stack([np.ones_like(on_line), np.ones_like(on_line), ~on_line], axis=1)
        untied, may_move = np.flatnonzero(of_link < 0), np.ones((len(middles), 6), dtype=bool)
        for name, i in self._number.items():
            may_move[i] = links.moving(name)
        is_unknown = np.concatenate([np.ones_like(turning), turning], axis=1)
        is_unknown[[self._number[name] for name in links.weights]] = False
        is_free = np.concatenate([np.repeat(~mesh.clamped[untied], 3), may_move[is_unknown]])
        # Of links' displacements and rotations (l, 6) numbers among the unknowns, −1 of none, and those of tied points.
        numbers = np.where(is_unknown, 3 * len(untied) + np.cumsum(is_unknown).reshape(is_unknown.shape) - 1, -1)
        move = np.concatenate(
            [np.tile(np.eye(3), (len(link_of_tied), 1, 1)), self._turn_displacements(self._arms)], axis=2
        )
        used = np.broadcast_to((numbers[link_of_tied] >= 0)[:, None], move.shape)
        row = np.broadcast_to((3 * self._tied[:, None] + np.arange(3))[..., None], move.shape)[used]
        column = np.broadcast_to(numbers[link_of_tied][:, None], move.shape)[used]
        untied_rows = (3 * untied[:, None] + np.arange(3)).ravel()
        self._map = coo_array(
            (
                np.concatenate([np.ones(len(untied_rows)), move[used]]),
                (np.concatenate([untied_rows, row]), np.concatenate([np.arange(len(untied_rows)), column])),
            ),
            shape=(3 * len(points), len(is_free)),
        ).tocsr()[:, is_free]
        self._kept, self._selected = np.flatnonzero(is_free), not len(self._tied)
        number = np.where((numbers >= 0) & is_free[numbers], np.cumsum(is_free)[numbers] - 1, -1)[:, None, 3:]
        turns = np.broadcast_to(number >= 0, self._axes.shape)
        row = np.broadcast_to(np.arange(3 * len(middles)).reshape(-1, 3, 1), turns.shape)[turns]
        entries = self._axes[turns], (row, np.broadcast_to(number, turns.shape)[turns])
        self._turn = coo_array(entries, shape=(3 * len(middles), len(self._kept))).tocsr()
        for name, weights in links.weights.items():
            self._follow(self._number[name], members[name], links.nodes[name], weights)

    def _follow(self, link: int, members: list[int], nodes: Indices, weights: Floats) -> None:
        """Let the `members` of a link, points, and its rotation follow the mean motion of `nodes` with weights."""
        from scipy.sparse import coo_array

        centre, mean = coupling("", self.points[nodes], weights)
        mean = mean.reshape(6, -1)
        arms = np.einsum("pb,abc->pca", self.points[members] - centre, CROSS)
        motions = mean[:3] + np.einsum("pca,ak->pck", arms, mean[3:])
        sources, points = (3 * nodes[:, None] + np.arange(3)).ravel(), 3 * len(self.points)

        def on_unknowns(rows: Indices, values: Floats, count: int) -> Any:
            """Values (rows, 3 g) that act on displacements of the nodes, as a matrix (count, u) on the unknowns."""
            pairs = np.repeat(rows, len(sources)), np.tile(sources, len(rows))
            return coo_array((values.ravel(), pairs), shape=(count, points)).tocsr() @ self._map

        self._turn = self._turn + on_unknowns(3 * link + np.arange(3), mean[3:], self._turn.shape[0])
        rows = (3 * np.array(members)[:, None] + np.arange(3)).ravel()
        self._map = self._map + on_unknowns(rows, motions, points)

    def held(self, i: int, place: HeldPlace) -> Held:
        """Motions of the nodes of a place that the support of number `i` holds, by the unknowns."""
        from scipy.sparse import csr_array, vstack

        points, count = place.points, len(place.points)
        point_rows = self._map[(3 * points[:, None] + np.arange(3)).ravel()]
        if place.kind == "interface":
            mean = coupling(place.name, self.points[points])[1].reshape(6, -1)
            rows = [csr_array(mean[axis : axis + 1]) @ point_rows for axis in range(6)]
        else:
            point_counts = np.bincount(place.node)
            sums = csr_array(
                (1 / point_counts[place.node], (place.node, np.arange(count))), shape=(len(point_counts), count)
            )
            if place.kind == "link":
                sums = csr_array(np.full((1, count), 1 / count))
            rows = [sums @ point_rows[axis::3] for axis in range(3)]
            rows += self._turns(i, place)
        motions = {
            way: (vstack([rows[DIRECTIONS.index(way)]], format="csr"), place.levers(self.points, way))
            for way in (*place.support.rigid, *place.support.yielding)
        }
        mean_rows = [csr_array(np.full((1, row.shape[0]), 1 / row.shape[0])) @ row for row in rows[:3]]
        return Held(place.support, place.centre, motions, vstack(mean_rows, format="csr"))

    def _turns(self, i: int, place: HeldPlace) -> list[Any]:
        """Rotations of a place's nodes about x, y and z by the unknowns, where its support, number `i`, holds any."""
        rotations = [way for way in (*place.support.rigid, *place.support.yielding) if way.startswith("r")]
        if not rotations:
            return []
        first = place.points[np.unique(place.node, return_index=True)[1]]
        of_point = np.full(len(self.points), -1)
        of_point[self._tied] = self._of
        links = np.array([self._number[place.name]]) if place.kind == "link" else of_point[first]
        if (links < 0).any():
            fix = "hold its displacements, or name its group in interfaces and hold the interface, by its mean"
            problem = f"holds {rotations[0]} at {place.name}, where nodes of solid elements have no rotations"
            raise InputError(f"supports[{i}]", problem, fix)
        return [self._turn[3 * links + axis] for axis in range(3)]

    def narrowed(self, basis: Any) -> Linked:
        """Return the same in fewer unknowns, of which sparse columns of `basis` (u, f) are motions."""
        linked = copy(self)
        linked._map, linked._turn, linked._selected = self._map @ basis, self._turn @ basis, False
        return linked

    def _turn_displacements(self, arms: Floats) -> Floats:
        """Displacements (p, 3, 3) of tied points by unit rotations about their links' axes, in columns."""
        return np.einsum("pai,pb,abc->pci", self._axes[self._of], arms, CROSS, optimize=True)

    def widened(self, matrix: Any, unknowns: int) -> Any:
        """Append empty rows and columns to a matrix of the nodes, `unknowns` for each of the other points."""
        from scipy.sparse import block_diag, csr_array

        added = unknowns * (len(self.points) - self.count)
        return block_diag([matrix, csr_array((added, added))], format="csr") if added else matrix

    def widened_loads(self, loads: Floats) -> Floats:
        """Append rows of zeros to loads (3 k, m) on the nodes for the other points."""
        return np.concatenate([loads, np.zeros((3 * (len(self.points) - self.count), loads.shape[1]))])

    def elastic(self, matrix: Any) -> Any:
        """Stiffness of all points: that of the nodes, and the springs along x, y and z."""
        from scipy.sparse import coo_array

        total = self.widened(matrix, 3)
        size = 3 * len(self.points)
        for ends, (_, stiffness, _) in zip(self._ends, self._links.springs.values(), strict=True):
            signs = np.array([1.0, -1.0])[: len(ends)]
            rows = 3 * np.array(ends)[:, None] + np.arange(3)
            values = np.einsum("i,j,a->ija", signs, signs, stiffness[:3])
            row = np.broadcast_to(rows[:, None], values.shape).ravel()
            column = np.broadcast_to(rows[None], values.shape).ravel()
            total = total + coo_array((values.ravel(), (row, column)), shape=(size, size)).tocsr()
        return total

    def condensed(self, matrix: Any) -> Any:
        """Express a sparse matrix, or loads, of all points by the independent unknowns: Tᵀ A T, or Tᵀ f."""
        from scipy.sparse import issparse

        if self._selected:
            return matrix[self._kept][:, self._kept] if issparse(matrix) else matrix[self._kept]
        by_unknowns = self._map.T @ matrix
        return by_unknowns @ self._map if issparse(matrix) else by_unknowns

    def condensed_stiffness(self, matrix: Any) -> Any:
        """Express a stiffness of all points by the unknowns, and add the springs about x, y and z between links."""
        from scipy.sparse import diags_array

        total = self.condensed(matrix)
        for names, stiffness, _ in self._links.springs.values():
            # The rotation of the first link relative to the second one, or to the base.
            turn, *second = (self._turn[3 * self._number[name] :][:3] for name in names)
            turn = turn - second[0] if second else turn
            total = total + turn.T @ diags_array(stiffness[3:]) @ turn
        return total

    def displacements(self, unknowns: Floats) -> Floats:
        """Displacements (points, 3, n) by unknowns (u, n)."""
        return np.asarray(self._map @ unknowns).reshape(len(self.points), 3, -1)

    @property
    def tied(self) -> bool:
        """True if some points move by links, or by those of shells."""
        return bool(len(self._tied)) or len(self.points) > self.count

    @property
    def _rows(self) -> Indices:
        """Rows of the tied points in matrices of all points."""
        return np.asarray((3 * self._tied[:, None] + np.arange(3)).ravel())

    def tied_rows(self, stiffness: Any) -> Any:
        """Rows of the tied points in a stiffness of all points: what they take up of a displacement."""
        return stiffness[self._rows]

    def rotations(self, unknowns: Floats) -> Floats:
        """Rotations (l, 3, n) of the links by unknowns (u, n)."""
        return np.asarray(self._turn @ unknowns).reshape(len(self._axes), 3, unknowns.shape[1])

    def geometric_stiffness(
        self, held: Any, mass: Any, loads: Floats, static: Floats, reduced: Reduced, lifted: Floats
    ) -> Floats:
        """Two halves (2, m, n + s, n + s) of what links add to :func:`gbeam.solids.elements.geometric_stiffness`.

        They are the work of the forces that hold tied points on a link, in the displacements θ × (θ × r)/2 as it turns
        by θ.

        In the first half the forces are those under loads (points · 3, m), whose answers are `static` (u, m), and two
        coordinates turn the links. In the second the forces are a coordinate's, and a load and another coordinate turn
        them. `held` are the tied points' rows of the stiffness. `lifted` (l, 3, s) turn the links besides, in the first
        half alone.
        """
        shapes = reduced.shapes
        n, count = shapes.shape[-1], shapes.shape[-1] + lifted.shape[-1]
        halves = np.zeros((2, loads.shape[-1], count, count))
        if not len(self._tied):
            return halves
        static_moved, displacements = self._map @ static, self._map @ shapes
        inertia = (mass @ displacements.reshape(len(self.points), -1)).reshape(displacements.shape) @ reduced.stiffness
        # Forces that the links take up: of the loads' answers, and of the shapes.
        pulling = self._moments(held @ static_moved - loads[self._rows])
        holding = self._moments(held @ displacements - inertia[self._rows])
        holding += np.swapaxes(holding, 1, 2)
        turn, static_turns = np.concatenate([self.rotations(shapes), lifted], axis=2), self.rotations(static)
        for load in range(loads.shape[-1]):
            flat = turn.reshape(-1, count)
            halves[0, load] = flat.T @ np.matmul(pulling[..., load], turn).reshape(flat.shape) / 2
            pulled = np.einsum("lb,lbcn->lcn", static_turns[..., load], holding).reshape(-1, n)
            halves[1, load, :n, :n] = pulled.T @ flat[:, :n] / 2
        return halves

    def _moments(self, forces: Floats) -> Floats:
        """Moments (l, 3, 3, m) of forces (p · 3, m) on the tied points, which are at r from the middles of their links.

        Each matrix is f · (θ × (ϑ × r)) = (f · ϑ)(θ · r) − (f · r)(θ · ϑ) in the rotations θ and ϑ, summed over the
        points of a link.
        """
        moments = np.zeros((len(self._axes), 3, 3, forces.shape[-1]))
        tied_forces = forces.reshape(len(self._tied), 1, 3, -1)
        np.add.at(moments, self._of, self._arms[:, :, None, None] * tied_forces)
        return moments - np.einsum("lbbm,ac->lacm", moments, np.eye(3))
