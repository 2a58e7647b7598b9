"""Places at which supports hold a mesh: all nodes of a group, a node, or the mean motion of an interface or a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Indices
from gbeam.constants import Direction
from gbeam.errors import InputError
from gbeam.structure.supports import DIRECTIONS, Support

FREE = 1e-6  # of the motion that is held best: a rigid motion that is free


@dataclass(frozen=True, eq=False)
class HeldPlace(Value):
    """A place that a support holds: points (p,) of the mesh, which stand for nodes of numbers (p,) in `node`, from 0.

    Of a group or a node each node is held. Of an interface or a rigid link it is the motion at its `centre`, (3,) m.
    """

    support: Support
    points: Indices
    node: Indices
    centre: Floats
    kind: Literal["nodes", "interface", "link"] = "nodes"

    @property
    def name(self) -> str:
        """Name of the group, point, interface or link."""
        return self.support.name

    def arms(self, points: Floats) -> Floats:
        """Places (g, 3) of the nodes from the centre, from those (k, 3) of the mesh's points; one of zero of an
        interface or a link.
        """
        if self.kind != "nodes":
            return np.zeros((1, 3))
        count = np.bincount(self.node)
        places = np.stack([np.bincount(self.node, component) / count for component in points[self.points].T], axis=1)
        return places - self.centre

    def levers(self, points: Floats, direction: Direction) -> Floats:
        """Force and moment about the centre (g, 6) of a unit force, or moment, on each node along a direction."""
        return levers(self.arms(points), direction)


def levers(arms: Floats, direction: Direction) -> Floats:
    """Force and moment (g, 6) about a place of a unit force, or moment, along a direction at arms (g, 3) from it."""
    axis = np.eye(3)[DIRECTIONS.index(direction) % 3]
    if direction.startswith("r"):
        return np.broadcast_to(np.append(np.zeros(3), axis), (len(arms), 6)).copy()
    return np.concatenate([np.broadcast_to(axis, arms.shape), np.cross(arms, axis)], axis=1)


def about(places: Floats) -> Floats:
    """Maps (..., 6, 6) from forces and moments about places (..., 3), in rows, to those about the origin."""
    maps = np.broadcast_to(np.eye(6), (*places.shape[:-1], 6, 6)).copy()
    maps[..., :3, 3:] = np.cross(places[..., None, :], np.eye(3))
    return maps


def refuse_free(where: str, held: Floats, points: Floats) -> None:
    """Refuse supports that leave a rigid motion free: they hold rows (m, 6) of rigid motions about the origin, of a
    body with points (k, 3).
    """
    middle, size = points.mean(axis=0), float(np.linalg.norm(np.ptp(points, axis=0)))
    # About the middle, with rotations in lengths of the body's size.
    scaled_rows = held @ about(-middle) / np.repeat([1.0, size], 3)
    _, values, motions = np.linalg.svd(scaled_rows)
    values = np.pad(values, (0, 6 - len(values)))
    if values[5] > FREE * values[0]:
        return
    motion = motions[values <= FREE * values[0]]
    names = [f"along {axis}" for axis in "xyz"] + [f"about {axis}" for axis in "xyz"]
    free_ways = [name for name, share in zip(names, np.linalg.norm(motion, axis=0), strict=True) if share > 0.5]
    fix = "hold that at one more place"
    raise InputError(where, f"leave the body free to move {' and '.join(free_ways)}", fix)
