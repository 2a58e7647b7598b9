"""A portal frame and a bracket of hexahedra of 20 nodes, clamped at one foot, the other one on supports."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import NamedTuple

import meshio
import numpy as np

import gbeam as gb
from validation.codes.calculix_specimens import STEEL, grid

SPAN, HEIGHT, SIDE = 200.0, 120.0, 20.0  # mm, of the frame
SPRINGS = {"x": 4e6, "z": 9e6}  # N/m
Box = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
ACROSS = -np.inf, np.inf
PORTAL: tuple[Box, ...] = (
    ((0, SIDE), ACROSS, (0, HEIGHT)),
    ((SPAN - SIDE, SPAN), ACROSS, (0, HEIGHT)),
    ((0, SPAN), ACROSS, (HEIGHT - SIDE, HEIGHT)),
)
# Feet of the bracket at the heights 0 and 30 mm, its legs, its top, and the block.
BRACKET: tuple[Box, ...] = (
    ((0, 25), ACROSS, (0, 5)),
    ((20, 25), ACROSS, (0, 85)),
    ((20, 100), ACROSS, (80, 85)),
    ((95, 100), ACROSS, (30, 85)),
    ((95, 120), ACROSS, (30, 35)),
    ((45, 75), (0, 20), (85, 100)),
)


class Held(NamedTuple):
    """Words for a mesh that is clamped at its group `left` and held at another one."""

    words: str
    support: gb.Support
    mesh: Callable[[], meshio.Mesh]


def assembled(ends: tuple[float, float, float], sizes: tuple[float, float, float], boxes: Sequence[Box]) -> meshio.Mesh:
    """Mesh of the elements of a block whose middles lie in one of the boxes, its lowest points on z = 0, mm."""
    x, y, z = (round(end / size) for end, size in zip(ends, sizes, strict=True))
    points, cells = grid((x, y, z), ends)
    points[:, 2] += ends[2] / 2
    low, high = np.moveaxis(np.array(boxes), 2, 0)
    middle = points[cells].mean(axis=1)[:, None]
    used, nodes = np.unique(cells[((middle > low) & (middle < high)).all(axis=2).any(axis=1)], return_inverse=True)
    return meshio.Mesh(points[used], {"hexahedron20": nodes.reshape(-1, 20)})


def grouped(mesh: meshio.Mesh, groups: Mapping[str, np.ndarray]) -> meshio.Mesh:
    """The mesh with groups of nodes, from whether each belongs to them."""
    return meshio.Mesh(mesh.points, mesh.cells, point_sets={name: np.flatnonzero(on) for name, on in groups.items()})


@cache
def portal() -> meshio.Mesh:
    """Mesh of the frame in the plane of x and z, its feet on z = 0, mm."""
    mesh = assembled((SPAN, SIDE, HEIGHT), (10, 10, 10), PORTAL)
    x, _, z = mesh.points.T
    below, corner = np.isclose(z, 0), np.isclose(mesh.points, (SPAN, SIDE / 2, HEIGHT)).all(axis=1)
    return grouped(mesh, {"left": below & (x < SPAN / 2), "right": below & (x > SPAN / 2), "corner": corner})


@cache
def bracket() -> meshio.Mesh:
    """Mesh of the bracket, its lower foot on z = 0, mm; each foot stands on the outer 15 mm of its lower face."""
    mesh = assembled((120, 40, 100), (5, 10, 5), BRACKET)
    x, _, z = mesh.points.T
    groups = {"left": np.isclose(z, 0) & (x < 15.1), "right": np.isclose(z, 30) & (x > 104.9)}
    groups["hinge"] = np.isclose(z, 30) & np.isclose(x, 110)
    groups["corner"] = np.isclose(mesh.points, (75, 20, 100)).all(axis=1)
    return grouped(mesh, groups)


CASES = {
    "fixed": Held("the other foot fixed", gb.Support("right", ["x", "y", "z"]), portal),
    "sliding": Held("the other foot slides along x", gb.Support("right", ["y", "z"]), portal),
    "springs": Held(
        "the other foot on springs along x and z, held along y",
        gb.Support("right", ["y"], stiffness=SPRINGS),
        portal,
    ),
    "bracket on a rail": Held("bracket, the other foot slides along x", gb.Support("right", ["y", "z"]), bracket),
    "bracket on a hinge": Held(
        "bracket, the other foot held along a line", gb.Support("hinge", ["x", "y", "z"]), bracket
    ),
}


@cache
def frame(name: str) -> gb.SolidMesh:
    """A case's mesh on its supports."""
    case = CASES[name]
    return gb.SolidMesh.read(
        case.mesh(), materials=STEEL, clamp="left", unit="mm", supports=[case.support], points={"corner": "corner"}
    )


@cache
def reduced(name: str) -> gb.SolidModel:
    """It in twenty modes and its static shapes."""
    return frame(name).reduced(modes=20, damping_ratio=0.0)


def model(name: str) -> gb.Structure:
    """It as a structure."""
    return reduced(name).structure
