"""Skin of a mesh: its outer faces, and which of them its groups hold, for whoever chooses groups by sight."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.results.result import Floats
from gbeam.solids.foreign import elements_of, group_names, nodes_in, read_mesh
from gbeam.solids.shape_functions import Indices
from gbeam.solids.shells import points_of
from gbeam.solids.stress import surface_of

# Ends of the names of files that hold meshes, also of surfaces and of geometry, of which the reader says what lacks.
MESHES = {
    ".avs", ".bdf", ".cgns", ".e", ".ex2", ".exo", ".fem", ".inp", ".mdpa", ".med", ".mesh", ".meshb", ".msh", ".nas",
    ".su2", ".ugrid", ".vtk", ".vtu", ".iges", ".igs", ".obj", ".ply", ".step", ".stl", ".stp",
}  # fmt: skip
VERTICES = 20_000  # about: at which groups are still told apart
GROUPS = 200
SHEET = 1e-3  # thickness of a shell that is shown, of the size of the mesh


class _Part(NamedTuple):
    kind: str
    nodes: Indices


class _Solid(NamedTuple):
    points: Floats
    blocks: list[_Part]


def is_mesh(name: str) -> bool:
    """Whether a file holds a mesh, by the end of its name."""
    return Path(name).suffix.lower() in MESHES


def skin(path: str) -> dict[str, Any]:
    """Vertices (v, 3) and triangles (f, 3) of the outer faces, in the file's unit, and the groups: their names, how
    many nodes of elements they hold, and which vertices.
    """
    mesh = read_mesh(path)
    points = np.asarray(mesh.points, dtype=float)
    flat = not any(block.dim == 3 and len(block.data) for block in mesh.cells) and points.size
    elements = elements_of(mesh, SHEET * float(np.ptp(points)) if flat else None)
    used = np.unique(np.concatenate([each.nodes.ravel() for each in elements]))
    if points.ndim != 2 or points.shape[1] != 3 or used[-1] >= len(points) or not np.isfinite(points[used]).all():
        raise InputError("mesh", "has elements whose nodes have no place in space", "write it again")
    points, numbers, nodes_of = points_of(points, elements)
    blocks = [_Part(each.kind, nodes) for each, nodes in zip(elements, nodes_of, strict=True)]
    nodes, triangles = surface_of(_Solid(points, blocks), VERTICES)
    groups = list[dict[str, Any]]()
    seen = set[bytes]()
    for name in group_names(mesh)[:GROUPS]:
        try:
            inside = np.intersect1d(nodes_in(mesh, "clamp", name), used)
        except InputError:  # a name without elements
            continue
        if len(inside) and inside.tobytes() not in seen:  # a number that is a name's too is left out
            groups.append(
                {"name": name, "nodes": len(inside), "vertices": np.flatnonzero(np.isin(numbers[nodes], inside))}
            )
            seen.add(inside.tobytes())
    return {"vertices": points[nodes].astype(np.float32), "triangles": triangles, "groups": groups}
