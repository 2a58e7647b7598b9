"""The meshes of data/board.msh and data/board_on_rails.msh: a circuit board with a transformer, a connector and a
processor, on four screws, or with edges that slide in rails up to a plug.

Shells of eight nodes in the board's middle; `python examples/board.py` writes them again, and prints what hexahedra in
their place would change. board.toml, board_on_rails.toml and board_warms_up.toml fly them.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
from bracket import Floats, divided, hexahedra

import gbeam as gb

HERE = Path(__file__).parent
LENGTH, WIDTH, THICKNESS, CELL = 160.0, 100.0, 1.6, 10.0  # mm
# Footprints, mm: from and to along x and y. A screw holds the cell in each corner.
FOOTPRINTS = {
    "transformer": ((60.0, 100.0), (30.0, 70.0)),
    "connector": ((0.0, 20.0), (30.0, 70.0)),
    "processor": ((120.0, 150.0), (40.0, 70.0)),
}
GROUPS = ("board", "screws", *FOOTPRINTS)
MASSES = {"transformer": 0.14, "connector": 0.035, "processor": 0.06}  # kg
LAMINATE = gb.Orthotropic(
    density=1900,
    youngs_moduli=(22e9, 19e9, 8e9),
    poissons_ratios=(0.15, 0.3, 0.3),
    shear_moduli=(4e9, 2.5e9, 2.5e9),
    axes=((1, 0, 0), (0, 1, 0)),
)


def mesh(size: float = CELL) -> meshio.Mesh:
    """The board in mm, its middle on z = 0, of shells; a group is what is not below a component or held by a screw."""
    points, cells = block(size)
    shells = cells[:, [0, 1, 2, 3, 8, 9, 10, 11]]
    used, nodes = np.unique(shells, return_inverse=True)
    nodes, points = nodes.reshape(shells.shape), points[used] * (1, 1, 0)
    tags = [1 + group_of(points[nodes].mean(axis=1))]
    names = {name: np.array([i, 2]) for i, name in enumerate(GROUPS, 1)}
    return meshio.Mesh(points, [("quad8", nodes)], cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
                       field_data=names)  # fmt: skip


def on_rails(size: float = CELL) -> meshio.Mesh:
    """The board in mm without screws, and lines along its edges: two rails and the plug, at x = 0."""
    board = mesh(size)
    points, nodes = board.points, board.cells[0].data
    groups = [name for name in GROUPS if name != "screws"]
    numbers = [1 + groups.index(name if name in groups else "board") for name in GROUPS]
    tags = np.array(numbers)[board.cell_data["gmsh:physical"][0] - 1]
    lines, of_line = [], []
    sides = np.concatenate([nodes[:, [i, (i + 1) % 4, 4 + i]] for i in range(4)])
    edges = {"left_rail": (1, 0.0), "right_rail": (1, WIDTH), "plug": (0, 0.0)}
    for k, (axis, at) in enumerate(edges.values()):
        on = sides[np.isclose(points[sides][..., axis], at).all(axis=1)]
        lines.append(on)
        of_line.append(np.full(len(on), 1 + len(groups) + k))
    names = {name: np.array([i, 2]) for i, name in enumerate(groups, 1)}
    names |= {name: np.array([1 + len(groups) + k, 1]) for k, name in enumerate(edges)}
    tagged = [tags, np.concatenate(of_line)]
    cells = [("quad8", nodes), ("line3", np.concatenate(lines))]
    return meshio.Mesh(points, cells, cell_data={"gmsh:physical": tagged, "gmsh:geometrical": tagged}, field_data=names)


def solids(size: float = CELL) -> meshio.Mesh:
    """The board of hexahedra of 20 nodes, its middle on z = 0; groups have the nodes of the whole thickness."""
    points, nodes = block(size)
    group = group_of(points[nodes].mean(axis=1))
    sets = {name: np.unique(nodes[group == i]) for i, name in enumerate(GROUPS)}
    return meshio.Mesh(points, {"hexahedron20": nodes}, point_sets=sets)


def block(size: float) -> tuple[Floats, np.ndarray]:
    """Points and hexahedra of 20 nodes."""
    lines = divided(0, LENGTH, round(LENGTH / size)), divided(0, WIDTH, round(WIDTH / size))
    points, cells = hexahedra(*lines, divided(-THICKNESS / 2, THICKNESS / 2, 1))
    used, nodes = np.unique(cells, return_inverse=True)
    return points[used], nodes.reshape(cells.shape)


def group_of(middle: Floats) -> np.ndarray:
    """Numbers in GROUPS of elements by their middles (e, 3)."""
    x, y = middle[:, 0], middle[:, 1]
    group = np.where((np.abs(x - LENGTH / 2) > LENGTH / 2 - CELL) & (np.abs(y - WIDTH / 2) > WIDTH / 2 - CELL), 1, 0)
    for name, ((left, right), (front, back)) in FOOTPRINTS.items():
        group[(x > left) & (x < right) & (y > front) & (y < back)] = GROUPS.index(name)
    return group


def lowest(board: meshio.Mesh, **more: float) -> str:
    """The lowest frequencies of a mesh with its components."""
    solid = gb.SolidMesh.read(board, materials=LAMINATE, clamp="screws", unit="mm", point_masses=MASSES, **more)
    frequency = solid.reduced(modes=4, damping_ratio=0.02).frequency
    return f"{len(np.unique(solid.numbers)):5} nodes: " + ", ".join(f"{each:.2f}" for each in frequency) + " Hz"


def main() -> None:
    """Write the mesh, and print what other ones give."""
    for name, board in (("board", mesh()), ("board_on_rails", on_rails())):
        meshio.write(HERE / "data" / f"{name}.msh", board, file_format="gmsh22", binary=False)
    for size in (CELL, CELL / 2):
        print(f"{size:g} mm, shells,    ", lowest(mesh(size), thickness=1e-3 * THICKNESS))
        print(f"{size:g} mm, hexahedra, ", lowest(solids(size)))


if __name__ == "__main__":
    main()
