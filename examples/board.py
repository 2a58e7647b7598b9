"""The mesh of data/board.msh: a circuit board on four screws with a transformer, a connector and a processor.

Hexahedra of 20 nodes, one through the thickness; `python examples/board.py` writes it again. board.toml flies it.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
from bracket import divided, hexahedra

HERE = Path(__file__).parent
LENGTH, WIDTH, THICKNESS, CELL = 160.0, 100.0, 1.6, 10.0  # mm
# Footprints, mm: from and to along x and y. A screw holds the cell in each corner.
COMPONENTS = {
    "transformer": ((60.0, 100.0), (30.0, 70.0)),
    "connector": ((0.0, 20.0), (30.0, 70.0)),
    "processor": ((120.0, 150.0), (40.0, 70.0)),
}


def mesh() -> meshio.Mesh:
    """The board in mm, its lower face on z = 0; groups are the solid `board`, `screws` below and components on top."""
    cells = int(LENGTH / CELL), int(WIDTH / CELL)
    points, solids = hexahedra(divided(0, LENGTH, cells[0]), divided(0, WIDTH, cells[1]), divided(0, THICKNESS, 1))
    used, number = np.unique(solids, return_inverse=True)
    points, solids = points[used], number.reshape(-1, 20)
    middle = points[solids].mean(axis=1)
    edge = [(each < CELL) | (each > size - CELL) for each, size in ((middle[:, 0], LENGTH), (middle[:, 1], WIDTH))]
    below, above = [0, 1, 2, 3, 8, 9, 10, 11], [4, 5, 6, 7, 12, 13, 14, 15]
    blocks, tags = [("hexahedron20", solids)], [np.full(len(solids), 1)]
    groups = {"board": np.array([1, 3])}
    for name, faces, chosen in (
        ("screws", below, edge[0] & edge[1]),
        *((c, above, over(middle, c)) for c in COMPONENTS),
    ):
        groups[name] = np.array([len(groups) + 1, 2])
        blocks.append(("quad8", solids[chosen][:, faces]))
        tags.append(np.full(int(chosen.sum()), groups[name][0]))
    return meshio.Mesh(points, blocks, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups)


def over(middle: np.ndarray, component: str) -> np.ndarray:
    """Elements below a component."""
    spans = COMPONENTS[component]
    inside = [(middle[:, i] > low) & (middle[:, i] < high) for i, (low, high) in enumerate(spans)]
    return np.logical_and(*inside)


if __name__ == "__main__":
    meshio.write(HERE / "data" / "board.msh", mesh(), file_format="gmsh22", binary=False)
