"""Nodes of a solid that act as one: interfaces, by their mean rigid motion, and rigid links, with bodies on them and
springs between them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypedDict, get_args

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Indices
from gbeam.constants import Direction
from gbeam.errors import InputError
from gbeam.guards.checks import choice, positive
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.structure.attachments import checked_name


class LinkSpring(TypedDict):
    """A spring between two rigid links, or of one to the base."""

    between: Sequence[str]
    stiffness: Mapping[Direction, float]


ON_A_LINE = 1e-8  # of the largest second moment: nodes that do not say how they turn about their line
WAYS = get_args(Direction)


def coupling(where: str, points: Floats, weights: Floats | None = None) -> tuple[Floats, Floats]:
    """Centre (3,) of nodes (g, 3) with weights (g,), and the mean displacement and rotation (6, g, 3) there per
    displacement of each node.

    The rotation is the one that fits the nodes by least squares. By the transpose, forces and moments on the centre are
    shared out over the nodes, which may move relative to one another.
    """
    share = np.full(len(points), 1 / len(points)) if weights is None else weights / weights.sum()
    centre = share @ points
    arms = points - centre
    second = share @ (arms**2).sum(axis=1) * np.eye(3) - (share * arms.T) @ arms
    moments = np.linalg.eigvalsh(second)
    if not moments[0] > ON_A_LINE * moments[2]:
        fix = "name a group with three nodes or more that lie on no line"
        raise InputError(where, f"has {len(points)} nodes on a line, which do not say how it turns", fix)
    cross = np.zeros((3, len(points), 3))  # [axis, node, component]: r × e
    for axis, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        cross[axis, :, j], cross[axis, :, i] = arms[:, i], -arms[:, j]
    turn = np.einsum("ab,bkc,k->akc", np.linalg.inv(second), cross, share)
    shift = np.eye(3)[:, None] * share[:, None]
    return centre, np.concatenate([shift, turn])


def attached(points: Floats, interfaces: Mapping[str, Indices]) -> tuple[Floats, Floats]:
    """Centres (i, 3) of interfaces, and unit forces and moments on them as loads (3 k, 6 i) on the nodes.

    The transpose of these loads gives the interfaces' displacements and rotations by those of the nodes.
    """
    centres, loads = np.zeros((len(interfaces), 3)), np.zeros((len(points), 3, 6 * len(interfaces)))
    for i, (name, nodes) in enumerate(interfaces.items()):
        centres[i], mean = coupling(f"interfaces.{name}", points[nodes])
        loads[nodes, :, 6 * i : 6 * i + 6] = np.moveaxis(mean, 0, -1)
    return centres, loads.reshape(3 * len(points), -1)


def refuse_names(interfaces: Mapping[str, str], points: Mapping[str, int]) -> None:
    """Refuse names of interfaces that cannot be names of points, or that points have already."""
    for name in interfaces:
        try:
            checked_name(name)
        except InputError as error:
            raise error.within("interfaces") from None
        if name in points:
            raise InputError(f"interfaces.{name}", "is the name of a point too", "choose another")


def six_particles(body: RigidBody) -> tuple[Floats, Floats]:
    """Places (6, 3) from the root and masses (6,) of six particles with the mass, centre and inertia of a body.

    They are equal, two on each principal axis at ± the square root of 3 ∫ x² dm / m.
    """
    moments, axes = np.linalg.eigh(body.tensor)
    squares = 1.5 * (moments.sum() - 2 * moments)  # 3 ∫ x² dm by the principal moments
    spread = np.sqrt(np.maximum(squares, 0.0) / body.mass) if body.mass else np.zeros(3)
    arms = (axes * spread).T
    return np.asarray(body.centre) + np.concatenate([arms, -arms]), np.full(6, body.mass / 6)


@dataclass(frozen=True, eq=False)
class Links(Value):
    """Links of a mesh: nodes (g,) that move as one rigid body.

    A link may carry a body, whose root is in the middle of the link's nodes. Springs, N/m and N m/rad along and about
    x, y and z, join a link to another one or to the base: where the middle of the first is, or at a place. Places (3,)
    m of links replace the middles of their nodes. A link with weights (g,) leaves its nodes free, and has their mean
    motion.
    """

    nodes: dict[str, Indices] = field(default_factory=dict)
    bodies: dict[str, RigidBody] = field(default_factory=dict)
    springs: dict[str, tuple[tuple[str, ...], Floats, Floats | None]] = field(default_factory=dict)
    places: dict[str, Floats] = field(default_factory=dict)
    weights: dict[str, Floats] = field(default_factory=dict)

    @classmethod
    def read(
        cls,
        group: Callable[[str, str], Indices],
        links: Mapping[str, str | Sequence[str]],
        carried: Mapping[str, RigidBody],
        springs: Mapping[str, LinkSpring],
        points: Floats,
        clamped: Any,
    ) -> Links:
        """Read links by the groups of a mesh."""
        nodes: dict[str, Indices] = {}
        for name, groups in links.items():
            parts = [groups] if isinstance(groups, str) else groups
            nodes[name] = np.unique(np.concatenate([group(f"links.{name}", part) for part in parts]))
            coupling(f"links.{name}", points[nodes[name]])
            for other in list(nodes)[:-1]:
                if shared := len(np.intersect1d(nodes[name], nodes[other])):
                    fix = "name all their groups in one"
                    raise InputError(f"links.{name}", f"shares {shared} nodes with links.{other}", fix)
            if clamped[nodes[name]].any():
                fix = "leave those out, or clamp the whole group"
                raise InputError(f"links.{name}", f"has {clamped[nodes[name]].sum()} clamped nodes", fix)

        def existing(where: str, name: str) -> str:
            """Return the name of a link, or refuse it."""
            if name not in nodes:
                fix = f"choose from {', '.join(nodes)}" if nodes else "name its groups in links"
                raise InputError(where, f"is {name!r}, which is no rigid link", fix)
            return name

        for name in carried:
            existing(f"carried.{name}", name)
        held: dict[str, tuple[tuple[str, ...], Floats, Floats | None]] = {}
        for name, spring in springs.items():
            for key in spring:
                choice(f"springs.{name}", key, LinkSpring.__annotations__)
            for key in LinkSpring.__annotations__:
                if key not in spring:
                    raise InputError(f"springs.{name}.{key}", "is missing", "give between and stiffness")
            between = tuple(existing(f"springs.{name}.between[{i}]", end) for i, end in enumerate(spring["between"]))
            if len(between) not in (1, 2) or len(set(between)) < len(between):
                fix = "name one link, for a spring to the base, or two"
                raise InputError(f"springs.{name}.between", f"is {list(between)}", fix)
            if unknown := [way for way in spring["stiffness"] if way not in WAYS]:
                fix = f"choose from {', '.join(WAYS)}"
                raise InputError(f"springs.{name}.stiffness", f"has {unknown[0]!r}", fix)
            stiffness = [
                positive(f"springs.{name}.stiffness.{way}", spring["stiffness"].get(way, 0.0), "", zero=True)
                for way in WAYS
            ]
            held[name] = between, np.array(stiffness), None
        return cls(nodes, dict(carried), held)

    @property
    def joined(self) -> list[Indices]:
        """Groups of nodes that hang together: those of each rigid link, and one of each link that a spring joins."""
        groups = [nodes for name, nodes in self.nodes.items() if name not in self.weights]
        for between, *_ in self.springs.values():
            groups.append(np.array([self.nodes[name][0] for name in between if len(self.nodes[name])]))
        return [nodes for nodes in groups if len(nodes) > 1]

    def moving(self, name: str) -> Any:
        """Flags (6,) of a link's free directions. One of a single node turns only where a spring or body resists."""
        if len(self.nodes[name]) > 1:
            return np.ones(6, dtype=bool)
        held = [stiffness[3:] > 0 for between, stiffness, _ in self.springs.values() if name in between]
        turns = np.any([np.zeros(3, dtype=bool), *held], axis=0)
        if name in self.bodies:
            turns |= np.diag(self.bodies[name].tensor) > 0
        return np.concatenate([np.ones(3, dtype=bool), turns])

    @property
    def base_nodes(self) -> list[Indices]:
        """Nodes that springs hold to the base."""
        return [self.nodes[between[0]] for between, *_ in self.springs.values() if len(between) == 1]
