"""Skin of a mesh: its outer faces, and which of them its groups hold, for whoever chooses groups by sight."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.results.result import Floats
from gbeam.solids.elements import Indices
from gbeam.solids.foreign import group_names, nodes_in, read_mesh, solid_blocks
from gbeam.solids.stress import surface_of

# Ends of the names of files that hold meshes, also of surfaces and of geometry, of which the reader says what lacks.
MESHES = {
    *(
        ".avs",
        ".bdf",
        ".cgns",
        ".e",
        ".ex2",
        ".exo",
        ".fem",
        ".inp",
        ".mdpa",
        ".med",
        ".mesh",
        ".meshb",
        ".msh",
        ".nas",
    ),
    *(".su2", ".ugrid", ".vtk", ".vtu", ".iges", ".igs", ".obj", ".ply", ".step", ".stl", ".stp"),
}
VERTICES = 20_000  # about: at which groups are still told apart
GROUPS = 200


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
    many nodes of solid elements they hold, and which vertices.
    """
    mesh = read_mesh(path)
    blocks = [_Part(mesh.cells[i].type, np.asarray(mesh.cells[i].data)) for i in solid_blocks(mesh)]
    points = np.asarray(mesh.points, dtype=float)
    used = np.unique(np.concatenate([each.nodes.ravel() for each in blocks]))
    if points.ndim != 2 or points.shape[1] != 3 or used[-1] >= len(points) or not np.isfinite(points[used]).all():
        raise InputError("mesh", "has elements whose nodes have no place in space", "write it again")
    nodes, triangles = surface_of(_Solid(points, blocks), VERTICES)
    groups = list[dict[str, Any]]()
    seen = set[bytes]()
    for name in group_names(mesh)[:GROUPS]:
        try:
            inside = np.intersect1d(nodes_in(mesh, "clamp", name), used)
        except InputError:  # a name without elements
            continue
        if len(inside) and inside.tobytes() not in seen:  # a number that is a name's too is left out
            groups.append({"name": name, "nodes": len(inside), "vertices": np.flatnonzero(np.isin(nodes, inside))})
            seen.add(inside.tobytes())
    return {"vertices": points[nodes].astype(np.float32), "triangles": triangles, "groups": groups}
