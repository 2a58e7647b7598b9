"""Small solids that tests share: blocks of any kind of element, bent as one likes, in meshio's order of the nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import meshio
import numpy as np

import gbeam as gb

# Nodes of VTK's hexahedron of 27 nodes, in halves of its edges.
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
BOTTOM, TOP = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0)], [(1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)]
UPRIGHT = [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
FACES = [(0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1)]
HEXAHEDRON = np.array([*CORNERS, *BOTTOM, *TOP, *UPRIGHT, *FACES])
# Six tetrahedra about the diagonal, and two wedges.
PATHS = [((1, 0, 0), (1, 1, 0)), ((1, 1, 0), (0, 1, 0)), ((0, 1, 0), (0, 1, 1)), ((0, 1, 1), (0, 0, 1))]
PATHS += [((0, 0, 1), (1, 0, 1)), ((1, 0, 1), (1, 0, 0))]
TETRAHEDRA = [2 * np.array([(0, 0, 0), first, second, (1, 1, 1)]) for first, second in PATHS]
WEDGES = [[(0, 0, 0), (2, 0, 0), (2, 2, 0)], [(0, 0, 0), (2, 2, 0), (0, 2, 0)]]
SIDES = np.array([(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)])  # of wedges
PAIRS = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]

STEEL = gb.Material(density=7850, youngs_modulus=210e9, poissons_ratio=0.3)
STIFF = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.0)


class Block(meshio.CellBlock):  # type: ignore[misc]
    """Solid elements of any kind: meshio knows no dimension of wedges of 15 nodes."""

    def __init__(self, kind: str, nodes: np.ndarray) -> None:
        self.type, self.data, self.dim, self.tags = kind, nodes, 3, []


def elements(kind: str) -> list[np.ndarray]:
    """Nodes, in halves of a cell's edges, of the elements that fill a cell."""
    if kind.startswith("hexahedron"):
        return [HEXAHEDRON[: int(kind.removeprefix("hexahedron") or 8)]]
    if kind.startswith("wedge"):
        corners = [np.array([*each, *np.add(each, (0, 0, 2))]) for each in WEDGES]
        return [np.concatenate([e, e[SIDES].sum(axis=1) // 2]) if kind == "wedge15" else e for e in corners]
    middles = [[(t[i] + t[j]) // 2 for i, j in PAIRS] if kind == "tetra10" else [] for t in TETRAHEDRA]
    return [np.array([*t, *m]) for t, m in zip(TETRAHEDRA, middles, strict=True)]


def block(
    kind: str,
    cells: tuple[int, int, int],
    size: tuple[float, float, float],
    bent: Callable[[np.ndarray], np.ndarray] = lambda x: x,
    groups: dict[str, Callable[[np.ndarray], np.ndarray]] | None = None,
) -> meshio.Mesh:
    """Mesh of a block from (0, -½, -½) to (1, ½, ½) of its size; `wall` is the face x = 0 before it is bent.

    The nodes are those of hexahedra of 27, so that other kinds leave some unused.
    """
    counts = [2 * n + 1 for n in cells]
    grid = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    straight = (grid - (0, 0.5, 0.5)) * size
    first = np.stack(np.meshgrid(*(np.arange(n) * 2 for n in cells), indexing="ij"), axis=-1).reshape(-1, 3)
    nodes = [np.ravel_multi_index(np.moveaxis(first[:, None] + each, -1, 0), counts) for each in elements(kind)]
    chosen = {"wall": lambda x: x[:, 0] == 0} | (groups or {})
    sets = {name: np.flatnonzero(choose(straight)) for name, choose in chosen.items()}
    return meshio.Mesh(bent(straight), [Block(kind, np.concatenate(nodes))], point_sets=sets)


def solid(mesh: Any, material: Any = STEEL, **more: Any) -> gb.SolidMesh:
    """The mesh in metres, held at its wall."""
    return gb.SolidMesh.read(mesh, materials=material, clamp="wall", unit="m", **more)


def corner(kind: str, n: int) -> meshio.Mesh:
    """A bar of 40 × 40 × 120 mm, held at its upper end, and one of 80 mm on its foot that meets it at a sharp corner;
    of 3n elements along and 2n across.
    """
    mesh = block(
        kind, (6 * n, 2 * n, 6 * n), (0.12, 0.04, 0.12), groups={"wall": lambda x: np.abs(x[:, 2] - 0.06) < 1e-9}
    )
    nodes = mesh.cells[0].data
    middle = mesh.points[nodes].mean(axis=1)
    beside = (middle[:, 0] > 0.04) & (middle[:, 2] > -0.02)
    return meshio.Mesh(mesh.points, [Block(kind, nodes[~beside])], point_sets=mesh.point_sets)
