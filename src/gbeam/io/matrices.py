"""Matrices in files of other programs: NumPy's and SciPy's, Matrix Market and MATLAB's."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.confined import confined
from gbeam.guards.limits import BINARY_BYTES, refuse_large_file
from gbeam.printable import shortened

_ENDINGS = ".npz", ".npy", ".mtx", ".mat"


@typed
def read_matrix(path: str | os.PathLike[str], name: str = "") -> Any:
    """Read a matrix of a file.

    Parameters
    ----------
    path : path
        NumPy's .npy or .npz, SciPy's sparse .npz, Matrix Market's .mtx, or MATLAB's .mat up to version 7.
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
    ending = Path(path).suffix.lower()
    if ending not in _ENDINGS:
        raise InputError("path", f"{path} ends in {ending or 'nothing'}", f"give one of {', '.join(_ENDINGS)}")
    refuse_large_file("path", path, BINARY_BYTES, "reduce the model before it is exported")

    def refuse(problem: str) -> InputError:
        return InputError("path", f"{os.fspath(path)} {problem}", "export the matrix again")

    matrices = confined(_matrices, os.fspath(path), refuse=refuse)
    if name and name not in matrices:
        raise InputError("name", f"is {name!r}, which is no matrix of {path}", f"choose from {', '.join(matrices)}")
    if not matrices:
        raise InputError("path", f"{path} holds no matrix", "export one")
    if len(matrices) > 1 and not name:
        raise InputError("name", "is missing", f"choose from {', '.join(matrices)}")
    return _sparse(matrices[name] if name else next(iter(matrices.values())))


def _sparse(parts: Any) -> Any:
    if not isinstance(parts, dict):
        return parts
    from scipy.sparse import coo_array

    return coo_array((parts["values"], (parts["rows"], parts["columns"])), shape=tuple(parts["shape"]))


def _matrices(path: str) -> dict[str, Any]:
    """Matrices in a file by their names, sparse ones in parts."""
    from scipy.sparse import issparse

    try:
        every = _every(path)
    except MemoryError:
        raise
    except Exception as error:  # of many kinds
        problem = f"{path} cannot be read: {shortened(str(error), 100)}"
        raise InputError("path", problem, "export the matrix again") from None
    found = {}
    for key, each in every.items():
        if issparse(each):
            parts = each.tocoo()
            rows, columns = parts.coords
            found[key] = {"values": parts.data, "rows": rows, "columns": columns, "shape": list(each.shape)}
        elif getattr(each, "ndim", 0) == 2 and each.dtype.kind in "fiu" and min(each.shape) > 1:
            found[key] = each
    return found


def _every(path: str) -> dict[str, Any]:
    """Everything in a file by its name; what has none by that of the file."""
    import numpy as np
    from scipy.io import loadmat, mmread
    from scipy.sparse import load_npz

    ending, alone = Path(path).suffix.lower(), Path(path).stem
    if ending == ".mtx":
        return {alone: mmread(path, spmatrix=False)}
    if ending == ".mat":
        return dict(loadmat(path, spmatrix=False))
    loaded = np.load(path, allow_pickle=False)
    if isinstance(loaded, np.ndarray):
        return {alone: loaded}
    return {alone: load_npz(path)} if {"format", "shape", "data"} <= set(loaded.files) else dict(loaded)
