"""Matrices and nodes of finite element programs: Nastran by pyyeti, Abaqus and CalculiX."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.arrays import Contents, mirrored, sparse_parts

INSTALL = 'install it with: pip install "gbeam[nastran]"'


def _pyyeti() -> Any:
    try:
        from pyyeti.nastran import bulk, n2p, op2, op4
    except ModuleNotFoundError:
        raise InputError("", "pyyeti is not installed", INSTALL) from None
    return bulk, n2p, op2, op4


def read_op4(path: str) -> Contents:
    """Read matrices of an OUTPUT4 file, text or binary."""
    *_, op4 = _pyyeti()
    matrices = {}
    for name, matrix in op4.read(path, sparse=None).items():
        matrices[name.upper()] = _parts(matrix)
    return {"matrices": matrices}


def read_op2(path: str) -> Contents:
    """Read matrices of an OUTPUT2 file."""
    _, _, op2, _ = _pyyeti()
    return {"matrices": {name.upper(): _parts(matrix) for name, matrix in op2.rdmats(path).items()}}


def _parts(matrix: Any) -> Any:
    return matrix if isinstance(matrix, np.ndarray) else sparse_parts(matrix)


def read_bulk(path: str) -> Contents:
    """Read from bulk data the grid points, matrices by direct input, and the rows of an external superelement."""
    bulk, n2p, *_ = _pyyeti()
    text = Path(path).read_text(encoding="utf-8", errors="replace").upper()
    words = {match[1] for match in re.finditer(r"^ *([A-Z]+)", text, re.MULTILINE)}
    if "INCLUDE" in words:
        raise InputError("path", f"{path} includes other files", "delete those lines, and name the files too")
    contents: Contents = {"matrices": {}, "unknowns": {}}
    if "DMIG" in words:
        for name, frame in bulk.rddmig(path, square=True, follow_includes=False).items():
            contents["matrices"][name.upper()] = frame.to_numpy()
            contents["unknowns"][name.upper()] = np.array(frame.index.to_list(), dtype=int)
    if "EXTRN" in words:
        contents["unknowns"][""] = np.array(bulk.rdextrn(path, follow_includes=False), dtype=int)
    return contents | _places(bulk.bulk2uset(path, follow_includes=False)[0], n2p) if "GRID" in words else contents


def _places(uset: Any, n2p: Any) -> Contents:
    """Places and axes of grid points, from how they move as one rigid body."""
    rows = np.array(uset.index.to_list(), dtype=int)
    first = np.flatnonzero(rows[:, 1] == 1)
    rigid = n2p.rbgeom_uset(uset)
    axes = np.stack([rigid[i : i + 3, :3].T for i in first]) if len(first) else np.zeros((0, 3, 3))
    places = uset.loc[(slice(None), 1), "x":"z"].to_numpy(dtype=float)
    return {"numbers": rows[first, 0], "places": places, "axes": axes}


KINDS = {"STIFFNESS": "K", "MASS": "M", "VISCOUSDAMPING": "C", "STRUCTURALDAMPING": "D"}
AGAIN = "write it again"


def read_matrix(path: str) -> Contents:
    """Read a substructure, or lines with the entries of a matrix: `node, direction, node, direction, value` or `row,
    column, value`.
    """
    lines = [line for line in Path(path).read_text(encoding="ascii", errors="replace").splitlines() if line.strip()]
    if any(line.upper().startswith("*MATRIX") for line in lines):
        return _substructure(lines)
    rows = [_numbers(line) for line in lines if not line.startswith("*")]
    if not rows or len({len(row) for row in rows}) > 1 or len(rows[0]) not in (3, 5):
        raise InputError("path", f"{path} holds no matrix of Abaqus", "export one with three or five numbers a line")
    return _entries(np.array(rows), Path(path).stem)


def read_storage(path: str) -> Contents:
    """Read the matrix of CalculiX's matrix storage, whose rows another file has."""
    entries, name = np.loadtxt(path, ndmin=2), {".sti": "K", ".mas": "M"}[Path(path).suffix.lower()]
    return _entries(entries, name)


def read_rows(path: str) -> Contents:
    """Read nodes and directions of the rows of CalculiX's matrix storage."""
    pairs = [line.split(".") for line in Path(path).read_text(encoding="ascii").split()]
    return {"unknowns": {"": np.array(pairs, dtype=int)}}


def read_nodes(path: str) -> Contents:
    """Read the numbers and places of the nodes of an input file."""
    place_of: dict[int, list[float]] = {}
    in_nodes = False
    for line in Path(path).read_text(encoding="ascii", errors="replace").splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            in_nodes = line.split(",")[0].strip().upper() == "*NODE"
        elif in_nodes:
            number, *place = _numbers(line)
            place_of[int(number)] = [*place, 0.0, 0.0, 0.0][:3]
    return {"numbers": np.array(list(place_of), dtype=int), "places": np.array(list(place_of.values())).reshape(-1, 3)}


def _numbers(line: str) -> list[float]:
    return [float(word) for word in line.replace("D", "E").replace(",", " ").split()]


def _entries(rows: np.ndarray, name: str) -> Contents:
    """Matrix from entries: (n, 3) by row and column, or (n, 5) by node and direction of the row and of the column."""
    if rows.shape[1] == 3:
        i, j = rows[:, :2].astype(int).T - 1
        return {"matrices": {name: mirrored(rows[:, 2], i, j, int(max(i.max(), j.max())) + 1)}}
    pairs = rows[:, :4].astype(int).reshape(-1, 2, 2)
    unknowns, index = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    i, j = index.reshape(-1, 2).T
    unknowns[unknowns[:, 0] < 0, 1] = 0  # nodes inside of it, without a place
    return {"matrices": {name: mirrored(rows[:, 4], i, j, len(unknowns))}, "unknowns": {name: unknowns}}


def _substructure(lines: list[str]) -> Contents:
    """Read a substructure: its nodes in a comment, directions by node, and lower triangles of matrices, row by row."""
    nodes: list[int] = []
    unknowns: list[tuple[int, int]] = []
    contents: Contents = {"matrices": {}, "unknowns": {}}
    blocks = _blocks(lines)
    for head, body in blocks:
        if head.startswith("** ELEMENT NODES"):
            nodes = [int(n) for line in body if line.startswith("**") for n in _numbers(line.strip("* "))]
            directions = [[int(n) for n in _numbers(line)] for line in body if not line.startswith("**")]
            unknowns = list(_directions(nodes, directions))
        elif head.startswith("*MATRIX"):
            name = KINDS.get(head.split("TYPE=")[-1].strip().replace(" ", ""), head)
            values = np.array([n for line in body if not line.startswith("**") for n in _numbers(line)])
            size = len(unknowns)
            if len(values) != size * (size + 1) // 2:
                problem = f"has {len(values)} numbers in {name}, of {size} rows"
                raise InputError("path", problem, AGAIN)
            contents["matrices"][name] = mirrored(values, *np.tril_indices(size), size)
            contents["unknowns"][name] = np.array(unknowns)
    return contents


def _blocks(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield headings, in capitals, each with the lines below it. The first block is before any heading."""
    head: str = ""
    body: list[str] = []
    for line in lines:
        upper = line.upper().strip()
        if upper.startswith(("** ELEMENT NODES", "*MATRIX")) or (upper.startswith("*") and not upper.startswith("**")):
            yield head, body
            head, body = upper, []
        else:
            body.append(line)
    yield head, body


def _directions(nodes: list[int], directions: list[list[int]]) -> Iterator[tuple[int, int]]:
    """Nodes and directions of the rows. A list of directions holds until a node, by its place, begins another."""
    if not directions:
        return
    changes = {1: directions[0]} | {first: rest for first, *rest in directions[1:]}
    active: list[int] = []
    for place, node in enumerate(nodes, 1):
        active = changes.get(place, active)
        yield from ((node, direction) for direction in active)
