"""Meshes in files of Exodus II: netCDF with blocks of elements, sets of nodes, and sets of sides of elements."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.guards.hdf5_files import open_hdf5
from gbeam.solids.shape_functions import DIMENSIONS, EXODUS_ORDER, KINDS, SHAPES
from gbeam.solids.stress import corners_of, face_nodes
from gbeam.solids.texts import Cells, TextMesh

ENDINGS = (".e", ".ex2", ".exo", ".g", ".gen")
CLASSIC = b"CDF"  # begins a file of netCDF 3; that of netCDF 4 is one of HDF5
_READ = re.compile(r"coord[xyz]?|connect\d+|(node|elem)_num_map|(eb|ns|ss)_(names|prop1)|node_ns\d+|(elem|side)_ss\d+")
_DIMENSIONS = {"HEX": 3, "TET": 3, "WED": 3, "PYR": 3, "SHE": 2, "QUA": 2, "TRI": 2, "BAR": 1, "BEA": 1, "TRU": 1,
               "EDG": 1, "SPH": 0, "CIR": 0}  # fmt: skip
# Sides of solids by the faces of Abaqus, by their corners: Exodus has first those that stand on the edges of the base.
_SIDES = {4: (1, 2, 3, 0), 6: (2, 3, 4, 0, 1), 8: (2, 3, 4, 5, 0, 1)}
_NOUNS = {"eb": "block", "ns": "node set", "ss": "side set"}


class _Variable(NamedTuple):
    """Values of a variable and, where they are nodes of elements, the type of these."""

    values: Any
    element_type: str


def read_exodus(path: Path) -> TextMesh:
    """Read a mesh whose groups are its blocks and sets, by their names or as `block 1`, `node set 1`, `side set 1`."""
    read = _classic if path.read_bytes()[:3] == CLASSIC else _hdf5_variables
    stored, mesh = read(path), TextMesh()
    coordinates = [stored[f"coord{axis}"].values for axis in "xyz" if f"coord{axis}" in stored]
    places = np.array(coordinates or stored["coord"].values, dtype=float)
    if len(places) != 3:
        raise ValueError(f"its nodes have {len(places)} coordinates")
    mesh.nodes = dict(zip(_numbers(stored, "node", places.shape[1]), places.T.tolist(), strict=True))
    blocks = dict(_numbered(stored, "connect"))
    ends = np.cumsum([0, *(len(block.values) for block in blocks.values())])
    numbers = _numbers(stored, "elem", int(ends[-1]))
    for (k, (values, element_type)), first in zip(blocks.items(), ends, strict=False):
        kind = _kind(element_type, values.shape[1])
        nodes = np.asarray(values, dtype=int)[:, EXODUS_ORDER.get(kind, slice(None))] - 1
        named = np.array(numbers[first : first + len(nodes)], dtype=int)
        mesh.cells.append(Cells(kind, nodes, DIMENSIONS[kind], named))
        group = mesh.cell_sets.setdefault(_name(stored, "eb", k), [np.empty(0, dtype=int)] * len(blocks))
        group[len(mesh.cells) - 1] = np.arange(len(nodes))
    for k, (values, _) in _numbered(stored, "node_ns"):
        mesh.point_sets[_name(stored, "ns", k)] = np.unique(values) - 1
    types = [block.element_type for block in blocks.values()]
    for k, (values, _) in _numbered(stored, "elem_ss"):
        element, side = np.asarray(values, dtype=int) - 1, np.asarray(stored[f"side_ss{k}"].values, dtype=int)
        block = np.searchsorted(ends, element, side="right") - 1
        parts = [np.empty(0, dtype=int)]
        for i, number in np.unique(np.stack([block, side]), axis=1).T:
            cells, chosen = mesh.cells[i], element[(block == i) & (side == number)] - ends[i]
            parts.append(cells.data[chosen][:, _side_nodes(cells.type, types[i], int(number))].ravel())
        mesh.point_sets.setdefault(_name(stored, "ss", k), np.unique(np.concatenate(parts)))
    return mesh


def _classic(path: Path) -> dict[str, _Variable]:
    """Variables of a file of netCDF 3."""
    from scipy.io import netcdf_file  # 0.4 s to import

    with netcdf_file(path, mmap=False) as file:
        chosen = {name: variable for name, variable in file.variables.items() if _READ.fullmatch(name)}
        return {
            name: _Variable(variable.data.copy(), _text(getattr(variable, "elem_type", b"")))
            for name, variable in chosen.items()
        }


def _hdf5_variables(path: Path) -> dict[str, _Variable]:
    """Variables of a file of netCDF 4."""
    with open_hdf5(path) as file:
        chosen = {name: data for name, data in file.items() if _READ.fullmatch(name)}
        return {name: _Variable(data[()], _text(data.attrs.get("elem_type", b""))) for name, data in chosen.items()}


def _text(value: Any) -> str:
    """Text of an array of letters, or of a text, in bytes or not."""
    letters = np.ravel(value).tolist()
    decoded = (part.decode(errors="replace") if isinstance(part, bytes) else part for part in letters)
    return "".join(decoded).strip("\0 ")


def _numbered(stored: Mapping[str, _Variable], prefix: str) -> Iterator[tuple[int, _Variable]]:
    """Yield the variables whose names are a prefix and a number, with these numbers, in order."""
    matches = (re.fullmatch(rf"{prefix}(\d+)", name) for name in stored)
    for k in sorted(int(match[1]) for match in matches if match):
        yield k, stored[f"{prefix}{k}"]


def _numbers(stored: Mapping[str, _Variable], noun: str, count: int) -> list[int]:
    """Numbers of nodes or elements. They count from 1 where the file has none, or repeats one."""
    listed = stored[f"{noun}_num_map"].values.tolist() if f"{noun}_num_map" in stored else []
    return listed if len({*listed}) == count else list(range(1, count + 1))


def _name(stored: Mapping[str, _Variable], kind: str, k: int) -> str:
    """Name of a block or a set, the k-th from 1."""
    stated = _text(stored[f"{kind}_names"].values[k - 1]).partition("\0")[0] if f"{kind}_names" in stored else ""
    number = int(stored[f"{kind}_prop1"].values[k - 1]) if f"{kind}_prop1" in stored else k
    return stated.strip() or f"{_NOUNS[kind]} {number}"


def _kind(element_type: str, count: int) -> str:
    dim = _DIMENSIONS.get(element_type[:3].upper())
    if dim is None or count not in SHAPES[dim]:
        raise ValueError(f"elements of type {element_type} with {count} nodes are not known")
    return SHAPES[dim][count]


def _side_nodes(kind: str, element_type: str, side: int) -> Any:
    """Indices of an element's nodes on a side, by the side's number. They are all nodes where the element has no sides,
    or is of a kind that is not computed.
    """
    if DIMENSIONS[kind] == 3 and kind in KINDS:
        return face_nodes(kind, _SIDES[corners_of(kind)][side - 1])
    corners = 3 if kind.startswith("triangle") else 4
    faces = 2 if "SHELL" in element_type.upper() else 0  # the first sides of shells
    edge = side - 1 - faces
    if DIMENSIONS[kind] != 2 or edge < 0:
        return slice(None)
    middle = [corners + edge] if kind[-1].isdigit() else []
    return [edge, (edge + 1) % corners, *middle]
