"""A camera on a bent bracket in the F-16's turn: the mesh of data/bracket.msh, its modes, response and stress.

The mesh, hexahedra of 20 nodes, is made here: `python examples/bracket.py` writes it again, prints how the bracket
moves and where its stress is largest, and writes out/bracket/stress.png and a page, stress.html.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

import gbeam as gb

Floats = NDArray[np.float64]
HERE = Path(__file__).parent
MATERIALS = {
    "bracket": gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33, yield_strength=240e6),
    "camera": gb.Material(density=3300, youngs_modulus=70e9, poissons_ratio=0.33),
}
FOOT, RADIUS, ARM, WIDTH, THICKNESS = 40.0, 12.0, 72.0, 50.0, 3.0  # mm, along the middle of the sheet
CAMERA = 24.0, 50.0  # mm of the arm's end, and how far the camera stands out
# Nodes of a hexahedron of 20, in halves of its edges along x, y and z.
NODES = 0, 200, 220, 20, 2, 202, 222, 22, 100, 210, 120, 10, 102, 212, 122, 12, 1, 201, 221, 21


def mesh(coarser: int = 1) -> meshio.Mesh:
    """The bracket in mm: its foot on the plane z = 0, along x, is screwed down; its arm rises along z to the camera.

    Groups are the solids `bracket` and `camera`, and `screwed`, the lower face of the foot's first 30 mm.
    """
    turn, half = RADIUS * np.pi / 2, THICKNESS / 2
    corners, end = np.cumsum([0.0, FOOT, turn, ARM]), FOOT + turn + ARM
    along = np.concatenate([divided(*corners[:2], 8 // coarser), divided(*corners[1:3], 6 // coarser)[1:],
                            divided(*corners[2:], 18 // coarser)[1:]])  # fmt: skip
    across = divided(-WIDTH / 2, WIDTH / 2, 4 // coarser)
    sheet, cells = hexahedra(along, across, divided(-half, half, 2 // coarser))
    camera, more = hexahedra(
        along[along > end - CAMERA[0] - 1e-9], across, divided(-half - CAMERA[1], -half, 4 // coarser)
    )
    flat = np.concatenate([sheet, camera])
    used, number = np.unique(np.concatenate([cells, more + len(sheet)]), return_inverse=True)
    _, first, same = np.unique(np.round(flat[used], 6), axis=0, return_index=True, return_inverse=True)
    flat, cells = flat[used][first], same[number].reshape(-1, 20)
    faces = cells[:, [0, 1, 2, 3, 8, 9, 10, 11]]
    low = (flat[faces, 2] == -half).all(axis=1) & (flat[faces, 0] <= 30 + 1e-9).all(axis=1)
    blocks = [("hexahedron20", cells), ("quad8", faces[low])]
    tags = [np.where(np.arange(len(cells)) < len(cells) - len(more), 1, 2), np.full(low.sum(), 3)]
    groups = {"bracket": np.array([1, 3]), "camera": np.array([2, 3]), "screwed": np.array([3, 2])}
    return meshio.Mesh(
        bent(*flat.T), blocks, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups
    )


def divided(start: float, end: float, cells: int) -> Floats:
    """Places of the nodes of so many cells, their middles too."""
    return np.linspace(start, end, 2 * cells + 1)


def hexahedra(s: Floats, y: Floats, t: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Points (k, 3) of a grid and its hexahedra of 20 nodes (e, 20), of which some points are no nodes."""
    grid = np.stack(np.meshgrid(s, y, t, indexing="ij"), axis=-1)
    first = np.stack(np.meshgrid(*(np.arange(0, n - 1, 2) for n in grid.shape[:3]), indexing="ij"), axis=-1)
    offsets = np.array([[int(each) for each in f"{node:03}"] for node in NODES])
    nodes = np.moveaxis(first.reshape(-1, 1, 3) + offsets, -1, 0)
    return grid.reshape(-1, 3), np.ravel_multi_index(tuple(nodes), grid.shape[:3])


def bent(s: Floats, y: Floats, t: Floats) -> Floats:
    """Places of points at s along the sheet, y across it and t above its middle, mm."""
    angle = np.clip((s - FOOT) / RADIUS, 0, np.pi / 2)
    rise = np.maximum(s - FOOT - RADIUS * np.pi / 2, 0)
    x = np.minimum(s, FOOT) + (RADIUS - t) * np.sin(angle)
    return np.stack([x, y, RADIUS - (RADIUS - t) * np.cos(angle) + rise + THICKNESS / 2], axis=1)


def model(source: Any, coarser: gb.SolidModel | None = None) -> gb.SolidModel:
    """The bracket of a mesh with its camera, in eight modes and its static shapes."""
    solid = gb.SolidMesh.read(source, materials=MATERIALS, clamp="screwed", unit="mm")
    return solid.reduced(modes=8, damping_ratio=0.02, kind="bracket", coarser=coarser)


def flight() -> gb.Flight:
    """The F-16's turn of 8 g, of which the bracket's foot feels what the strip's root does."""
    return gb.read_scenario(HERE / "f16_8g_turn.toml").motions["flight"]


def main() -> None:
    """Write the mesh, the picture and the page, and print the modes, the response and the stress."""
    meshio.write(HERE / "data" / "bracket.msh", mesh(), file_format="gmsh22", binary=False)
    bracket = model(HERE / "data" / "bracket.msh", coarser=model(mesh(coarser=2)))
    print(bracket.mesh, bracket, sep="\n")
    run = gb.simulate(bracket.structure, flight(), duration=15.99, step=1e-3, integrator="gauss", name="flight")
    stress = bracket.stress(run)
    print(run, stress, sep="\n")
    folder = HERE.parent / "out" / "bracket"
    folder.mkdir(parents=True, exist_ok=True)
    stress.plot()[0].figure.savefig(folder / "stress.png")
    stress.report(folder / "stress.html")


if __name__ == "__main__":
    main()
