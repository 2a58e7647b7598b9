"""Nastran's matrices (OP4, OP2, direct matrix input) and nodes (bulk data, external superelements), by pyyeti."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.contents import Contents, sparse_parts

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
    for name, each in op4.read(path, sparse=None).items():
        matrices[name.upper()] = _parts(each)
    return {"matrices": matrices}


def read_op2(path: str) -> Contents:
    """Read matrices of an OUTPUT2 file."""
    _, _, op2, _ = _pyyeti()
    return {"matrices": {name.upper(): _parts(each) for name, each in op2.rdmats(path).items()}}


def _parts(matrix: Any) -> Any:
    return matrix if isinstance(matrix, np.ndarray) else sparse_parts(matrix)


def read_punch(path: str) -> Contents:
    """Read direct matrix input of a punch file, and grid points in it."""
    bulk, *_ = _pyyeti()
    contents: Contents = {"matrices": {}, "unknowns": {}}
    for name, frame in bulk.rddmig(path, square=True).items():
        contents["matrices"][name.upper()] = frame.to_numpy()
        contents["unknowns"][name.upper()] = np.array(frame.index.to_list(), dtype=int)
    return contents | _nodes(path) if _has_grids(path) else contents


def read_bulk(path: str) -> Contents:
    """Read the grid points of bulk data, and direct matrix input in it."""
    text = Path(path).read_text(encoding="utf-8", errors="replace").upper()
    contents: Contents = _nodes(path)
    return read_punch(path) | contents if "DMIG" in text else contents


def read_superelement(path: str) -> Contents:
    """Read the boundary of an external superelement, whose matrices are in the OUTPUT4 file of the same export."""
    bulk, n2p, *_ = _pyyeti()
    uset = bulk.asm2uset(path, try_rdextrn=True)
    uset = uset[0] if isinstance(uset, tuple) else uset
    return {"unknowns": {"": _unknowns(uset)}} | _places(uset, n2p)


def _has_grids(path: str) -> bool:
    text = Path(path).read_text(encoding="utf-8", errors="replace").upper()
    return any(line.startswith("GRID") for line in text.splitlines())


def _nodes(path: str) -> Contents:
    bulk, n2p, *_ = _pyyeti()
    return _places(bulk.bulk2uset(path)[0], n2p)


def _unknowns(uset: Any) -> Any:
    rows = np.array(uset.index.to_list(), dtype=int)
    return np.where(rows[:, 1:] == 0, np.column_stack([rows[:, 0], 0 * rows[:, 0]]), rows)


def _places(uset: Any, n2p: Any) -> Contents:
    """Places and axes of grid points, by how they move as one rigid body."""
    rows = np.array(uset.index.to_list(), dtype=int)
    first = np.flatnonzero(rows[:, 1] == 1)
    rigid = n2p.rbgeom_uset(uset)
    axes = np.stack([rigid[i : i + 3, :3].T for i in first]) if len(first) else np.zeros((0, 3, 3))
    places = uset.loc[(slice(None), 1), "x":"z"].to_numpy(dtype=float)
    return {"numbers": rows[first, 0], "places": places, "axes": axes}
