"""Meshes in files of Exodus II, written by its manual (SAND92-2137), in netCDF 3 and 4."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file

import gbeam as gb

from .bodies import BOTTOM, CORNERS, STEEL, TOP, UPRIGHT, block, elements, solid

pytestmark = pytest.mark.usefixtures("reading_in_process")

# Nodes of hexahedra, in halves of their edges, and corners of sides, from 1.
MIDDLES = [(1, 1, 1), (1, 1, 0), (1, 1, 2), (0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1)]
HEXAHEDRON = np.array([*CORNERS, *BOTTOM, *UPRIGHT, *TOP, *MIDDLES])
EDGES = {4: [(1, 2), (2, 3), (1, 3), (1, 4), (2, 4), (3, 4)],
         6: [(1, 2), (2, 3), (1, 3), (1, 4), (2, 5), (3, 6), (4, 5), (5, 6), (4, 6)]}  # fmt: skip
SIDES = {4: [(1, 2, 4), (2, 3, 4), (1, 4, 3), (1, 3, 2)],
         6: [(1, 2, 5, 4), (2, 3, 6, 5), (1, 4, 6, 3), (1, 3, 2), (4, 5, 6)],
         8: [(1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (1, 5, 8, 4), (1, 4, 3, 2), (5, 6, 7, 8)]}  # fmt: skip
TYPES = {"tetra": "TETRA4", "tetra10": "TETRA10", "wedge": "WEDGE", "wedge15": "WEDGE15", "hexahedron": "HEX",
         "hexahedron20": "HEX20", "hexahedron27": "HEX27", "quad8": "SHELL8"}  # fmt: skip
LIGHT = gb.Material(density=1850, youngs_modulus=45e9, poissons_ratio=0.3)
STRIP = (0.2, 0.03, 0.01)


def corners_of(kind: str) -> int:
    return {"t": 4, "w": 6, "h": 8}[kind[0]]


def reordered(kind: str) -> list[int]:
    """Places in meshio's order of the nodes in that of Exodus."""
    (first, *_), count = elements(kind), corners_of(kind)
    if count == 8:
        wanted = HEXAHEDRON[: len(first)]
    else:
        middles = [(first[i - 1] + first[j - 1]) // 2 for i, j in EDGES[count]]
        wanted = np.array([*first[:count], *middles])[: len(first)]
    return [int(np.flatnonzero((first == each).all(axis=1))[0]) for each in wanted]


def named(names: list[str]) -> np.ndarray:
    return np.array([list(each.ljust(33, "\0").encode("ascii")) for each in names], dtype=np.uint8).view("S1")


def write(path: Path, variables: dict[str, tuple[Any, str]], classic: bool) -> Path:
    """Write variables, and the types of elements."""
    if classic:
        with netcdf_file(path, "w") as file:
            for name, (value, of) in variables.items():
                array = np.asarray(value)
                array = array.astype("i4") if array.dtype.kind == "i" else array
                dims = [f"{name}_{k}" for k in range(array.ndim)]
                for dim, size in zip(dims, array.shape, strict=True):
                    file.createDimension(dim, size)
                file.createVariable(name, array.dtype.char if array.dtype.kind != "S" else "c", dims)[:] = array
                if of:
                    file.variables[name].elem_type = of
    else:
        with h5py.File(path, "w") as file:
            for name, (value, of) in variables.items():
                file[name] = value
                if of:
                    file[name].attrs["elem_type"] = np.bytes_(of)
    return path


def parts(kind: str) -> dict[str, tuple[Any, str]]:
    """A strip of two blocks, the first by its name, with a set of nodes and one of sides, which has no name."""
    mesh = block(kind, (4, 2, 1), STRIP)
    cells = np.array(mesh.cells[0].data)
    used, flat = np.unique(cells, return_inverse=True)
    points, cells = mesh.points[used], flat.reshape(cells.shape)
    inner = points[cells].mean(axis=1)[:, 0] < STRIP[0] / 2
    cells = np.concatenate([cells[inner], cells[~inner]])[:, reordered(kind)] + 1
    wall = np.flatnonzero(points[:, 0] == 0)
    sides = [(e + 1, s + 1) for e, nodes in enumerate(cells) for s, side in enumerate(SIDES[corners_of(kind)])
             if (points[nodes[np.array(side) - 1] - 1, 0] == 0).all()]  # fmt: skip
    element, side = np.transpose(sides)
    return {
        "coordx": (points[:, 0], ""), "coordy": (points[:, 1], ""), "coordz": (points[:, 2], ""),
        "connect1": (cells[: inner.sum()], TYPES[kind]), "connect2": (cells[inner.sum() :], TYPES[kind]),
        "eb_names": (named(["root", ""]), ""), "eb_prop1": (np.array([10, 20]), ""),
        "ns_names": (named(["held"]), ""), "ns_prop1": (np.array([1]), ""), "node_ns1": (wall + 1, ""),
        "ss_prop1": (np.array([7, 8]), ""), "elem_ss1": (element, ""), "side_ss1": (side, ""),
        "elem_ss2": (side[:0], ""), "side_ss2": (side[:0], ""), "ss_names": (named(["", "none"]), ""),
        "node_num_map": (100 + np.arange(len(points)), ""), "elem_num_map": (500 + np.arange(len(cells)), ""),
    }  # fmt: skip


@pytest.mark.parametrize("classic", [True, False])
@pytest.mark.parametrize("kind", [kind for kind in TYPES if kind != "quad8"])
def test_blocks_are_materials_and_sets_clamps(tmp_path: Path, kind: str, classic: bool) -> None:
    """The strip's frequencies are those of the same mesh without a file, by either clamp; nodes keep their numbers."""
    path = write(tmp_path / "strip.exo", parts(kind), classic)
    mesh = block(kind, (4, 2, 1), STRIP)
    inner = mesh.points[np.array(mesh.cells[0].data)].mean(axis=1)[:, 0] < STRIP[0] / 2
    mesh.cell_sets = {"root": [np.flatnonzero(inner)], "end": [np.flatnonzero(~inner)]}
    truth = solid(mesh, {"root": STEEL, "end": LIGHT}).reduced(modes=3, damping_ratio=0).frequency
    materials = {"root": STEEL, "block 20": LIGHT}
    for clamp in ("held", "side set 7"):
        read = gb.SolidMesh.read(path, materials=materials, clamp=clamp, unit="m")
        np.testing.assert_allclose(read.reduced(modes=3, damping_ratio=0).frequency, truth, rtol=1e-8)
        assert read.numbers.min() == 100 and min(each.numbers.min() for each in read.blocks) == 500
    with pytest.raises(gb.InputError, match="choose from held, side set 7, none, root, block 20"):
        gb.SolidMesh.read(path, materials=materials, clamp="wall", unit="m")


def test_sides_of_shells_are_their_faces_and_edges(tmp_path: Path) -> None:
    """The third side of a shell is its first edge, with the middle of it; those of a panel of quadrilaterals too."""
    places = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]) * 0.05
    points = np.column_stack([places, np.zeros(8)])
    cells = np.arange(1, 9)[None]
    for of, side in (("SHELL8", 6), ("QUAD8", 4)):
        variables: dict[str, tuple[Any, str]] = {
            "coord": (points.T, ""), "connect1": (cells, of), "elem_ss1": (np.array([1]), ""),
            "side_ss1": (np.array([side]), ""),
        }  # fmt: skip
        path = write(tmp_path / f"{of}.e", variables, False)
        read = gb.SolidMesh.read(path, materials=STEEL, clamp="side set 1", unit="m", thickness=1e-3)
        assert sorted(set(read.numbers[read.clamped].tolist())) == [1, 4, 8]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"connect1": (np.ones((1, 9), dtype=int), "HEX9")}, "elements of type HEX9 with 9 nodes are not known"),
        ({"connect1": (np.ones((1, 3), dtype=int), "NSIDED")}, "elements of type NSIDED with 3 nodes are not known"),
        ({"coordz": None}, "its nodes have 2 coordinates"),
    ],
)
def test_what_cannot_be_read_is_said(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    variables = {name: each for name, each in (parts("tetra") | change).items() if each is not None}
    with pytest.raises(gb.InputError, match=words):
        gb.SolidMesh.read(write(tmp_path / "a.e", variables, True), materials=STEEL, clamp="held", unit="m")
