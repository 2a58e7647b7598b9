"""Meshes in the files of other programs, and the groups in them, by meshio."""

from __future__ import annotations

import contextlib
import io
import os
from collections import Counter
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import BINARY_BYTES, refuse_large_file
from gbeam.printable import shortened
from gbeam.solids.elements import KINDS, Indices

_INTERNAL = "gmsh:"  # begins the names of sets that nobody gave
_ENTITIES = "gmsh:geometrical"


def read_mesh(source: str | os.PathLike[str] | Any) -> Any:
    """Return meshio's mesh in a file, or the mesh itself."""
    if not isinstance(source, (str, os.PathLike)):
        return source
    try:
        import meshio
    except ModuleNotFoundError:
        raise InputError("", "meshio is not installed", 'install it with: pip install "gbeam[mesh]"') from None
    refuse_large_file("mesh", source, BINARY_BYTES, "mesh it more coarsely")
    said = io.StringIO()
    try:
        # It prints what fails and exits.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            return meshio.read(source)
    except (Exception, SystemExit) as error:
        words = shortened(" ".join((said.getvalue() or str(error)).split()), 200)
        fix = "give a file of Gmsh, Nastran, Abaqus, CalculiX or VTK, with its ending"
        raise InputError("mesh", f"{os.fspath(source)} cannot be read: {words}", fix) from None


def solid_blocks(mesh: Any) -> list[int]:
    """Numbers of the blocks of solid elements; an InputError where there are none, or some of another kind."""
    counts: Counter[str] = Counter()
    for block in mesh.cells:
        counts[block.type] += len(block.data)
    solids = [i for i, block in enumerate(mesh.cells) if block.dim == 3 and len(block.data)]
    if not solids:
        listed = ", ".join(f"{n} of kind {kind}" for kind, n in counts.items() if n) or "none at all"
        raise InputError("mesh", f"has no solid elements: {listed}", "mesh the volume, not its surface")
    for i in solids:
        kind = mesh.cells[i].type
        if kind not in KINDS:
            raise InputError("mesh", f"has {counts[kind]} elements of kind {kind}", f"use {', '.join(KINDS)}")
    return solids


def group_names(mesh: Any) -> list[str]:
    """Names of all groups of nodes and elements."""
    names = [*mesh.point_sets, *mesh.cell_sets, *mesh.field_data]
    for values in _tags(mesh):
        names += [str(tag) for tag in sorted({int(tag) for block in values for tag in np.unique(block)})]
    return list(dict.fromkeys(name for name in names if not name.startswith(_INTERNAL)))


def elements_in(mesh: Any, name: str) -> list[Indices] | None:
    """Elements of a group in each block of the mesh; None where it is none of elements."""
    if name in mesh.cell_sets:
        return [np.asarray([] if each is None else each, dtype=int) for each in mesh.cell_sets[name]]
    tag = mesh.field_data.get(name)
    for values in _tags(mesh):
        if tag is None and name.lstrip("-").isdigit():
            chosen = [np.flatnonzero(np.asarray(each) == int(name)) for each in values]
        elif tag is not None:
            chosen = [
                np.flatnonzero((np.asarray(each) == int(tag[0])) & (block.dim == int(tag[1])))
                for each, block in zip(values, mesh.cells, strict=True)
            ]
        else:
            continue
        if any(map(len, chosen)):
            return chosen
    return None


def nodes_in(mesh: Any, where: str, name: str) -> Indices:
    """Nodes of a group, of nodes or of elements; an InputError where there is none."""
    if name in mesh.point_sets:
        return np.unique(np.asarray(mesh.point_sets[name], dtype=int))
    elements = elements_in(mesh, name)
    if elements is None:
        raise no_group(mesh, where, name)
    parts = [block.data[each].ravel() for block, each in zip(mesh.cells, elements, strict=True)]
    return np.unique(np.concatenate(parts))


def no_group(mesh: Any, where: str, name: str) -> InputError:
    """Error of a group that is not in the mesh."""
    names = group_names(mesh)
    known = f"choose from {shortened(', '.join(names), 200)}" if names else "the mesh has no groups: name some in it"
    return InputError(where, f"is {name!r}, which is no group of the mesh", known)


def _tags(mesh: Any) -> list[list[Any]]:
    """Whole numbers of the elements, such as physical groups or properties, block by block."""
    return [
        values
        for name, values in mesh.cell_data.items()
        if name != _ENTITIES
        and all(np.asarray(each).ndim == 1 and np.asarray(each).dtype.kind in "iu" for each in values)
    ]
