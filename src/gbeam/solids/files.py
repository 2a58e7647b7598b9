"""Meshes in the files of other programs, read in a process of its own, and the skin by which a group is chosen."""

from __future__ import annotations

import contextlib
import io
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.parsers import expat

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.hdf5_files import open_hdf5
from gbeam.guards.limits import BINARY_BYTES, READER_BYTES, READER_SECONDS, in_bytes, refuse_large_file
from gbeam.guards.processes import read_cached
from gbeam.numerics.sparse import refuse_cost
from gbeam.printable import shortened
from gbeam.solids.cards import Cards, carrying, read_cards
from gbeam.solids.exodus import ENDINGS as EXODUS
from gbeam.solids.exodus import read_exodus
from gbeam.solids.foreign import elements_of, group_names, nodes_in, numbers_of, tags_of
from gbeam.solids.shape_functions import MED_ORDER
from gbeam.solids.shells import points_of
from gbeam.solids.stress import surface_of
from gbeam.solids.texts import TEXTS, Cells, TextMesh, ending_of, text_mesh

_IGES = "IGES, which holds surfaces and not the solid", "export the part as STEP"
_AS_ONE = "write it for Gmsh, as VTU or as MED"
_TETGEN = "TetGen's, which has its nodes and its elements in two files", _AS_ONE
_UNREAD = {
    ".iges": _IGES,
    ".igs": _IGES,
    ".cgns": ("CGNS, of which meshio reads no groups", "write it for Gmsh, Nastran, Abaqus, CalculiX or MED"),
    ".ele": _TETGEN,
    ".node": _TETGEN,
    ".xml": ("DOLFIN's, which has its groups in other files", _AS_ONE),
}
_XML, _HDF5 = (".xdmf", ".xmf"), (".med", ".h5m", ".hmf")  # endings
UNKNOWN_BYTES = 40  # of a file as text, of quadratic elements; binary files have 14 to 21, linear elements up to 74
# Of text, beyond what is allowed of any file: Python's numbers took 14 times the file of 389,000 nodes, and 0.1 s/MB.
TEXT_TIMES, TEXT_RATE = 20, 2**21
VERTICES = 20_000  # about: at which groups are still told apart
GROUPS = 200
SHEET = 1e-3  # thickness of a shell that is shown, of the size of the mesh


@dataclass
class FileMesh:
    """A mesh of a file with the fields of meshio's: places (k, 3), elements of each kind, groups of nodes and of
    elements by name, whole numbers of elements, and Gmsh's groups.

    Besides, it has the numbers (k,) of the nodes, the number of statements on mass, stiffness or constraints by their
    names, those statements that were read, and places of groups in words.
    """

    points: Floats
    cells: list[Cells]
    point_sets: dict[str, Indices]
    cell_sets: dict[str, list[Indices]]
    cell_data: dict[str, list[Indices]]
    field_data: dict[str, Indices]
    numbers: Indices
    carrying: dict[str, int]
    cards: Cards
    info: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_parts(cls, parts: Mapping[str, Any]) -> FileMesh:
        """Make a mesh of the parts that :func:`parts_of` returned in another process."""
        cells = [Cells(*values) for values in parts["cells"]]
        return cls(**{**parts, "cells": cells, "cards": Cards.from_parts(parts["numbers"], parts["cards"])})


def read_mesh(source: str | os.PathLike[str] | Any, *, cards: bool = False) -> Any:
    """Read the mesh in a file, and with `cards` its masses, links and springs. A mesh of meshio stays as it is."""
    if not isinstance(source, (str, os.PathLike)):
        return source
    path = os.fspath(source)
    _refuse_unread(path)
    size = os.path.getsize(path)
    if size > BINARY_BYTES:
        refuse_cost("mesh", size / UNKNOWN_BYTES, f"has {in_bytes(size)}, as files of meshes have with some")
    refuse_large_file("mesh", path, BINARY_BYTES, "mesh it more coarsely")

    def refuse(problem: str) -> InputError:
        return InputError("mesh", f"{path} {problem}", "mesh it more coarsely, or write it again")

    limits = dict[str, int]()
    if ending_of(path) in TEXTS:
        limits = {"memory": READER_BYTES + TEXT_TIMES * size, "seconds": READER_SECONDS + size // TEXT_RATE}
    return FileMesh.from_parts(read_cached(parts_of, path, cards, refuse=refuse, **limits))


def _refuse_unread(path: str) -> None:
    """Refuse a file that is empty, or of a format whose groups are not read or lie in other files."""
    unread = _UNREAD.get(ending_of(path))
    if unread is not None:
        raise InputError("mesh", f"{path} is {unread[0]}", unread[1])
    if not os.path.getsize(path):
        raise InputError("mesh", f"{path} is empty", "write it again")


def parts_of(path: str, cards: bool) -> dict[str, Any]:
    """Return the parts of the mesh in a file, plain values and arrays. InputError whatever is wrong with it."""
    printed = io.StringIO()
    try:
        # meshio prints what fails and exits.
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            mesh = _read(Path(path))
        points, text = np.asarray(mesh.points), isinstance(mesh, TextMesh)
        cells = zip(mesh.cells, numbers_of(mesh), strict=True)
        return {
            "points": points,
            "cells": [[block.type, _nodes_of(block), block.dim, numbers] for block, numbers in cells],
            "point_sets": {name: np.asarray(nodes, dtype=int) for name, nodes in mesh.point_sets.items()},
            "cell_sets": {
                name: [np.asarray([] if chosen is None else chosen, dtype=int) for chosen in members]
                for name, members in mesh.cell_sets.items()
            },
            "cell_data": {name: [np.asarray(tags) for tags in values] for name, values in tags_of(mesh).items()},
            "field_data": {name: np.asarray(pair) for name, pair in mesh.field_data.items() if np.shape(pair) == (2,)},
            "numbers": np.array([*mesh.nodes] if text else range(1, len(points) + 1), dtype=int),
            "carrying": carrying(mesh) if text else {},
            "cards": read_cards(path, mesh).parts() if cards and text else {},
        }
    except (InputError, MemoryError):
        raise
    except ModuleNotFoundError as error:  # what meshio reads some formats by
        raise InputError("", f"{error.name} is not installed", f'install it with: pip install "{error.name}"') from None
    except (Exception, SystemExit) as error:
        if error.args == ("wedge15",):
            fix = "write it for Gmsh as text, or for Nastran, Abaqus, CalculiX or Exodus"
            raise InputError("mesh", f"{path} has wedges of 15 nodes, which meshio lacks", fix) from None
        said = printed.getvalue().partition("Error: Couldn't read file")[0] if printed.getvalue() else str(error)
        words = shortened(" ".join(said.split()) or "it breaks off", 200)
        if isinstance(error, KeyError):
            noun = "number" if isinstance(error.args[0], int) else "set"
            listed = ending_of(path) in TEXTS
            words = f"{noun} {error.args[0]} is named in it, and is not there" if listed else f"meshio lacks {error}"
        fix = "give a file of Gmsh, Nastran, Abaqus, CalculiX, VTK or Exodus, with its ending"
        raise InputError("mesh", f"{path} cannot be read: {words}", fix) from None


def _nodes_of(block: Any) -> Indices:
    """Nodes (e, k) of the elements of a block. General polygons and polyhedra, whose elements have unlike numbers of
    nodes, count as having none.
    """
    return np.zeros((len(block.data), 0), int) if block.type.startswith("poly") else np.asarray(block.data)


def _read(path: Path) -> Any:
    """Read the mesh in a file by gbeam's readers of text and of Exodus, or by meshio."""
    mesh = text_mesh(path)
    if mesh is not None:
        return mesh
    ending = ending_of(path)
    if ending in EXODUS:
        return read_exodus(path)
    import meshio

    _refuse_node_0(path)
    if ending in _XML:
        _refuse_in_parts(path)
    if ending in _HDF5:
        with open_hdf5(path):  # which refuses a file with links to others
            pass
    mesh = meshio.read(path)
    return _with_masks(_adapt_med(mesh) if ending == ".med" else mesh)


def _refuse_node_0(path: Path) -> None:
    """Refuse a binary file of Gmsh 2 with a node 0, which meshio takes for the node with the largest number."""
    content = path.read_bytes() if path.suffix.lower() == ".msh" else b""
    binary = re.search(rb"\$MeshFormat\s+2\S* 1 ", content)
    head = re.compile(rb"\$Nodes\s+(\d+)\n").search(content, binary.end()) if binary else None
    if head:
        numbers = np.frombuffer(content, [("", "<i4"), ("", "<f8", 3)], int(head[1]), head.end())["f0"]
        if numbers.min() < 1:
            raise InputError("mesh", f"has node {numbers.min()}", "write it as text, or number its nodes from 1")


def _refuse_in_parts(path: Path) -> None:
    """Refuse an XML file that keeps its numbers in another file, or that defines entities.

    A result would not hold the other file, as XDMF may have it. A few lines of entities may make any amount of text.
    """
    inside, other = False, ""  # of an element that names another file, and the text in it

    def begin(_: str, attributes: Mapping[str, str]) -> None:
        nonlocal inside
        inside = inside or attributes.get("Format", "XML") != "XML"

    def text(data: str) -> None:
        nonlocal other
        other += data if inside and len(other) < 1000 else ""

    def end(_: str) -> None:
        if inside:
            problem = f"{path} keeps its numbers in {shortened(other.strip().rpartition(':')[0] or other.strip(), 100)}"
            raise InputError("mesh", problem, 'write one file: VTU, or XDMF with data_format="XML" of meshio')

    def refuse_entity(*_: Any) -> None:
        raise InputError("mesh", f"{path} defines entities", "write its text without them")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.CharacterDataHandler, parser.EndElementHandler = begin, text, end
    parser.EntityDeclHandler = refuse_entity
    with path.open("rb") as file:
        parser.ParseFile(file)


def _adapt_med(mesh: Any) -> Any:
    """Give a mesh of MED its groups by their names, and its elements the order of nodes of VTK.

    In MED elements and nodes belong to families, and a family belongs to any number of groups. Elements of negative
    volume are in MED's order. Meshio writes others in VTK's.
    """
    for block in mesh.cells:
        if block.type in MED_ORDER and len(block.data):
            corners = [0, 1, 3, 4] if "hexa" in block.type else [0, 1, 2, 3]
            first, *others = mesh.points[block.data[0, corners]]
            if np.linalg.det(others - first) < 0:
                block.data = block.data[:, MED_ORDER[block.type]]
    for tags, values, sets in (
        (getattr(mesh, "cell_tags", {}), mesh.cell_data.get("cell_tags"), mesh.cell_sets),
        (getattr(mesh, "point_tags", {}), [mesh.point_data.get("point_tags")], mesh.point_sets),
    ):
        for name in dict.fromkeys(name for names in tags.values() for name in names):
            families = [number for number, names in tags.items() if name in names]
            chosen = [np.flatnonzero(np.isin(family, families)) for family in values]
            sets[name] = chosen if sets is mesh.cell_sets else chosen[0]
    return mesh


def _with_masks(mesh: Any) -> Any:
    """Add the arrays of 0 and 1 of a mesh to its groups, by their names, as ParaView writes selections."""
    for sets, arrays in (
        (mesh.point_sets, {name: [values] for name, values in mesh.point_data.items()}),
        (mesh.cell_sets, mesh.cell_data),
    ):
        for name, values in arrays.items():
            masks = [np.asarray(mask) for mask in values]
            levels = {*np.unique(np.concatenate(masks)).tolist()} if all(mask.ndim == 1 for mask in masks) else set()
            if levels == {0, 1} and all(mask.dtype.kind in "iub" for mask in masks):
                chosen = [np.flatnonzero(mask) for mask in masks]
                sets.setdefault(name, chosen if sets is mesh.cell_sets else chosen[0])
    return mesh


def skin(path: str) -> dict[str, Any]:
    """Outer faces of a mesh file: vertices (v, 3) in its unit, triangles (f, 3), and a list of its groups.

    Each group has its name, the number of its nodes that belong to elements, and the indices of its vertices.
    """
    _refuse_unread(path)
    mesh = FileMesh.from_parts(parts_of(path, False))
    points = np.asarray(mesh.points, dtype=float)
    no_solids = not any(block.dim == 3 and len(block.data) for block in mesh.cells) and points.size
    elements = elements_of(mesh, SHEET * float(np.ptp(points)) if no_solids else None)
    used = np.unique(np.concatenate([block.nodes.ravel() for block in elements]))
    if points.ndim != 2 or points.shape[1] != 3 or used[-1] >= len(points) or not np.isfinite(points[used]).all():
        raise InputError("mesh", "has elements whose nodes have no place in space", "write it again")
    points, numbers, nodes_of = points_of(points, elements)
    blocks = [block._replace(nodes=inside) for block, inside in zip(elements, nodes_of, strict=True)]
    outer, triangles = surface_of(SimpleNamespace(points=points, blocks=blocks), VERTICES)
    groups = list[dict[str, Any]]()
    seen = set[bytes]()
    for name in group_names(mesh)[:GROUPS]:
        try:
            inside = np.intersect1d(nodes_in(mesh, "clamp", name), used)
        except InputError:  # a name without elements
            continue
        if len(inside) and inside.tobytes() not in seen:  # another name, or tag, of the same nodes is left out
            groups.append(
                {"name": name, "nodes": len(inside), "vertices": np.flatnonzero(np.isin(numbers[outer], inside))}
            )
            seen.add(inside.tobytes())
    return {"vertices": points[outer].astype(np.float32), "triangles": triangles, "groups": groups}
