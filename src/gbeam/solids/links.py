"""Rigid links between nodes of a solid, with bodies on them and springs between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.results.result import Floats
from gbeam.solids.elements import Indices
from gbeam.solids.interfaces import coupling

if TYPE_CHECKING:
    from gbeam.mechanics.tree.system import RigidBody
    from gbeam.solids.mesh import SolidMesh

WAYS = ("x", "y", "z", "rx", "ry", "rz")
CROSS = np.zeros((3, 3, 3))  # θ × r = θ_a r_b CROSS[a, b]
for _a, _b, _c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    CROSS[_a, _b, _c], CROSS[_b, _a, _c] = 1.0, -1.0


@dataclass(frozen=True, eq=False)
class Links(Value):
    """Links of a mesh: nodes (g,) that move as one rigid body, bodies whose roots are in the middle of a link's nodes,
    and springs, N/m and N m/rad along and about x, y, z, from a link to another one or to the base, where the middle of
    the first is or at a place; and places (3,) m of links, in place of the middles of their nodes.
    """

    nodes: dict[str, Indices] = field(default_factory=dict)
    bodies: dict[str, RigidBody] = field(default_factory=dict)
    springs: dict[str, tuple[tuple[str, ...], Floats, Floats | None]] = field(default_factory=dict)
    places: dict[str, Floats] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        group: Callable[[str, str], Indices],
        links: Mapping[str, str | Sequence[str]],
        carried: Mapping[str, RigidBody],
        springs: Mapping[str, Mapping[str, Any]],
        points: Floats,
        clamped: Any,
    ) -> Links:
        """Read links by the groups of a mesh."""
        nodes: dict[str, Indices] = {}
        for name, groups in links.items():
            some = [groups] if isinstance(groups, str) else groups
            nodes[name] = np.unique(np.concatenate([group(f"links.{name}", each) for each in some]))
            coupling(f"links.{name}", points[nodes[name]])
            for other in list(nodes)[:-1]:
                if shared := len(np.intersect1d(nodes[name], nodes[other])):
                    fix = "name all their groups in one"
                    raise InputError(f"links.{name}", f"shares {shared} nodes with links.{other}", fix)
            if clamped[nodes[name]].any():
                fix = "leave those out, or clamp the whole group"
                raise InputError(f"links.{name}", f"has {clamped[nodes[name]].sum()} clamped nodes", fix)

        def known(where: str, name: str) -> str:
            if name not in nodes:
                fix = f"choose from {', '.join(nodes)}" if nodes else "name its groups in links"
                raise InputError(where, f"is {name!r}, which is no rigid link", fix)
            return name

        for name in carried:
            known(f"carried.{name}", name)
        held: dict[str, tuple[tuple[str, ...], Floats, Floats | None]] = {}
        for name, each in springs.items():
            between = tuple(known(f"springs.{name}.between[{i}]", one) for i, one in enumerate(each["between"]))
            if len(between) not in (1, 2) or len(set(between)) < len(between):
                fix = "name one link, for a spring to the base, or two"
                raise InputError(f"springs.{name}.between", f"is {list(between)}", fix)
            if unknown := [way for way in each["stiffness"] if way not in WAYS]:
                fix = f"choose from {', '.join(WAYS)}"
                raise InputError(f"springs.{name}.stiffness", f"has {unknown[0]!r}", fix)
            stiffness = [
                positive(f"springs.{name}.stiffness.{way}", each["stiffness"].get(way, 0.0), "", zero=True)
                for way in WAYS
            ]
            held[name] = between, np.array(stiffness), None
        return cls(nodes, dict(carried), held)

    @property
    def joined(self) -> list[Indices]:
        """Nodes that move together, of every link and of the two of every spring."""
        pairs = [
            [self.nodes[name][0] for name in between if len(self.nodes[name])] for between, *_ in self.springs.values()
        ]
        return [each for each in (*self.nodes.values(), *map(np.array, pairs)) if len(each) > 1]

    def moving(self, name: str) -> Any:
        """Ways (6,) in which a link moves: of a single node it turns only where a spring or a body resists it."""
        if len(self.nodes[name]) > 1:
            return np.ones(6, dtype=bool)
        held = [stiffness[3:] > 0 for between, stiffness, _ in self.springs.values() if name in between]
        turns = np.any([np.zeros(3, dtype=bool), *held], axis=0)
        if name in self.bodies:
            turns |= np.diag(self.bodies[name].tensor) > 0
        return np.concatenate([np.ones(3, dtype=bool), turns])

    @property
    def on_base(self) -> list[Indices]:
        """Nodes that springs hold to the base."""
        return [self.nodes[between[0]] for between, *_ in self.springs.values() if len(between) == 1]


class Linked:
    """Points of a mesh, of its bodies and of the ends of springs, by the independent unknowns: the displacements of
    free nodes, and one displacement and rotation of each link.
    """

    def __init__(self, mesh: SolidMesh) -> None:
        from scipy.sparse import coo_array, eye_array

        links, k = mesh.links, len(mesh.points)
        self._links = links
        members = {name: list(nodes) for name, nodes in links.nodes.items()}
        self._middles = {
            name: links.places[name] if name in links.places else mesh.points[nodes].mean(axis=0)
            for name, nodes in links.nodes.items()
        }
        points, masses, self._ends = [*mesh.points], [*mesh.point_masses], list[tuple[int, ...]]()

        def add(name: str, place: Floats, mass: float) -> int:
            members[name].append(len(points))
            points.append(place)
            masses.append(mass)
            return len(points) - 1

        for name, body in links.bodies.items():
            for place, mass in zip(*_particles(body), strict=True):
                add(name, self._middles[name] + place, mass)
        for between, _, at in links.springs.values():
            place = self._middles[between[0]] if at is None else at
            self._ends.append(tuple(add(name, place, 0.0) for name in between))
        self.points, self.masses = np.array(points), np.array(masses)
        self.members = {name: np.array(each) for name, each in members.items()}
        tied = np.zeros(len(points), dtype=bool)
        for each in self.members.values():
            tied[each] = True
        alone = np.flatnonzero(~tied)
        moving = [links.moving(name) for name in members]
        free = np.concatenate([np.repeat(~mesh.clamped[alone], 3), *moving])
        rows, columns, values = (
            [(3 * alone[:, None] + np.arange(3)).ravel()],
            [np.arange(3 * len(alone))],
            [np.ones(3 * len(alone))],
        )
        every = eye_array(len(free), format="csr")[:, free]
        self._turns = {}
        for i, (name, each) in enumerate(self.members.items()):
            first = 3 * len(alone) + 6 * i
            self._turns[name] = every[first + 3 : first + 6]
            arms = self.points[each] - self._middles[name]
            move = np.concatenate(
                [np.broadcast_to(np.eye(3), (len(each), 3, 3)), np.einsum("pb,abc->pca", arms, CROSS)], axis=2
            )
            row = np.broadcast_to((3 * each[:, None] + np.arange(3))[..., None], move.shape)
            rows.append(row.ravel())
            columns.append(np.broadcast_to(first + np.arange(6), move.shape).ravel())
            values.append(move.ravel())
        self.count = k
        self._map = coo_array(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
            shape=(3 * len(points), len(free)),
        ).tocsr()[:, free]
        self._kept = np.flatnonzero(free)

    def widened(self, matrix: Any, unknowns: int) -> Any:
        """A matrix of the nodes with rows and columns of the other points; `unknowns` of each."""
        from scipy.sparse import block_diag, csr_array

        more = unknowns * (len(self.points) - self.count)
        return block_diag([matrix, csr_array((more, more))], format="csr") if more else matrix

    def widened_loads(self, loads: Floats) -> Floats:
        """Loads (3 k, m) of the nodes, and none on the other points."""
        return np.concatenate([loads, np.zeros((3 * (len(self.points) - self.count), loads.shape[1]))])

    def elastic(self, matrix: Any) -> Any:
        """Stiffness of all points by that of the nodes, with the springs along x, y and z."""
        from scipy.sparse import coo_array

        total = self.widened(matrix, 3)
        size = 3 * len(self.points)
        for ends, (_, stiffness, _) in zip(self._ends, self._links.springs.values(), strict=True):
            signs = np.array([1.0, -1.0])[: len(ends)]
            rows = 3 * np.array(ends)[:, None] + np.arange(3)
            values = np.einsum("i,j,a->ija", signs, signs, stiffness[:3])
            pairs = np.broadcast_to(rows[:, None], values.shape), np.broadcast_to(rows[None], values.shape)
            total = (
                total + coo_array((values.ravel(), tuple(each.ravel() for each in pairs)), shape=(size, size)).tocsr()
            )
        return total

    def condensed(self, matrix: Any) -> Any:
        """A matrix or loads of all points by the independent unknowns."""
        from scipy.sparse import issparse

        if not self.members:
            return matrix[self._kept][:, self._kept] if issparse(matrix) else matrix[self._kept]
        left = self._map.T @ matrix
        return left @ self._map if issparse(matrix) else left

    def condensed_stiffness(self, matrix: Any) -> Any:
        """A stiffness of all points, with the springs about x, y and z between links."""
        from scipy.sparse import diags_array

        total = self.condensed(matrix)
        for between, stiffness, _ in self._links.springs.values():
            turn = self._turns[between[0]]
            if len(between) > 1:
                turn = turn - self._turns[between[1]]
            total = total + turn.T @ diags_array(stiffness[3:]) @ turn
        return total

    def displacements(self, unknowns: Floats) -> Floats:
        """Displacements (points, 3, n) by unknowns (u, n)."""
        return np.asarray(self._map @ unknowns).reshape(len(self.points), 3, -1)

    def held(self, stiffness: Any) -> list[Any]:
        """Rows of a stiffness of all points, those of each link."""
        return [stiffness[(3 * each[:, None] + np.arange(3)).ravel()] for each in self.members.values()]

    def geometric_stiffness(self, held: list[Any], still: Floats, loads: Floats, shapes: Floats) -> Floats:
        """Stiffness (m, n, n) of the forces that hold the points on their links, as these turn by coordinates with
        shapes (u, n): their work in θ × (θ × r)/2, under loads (points · 3, m) with answers `still` (points, 3, m);
        `held` are the links' rows of the stiffness.
        """
        total = np.zeros((loads.shape[-1], shapes.shape[-1], shapes.shape[-1]))
        for (name, each), rows in zip(self.members.items(), held, strict=True):
            loaded = loads.reshape(still.shape)[each]
            constraint = (rows @ still.reshape(loads.shape)).reshape(loaded.shape) - loaded
            turn = self._turns[name] @ shapes
            moments = np.einsum("pb,pcm->bcm", self.points[each] - self._middles[name], constraint)
            # f · (θ × (ϑ × r)) = (f · ϑ)(θ · r) − (f · r)(θ · ϑ)
            total += np.einsum("bcm,bi,cj->mij", moments, turn, turn) - np.einsum("bbm,ci,cj->mij", moments, turn, turn)
        return (total + total.swapaxes(1, 2)) / 2


def _particles(body: RigidBody) -> tuple[Floats, Floats]:
    """Places (6, 3) from the root and masses (6,) of particles with the mass, centre and inertia of a body."""
    moments, axes = np.linalg.eigh(body.tensor)
    spread = np.sqrt(np.maximum(1.5 * (moments.sum() - 2 * moments), 0.0) / body.mass) if body.mass else np.zeros(3)
    arms = (axes * spread).T
    return np.asarray(body.centre) + np.concatenate([arms, -arms]), np.full(6, body.mass / 6)
