"""Models of other programs: a reader for each kind of file, and what several files say together."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import BINARY_BYTES, refuse_large_file
from gbeam.guards.processes import read_confined
from gbeam.io.models.arrays import Contents
from gbeam.printable import shortened

MARKET = b"%%MatrixMarket"
# Module and function of each ending; another format is one line here, and a function.
READERS = {
    ".npz": "arrays.read",
    ".npy": "arrays.read",
    ".mat": "arrays.read",
    ".mtx": "arrays.read",  # Matrix Market's, else Abaqus's
    ".sti": "finite_elements.read_storage",
    ".mas": "finite_elements.read_storage",
    ".inp": "finite_elements.read_nodes",
    ".op4": "finite_elements.read_op4",
    ".op2": "finite_elements.read_op2",
    ".dof": "finite_elements.read_rows",
    ".sid": "modes.read_standard_input",
    ".uff": "modes.read_universal",
    ".unv": "modes.read_universal",
    **dict.fromkeys((".bdf", ".dat", ".nas", ".blk", ".pch", ".asm"), "finite_elements.read_bulk"),
}
ROWS = {".sti": ".dof", ".mas": ".dof", ".asm": ".pch"}  # endings of files, and of those with their rows
NAMES = {  # that programs give their matrices
    "mass": ("M", "MASS", "MGG", "MAA", "MAAX", "MXX", "M2GG"),
    "stiffness": ("K", "STIFFNESS", "KGG", "KAA", "KAAX", "KXX", "K2GG"),
}


@typed
def read_matrix(path: str | os.PathLike[str], name: str = "") -> Any:
    """Read a matrix of a file.

    Parameters
    ----------
    path : path
        NumPy's .npy or .npz, SciPy's sparse .npz, Matrix Market's .mtx, MATLAB's .mat, Abaqus's and
        CalculiX's .mtx, .sti and .mas, and by the extra ``nastran`` .op4, .op2 and .pch.
    name : str
        Of the matrix, where the file holds several.

    Returns
    -------
    array or sparse array
        As it is in the file.

    Raises
    ------
    InputError
        If the file is no such file, or holds no matrix of that name, or several and none is named.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import numpy as np, tempfile, os
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.savez(os.path.join(folder, "model.npz"), M=np.eye(3), K=np.diag([1.0, 2.0, 3.0]))
    ...     print(gb.read_matrix(os.path.join(folder, "model.npz"), "K").diagonal())
    [1. 2. 3.]
    """
    matrices = contents_of(path).get("matrices", {})
    if name and name not in matrices:
        raise InputError("name", f"is {name!r}, which is no matrix of {path}", f"choose from {', '.join(matrices)}")
    if not matrices:
        raise InputError("path", f"{path} holds no matrix", "export one")
    if len(matrices) > 1 and not name:
        raise InputError("name", "is missing", f"choose from {', '.join(matrices)}")
    return _sparse(matrices[name] if name else next(iter(matrices.values())))


@dataclass(frozen=True)
class Model:
    """Contents of several files together."""

    matrices: dict[str, Any] = field(default_factory=dict)
    unknowns: dict[str, Any] = field(default_factory=dict)
    numbers: Any = None
    places: Any = None
    axes: Any = None
    modes: dict[str, Any] | None = None
    body: dict[str, Any] | None = None

    def matrix(self, role: str, name: str) -> tuple[Any, Any]:
        """Matrix of a role, by its name or a usual one, and what its rows are, or None."""
        usual = [matrix for matrix in self.matrices if matrix.upper() in NAMES[role]]
        if name and name not in self.matrices:
            fix = f"choose from {', '.join(self.matrices)}" if self.matrices else "give a file with matrices"
            raise InputError(role, f"is {name!r}, which is no matrix of the files", fix)
        if not name and len(usual) != 1:
            names = ", ".join(usual or self.matrices) or "the files have no matrix"
            raise InputError(role, "is missing" if not usual else "is not clear", f"name the matrix: {names}")
        chosen = name or usual[0]
        return _sparse(self.matrices[chosen]), self.unknowns.get(chosen, self.unknowns.get(""))

    def pair(self, mass: str, stiffness: str) -> tuple[Any, Any, Any]:
        """Mass and stiffness with the same rows, and what these are, (u, 2), or None if the files do not say."""
        m, of_m = self.matrix("mass", mass)
        k, of_k = self.matrix("stiffness", stiffness)
        if of_m is None or of_k is None or np.array_equal(of_m, of_k):
            if m.shape != k.shape:
                raise InputError("stiffness", f"has the shape {k.shape}", f"give {m.shape}, as the mass matrix has")
            unknowns = of_k if of_m is None else of_m
            if unknowns is not None and len(unknowns) != k.shape[0]:
                problem = f"are {k.shape[0]}, and the files name {len(unknowns)} unknowns"
                raise InputError("stiffness", f"has rows that {problem}", "give the files of one export")
            return m, k, unknowns
        # Each gets rows of zeros for unknowns that only the other has.
        all_unknowns = np.unique(np.concatenate([of_m, of_k]), axis=0)
        return _spread(m, of_m, all_unknowns), _spread(k, of_k, all_unknowns), all_unknowns

    def nodes_of(self, nodes: Any, unknowns: Any) -> tuple[Any, Any, Any, Any]:
        """Return places (k, 3), numbers (k,), unknowns (u, 2) and axes (k, 3, 3) of the nodes that have unknowns.

        Unknowns are by the node's index and the direction. What the files do not say is None.
        """
        if nodes is not None:
            if self.places is not None:
                raise InputError("nodes", "are given, and the files have some", "leave them out")
            numbers, places, axes = None, np.asarray(nodes, dtype=float), None
        elif self.places is None:
            fix = "give nodes, an array of that name beside the matrices, or a file that has them: .inp, .bdf, .asm"
            raise InputError("nodes", "are in none of the files", fix)
        else:
            numbers, places, axes = self.numbers, np.asarray(self.places, dtype=float), self.axes
        if unknowns is None:
            return places, numbers, None, axes
        modal = unknowns[:, 1] == 0
        used = np.unique(unknowns[~modal, 0])
        node_numbers = np.arange(len(places)) if numbers is None else np.asarray(numbers)
        lacking = np.setdiff1d(used, node_numbers)
        if lacking.size:
            examples = ", ".join(map(str, lacking[:3])) + (", ..." if lacking.size > 3 else "")
            raise InputError(
                "nodes",
                f"lack {lacking.size} that matrices or shapes are of: {examples}",
                "give the file that has them",
            )
        order = np.argsort(node_numbers, kind="stable")
        chosen = order[np.searchsorted(node_numbers[order], used)]
        rows = np.column_stack([np.where(modal, 0, np.searchsorted(used, unknowns[:, 0])), unknowns[:, 1]])
        return places[chosen], node_numbers[chosen], rows, None if axes is None else axes[chosen]


def model_of(paths: Sequence[str | os.PathLike[str]]) -> Model:
    """Read files that complete one another. No reader opens another file than its own."""
    endings = {Path(path).suffix.lower() for path in paths}
    for file in map(Path, paths):
        rows = ROWS.get(file.suffix.lower())
        if rows and rows not in endings:
            problem = f"{file} is given without {file.with_suffix(rows).name}, which says what its rows are"
            raise InputError("path", problem, "name that file too")
    parts: dict[str, Any] = {"matrices": {}, "unknowns": {}}
    for path in paths:
        part: Any = contents_of(path)
        for key in ("matrices", "unknowns"):
            parts[key] |= part.get(key, {})
        if "places" in part and "places" in parts:
            part = _joined(parts, part)
        parts |= {key: value for key, value in part.items() if key not in ("matrices", "unknowns")}
    return Model(**parts)


def _joined(first: dict[str, Any], then: Any) -> dict[str, Any]:
    """Return the contents of the second file with the nodes of both files.

    A node's axes are those of the file that turns it, or of the first if both do.
    """
    if not ("numbers" in first and "numbers" in then):
        raise InputError("nodes", "are in two of the files", "give them once")
    unseen = ~np.isin(then["numbers"], first["numbers"])
    nodes = {key: np.concatenate([first[key], then[key][unseen]]) for key in ("numbers", "places")}
    if "axes" in first or "axes" in then:
        nodes["axes"] = np.tile(np.eye(3), (len(nodes["numbers"]), 1, 1))
        index_of = {number: i for i, number in enumerate(nodes["numbers"].tolist())}
        for numbers, axes in ((part["numbers"], part["axes"]) for part in (then, first) if "axes" in part):
            for k in np.flatnonzero(np.abs(axes - np.eye(3)).max(axis=(1, 2)) > 0):  # of two that turn a node the first
                nodes["axes"][index_of[int(numbers[k])]] = axes[k]
    return then | nodes


def _spread(matrix: Any, rows: Any, all_unknowns: Any) -> Any:
    """Return a matrix with a row and a column for each of `all_unknowns`; those that `rows` lack are zero."""
    from scipy.sparse import coo_array

    index_of = {tuple(row): i for i, row in enumerate(all_unknowns.tolist())}
    index = np.array([index_of[tuple(row)] for row in rows.tolist()])
    entries = coo_array(matrix)
    i, j = entries.coords
    return coo_array((entries.data, (index[i], index[j])), shape=(len(all_unknowns), len(all_unknowns)))


def contents_of(path: str | os.PathLike[str]) -> Contents:
    """Read a file in a process of its own. InputError if no reader has its ending, or if it cannot be read."""
    ending = Path(path).suffix.lower()
    if ending not in READERS:
        raise InputError("path", f"{path} ends in {ending or 'nothing'}", f"give one of {', '.join(READERS)}")
    refuse_large_file("path", path, BINARY_BYTES, "reduce the model before it is exported")

    def refuse(problem: str) -> InputError:
        return InputError("path", f"{os.fspath(path)} {problem}", "export it again")

    contents: Contents = read_confined(_reading, os.fspath(path), refuse=refuse)
    return contents


def _reading(path: str) -> Contents:
    """Contents of a file by the reader of its ending. Any exception of the reader becomes an InputError."""
    reader = READERS[Path(path).suffix.lower()]
    if Path(path).suffix.lower() == ".mtx":
        with open(path, "rb") as file:
            reader = reader if file.read(len(MARKET)) == MARKET else "finite_elements.read_matrix"
    module, name = reader.split(".")
    try:
        contents: Contents = getattr(import_module(f"gbeam.io.models.{module}"), name)(path)
    except (MemoryError, InputError):
        raise
    except Exception as error:  # of many kinds
        problem = f"{path} cannot be read: {shortened(str(error), 100)}"
        raise InputError("path", problem, "export it again") from None
    return contents


def _sparse(parts: Any) -> Any:
    if not isinstance(parts, dict):
        return parts
    from scipy.sparse import coo_array

    return coo_array((parts["values"], (parts["rows"], parts["columns"])), shape=tuple(parts["shape"]))
