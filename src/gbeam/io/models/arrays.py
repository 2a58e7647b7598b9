"""Contents of files of matrices as readers return them, and arrays in files: by NumPy, SciPy, Matrix Market and MATLAB,
Simscape's fields, and laws of controllers.
"""

from __future__ import annotations

import math
import os
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypedDict

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.hdf5_files import open_hdf5
from gbeam.guards.limits import BINARY_BYTES, read_json, refuse_large_file
from gbeam.guards.processes import read_confined
from gbeam.printable import shortened

Matrices = dict[str, Any]
ORIGINS = "P"  # of interface frames, beside K and M, in Simscape
NODES = "nodes"  # places of all nodes, beside the matrices


class Contents(TypedDict, total=False):
    """Parts of a model that a file holds.

    Sparse matrices are as :func:`sparse_parts` has them. Unknowns (u, 2) have the number of their node and a direction,
    1 to 6, or 0 of a coordinate of its own. They stand by the name of the matrix, or all under no name. Nodes have
    numbers (k,), places (k, 3) and axes in columns (k, 3, 3). Modes stand by their parts. A body is one of standard
    input data.
    """

    matrices: Matrices
    unknowns: dict[str, Any]
    numbers: Any
    places: Any
    axes: Any
    modes: dict[str, Any]
    body: dict[str, Any]


def sparse_parts(matrix: Any) -> dict[str, Any]:
    """Return a sparse matrix by its values, rows, columns and shape."""
    entries = matrix.tocoo()
    rows, columns = entries.coords
    return {"values": entries.data, "rows": rows, "columns": columns, "shape": list(matrix.shape)}


def mirrored(values: Any, rows: Any, columns: Any, size: int) -> dict[str, Any]:
    """Return a symmetric sparse matrix, in parts, from the entries of one of its triangles or of both."""
    from scipy.sparse import coo_array, diags_array

    matrix = coo_array((np.asarray(values, dtype=float), (rows, columns)), shape=(size, size)).tocsr()
    diagonal = diags_array(matrix.diagonal()).tocsr()
    transposed = (matrix - diagonal).T
    one_triangle = not abs((matrix - diagonal).multiply(transposed)).max()
    return sparse_parts((matrix + transposed).tocsr() if one_triangle else matrix)


def read(path: str) -> Contents:
    """Read the matrices of numbers in a file, and the places of nodes, or of Simscape's frames, by their names."""
    from scipy.sparse import issparse

    contents: Contents = {"matrices": {}}
    values = everything(path)
    for key, value in values.items():
        if issparse(value):
            contents["matrices"][key] = sparse_parts(value)
        elif (
            getattr(value, "ndim", 0) == 2 and value.dtype.kind in "fiu" and (min(value.shape) > 1 or len(values) == 1)
        ):
            contents["matrices"][key] = value
    if NODES in values and len(values) > 1:
        contents["matrices"].pop(NODES, None)
        contents["places"] = np.atleast_2d(np.asarray(values[NODES], dtype=float))
    origins = values.get(ORIGINS)
    if origins is not None and {"K", "M"} <= set(values):
        places = np.atleast_2d(np.asarray(origins, dtype=float))
        count, size = len(places), values["K"].shape[0]
        contents["matrices"].pop(ORIGINS, None)
        if places.shape[1] == 3 and size >= 6 * count:
            node, direction = np.repeat(np.arange(1, count + 1), 6), np.tile(np.arange(1, 7), count)
            frames = np.stack([node, direction], axis=1)
            modes = np.zeros((size - 6 * count, 2), dtype=int)
            contents |= {"unknowns": {"": np.concatenate([frames, modes])}, "numbers": np.arange(1, count + 1)}
            contents["places"] = places
    return contents


def everything(path: str) -> dict[str, Any]:
    """Return all that a file holds, by name, with the fields of structures. A single array goes by the file's name."""
    from scipy.io import loadmat, mmread
    from scipy.sparse import load_npz

    ending, stem = Path(path).suffix.lower(), Path(path).stem
    if ending == ".mtx":
        return {stem: mmread(path, spmatrix=False)}
    if ending == ".mat":
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")  # numbers of a VAX or a Cray, two of one name, one that is damaged
                warnings.simplefilter("ignore", DeprecationWarning)
                loaded = {k: v for k, v in loadmat(path, spmatrix=False).items() if not k.startswith("__")}
        except NotImplementedError:  # of version 7.3, which is HDF5
            return _of_hdf5(path)
        structures = [value[0, 0] for value in loaded.values() if value.dtype.names and value.shape == (1, 1)]
        return loaded | {name: fields[name] for fields in structures for name in fields.dtype.names}
    loaded = np.load(path, allow_pickle=False)
    if isinstance(loaded, np.ndarray):
        return {stem: loaded}
    return {stem: load_npz(path)} if {"format", "shape", "data"} <= set(loaded.files) else dict(loaded)


def _of_hdf5(path: str) -> dict[str, Any]:
    """Matrices in a file of MATLAB's version 7.3, which stores them transposed, and the fields of structures."""
    import h5py  # 0.2 s to import
    from scipy.sparse import csc_array

    arrays = dict[str, Any]()

    def add(name: str, node: Any) -> None:
        sparse = node.attrs.get("MATLAB_sparse")
        if sparse is not None:
            values, rows, starts = (node[key][()] if key in node else np.zeros(0) for key in ("data", "ir", "jc"))
            arrays[name] = csc_array((values, rows, starts), shape=(int(sparse), len(starts) - 1))
        elif isinstance(node, h5py.Group):
            for key, child in node.items():
                add(key, child)
        elif node.dtype.kind in "fiu" and "MATLAB_empty" not in node.attrs:
            arrays[name] = node[()].T

    with open_hdf5(path) as file:
        for key, child in file.items():
            if not key.startswith("#"):
                add(key, child)
    return arrays


STATE_SPACES = (".npz", ".mat", ".json")
NAMES = "abcd"
STEPS = "dt", "ts", "step"
FIX = "save A, B, C and D as numbers, with dt where they are of discrete time"


def read_state_space(path: str | os.PathLike[str]) -> SimpleNamespace:
    """Read matrices ``a``, ``b``, ``c``, ``d`` and the step ``dt``, s, which is zero in continuous time."""
    ending = Path(path).suffix.lower()
    if ending not in STATE_SPACES:
        raise InputError("file", f"ends in {ending or 'nothing'}", "give .npz, .mat or .json")

    def refuse(problem: str) -> InputError:
        return InputError("file", problem, FIX)

    if ending == ".json":
        arrays = read_json(Path(path), FIX)
    else:
        refuse_large_file("file", path, BINARY_BYTES, "reduce the law before it is saved")
        arrays = read_confined(_numbers, os.fspath(path), refuse=refuse)
    by_name = {key.lower(): value for key, value in arrays.items()}
    lacking = ", ".join(name.upper() for name in NAMES if name not in by_name)
    if lacking:
        raise refuse(f"holds no {lacking}")
    try:
        parts = {name: np.atleast_2d(np.asarray(by_name[name], dtype=float)) for name in NAMES}
    except (TypeError, ValueError):
        raise refuse("holds what are no numbers") from None
    if not all(np.isfinite(value).all() for value in parts.values()):
        raise refuse("holds numbers that are not finite")
    steps = {key: _step(key, by_name[key]) for key in STEPS if key in by_name}
    if len(set(steps.values())) > 1:
        raise refuse(f"says {' and '.join(f'{key} = {value:g}' for key, value in steps.items())}")
    return SimpleNamespace(**parts, dt=next(iter(steps.values()), 0.0))


def _step(key: str, value: Any) -> float:
    """Step of a law, s.

    Where discrete time is said without its step, it is True in python-control and -1 in MATLAB. MATLAB's true is a
    number of eight bits in its files.
    """
    array = np.asarray(value)
    number = array.dtype.kind in "fiu" and array.dtype != np.uint8 and array.size == 1
    if not number or not 0 <= array.item() < math.inf:
        text = shortened(str(array.item() if array.size == 1 else value), 40)
        problem = f"says {key} = {text}: discrete, and the sample time is not said"
        raise InputError("file", problem, f"save {key} as the sample time in s, such as 0.01, or 0 in continuous time")
    return float(array.item())


def _numbers(path: str) -> dict[str, Any]:
    """Arrays of numbers in a file by their names."""
    try:
        contents = everything(path)
    except MemoryError:
        raise
    except Exception as error:  # of many kinds
        raise InputError("file", f"cannot be read: {shortened(str(error), 100)}", FIX) from None
    arrays = {key: np.asarray(value) for key, value in contents.items() if hasattr(value, "dtype")}
    return {key: value for key, value in arrays.items() if value.dtype.kind in "fiu" or key.lower() in STEPS}
