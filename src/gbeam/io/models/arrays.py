"""NumPy's, SciPy's, Matrix Market's and MATLAB's files, and Simscape's fields in them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gbeam.io.models.contents import Contents, sparse_parts

ORIGINS = "P"  # of interface frames, beside K and M, in Simscape


def read(path: str) -> Contents:
    """Read everything that is a matrix of numbers."""
    from scipy.sparse import issparse

    contents: Contents = {"matrices": {}}
    every = everything(path)
    for key, each in every.items():
        if issparse(each):
            contents["matrices"][key] = sparse_parts(each)
        elif getattr(each, "ndim", 0) == 2 and each.dtype.kind in "fiu" and min(each.shape) > 1:
            contents["matrices"][key] = each
    origins = every.get(ORIGINS)
    if origins is not None and {"K", "M"} <= set(every):
        places = np.atleast_2d(np.asarray(origins, dtype=float))
        count, size = len(places), every["K"].shape[0]
        contents["matrices"].pop(ORIGINS, None)
        if places.shape[1] == 3 and size >= 6 * count:
            node, way = np.repeat(np.arange(1, count + 1), 6), np.tile(np.arange(1, 7), count)
            frames = np.stack([node, way], axis=1)
            modes = np.zeros((size - 6 * count, 2), dtype=int)
            contents |= {"unknowns": {"": np.concatenate([frames, modes])}, "numbers": np.arange(1, count + 1)}
            contents["places"] = places
    return contents


def everything(path: str) -> dict[str, Any]:
    """Everything in a file by its name, a structure's fields by theirs; what has none by that of the file."""
    from scipy.io import loadmat, mmread
    from scipy.sparse import load_npz

    ending, alone = Path(path).suffix.lower(), Path(path).stem
    if ending == ".mtx":
        return {alone: mmread(path, spmatrix=False)}
    if ending == ".mat":
        loaded = {k: v for k, v in loadmat(path, spmatrix=False).items() if not k.startswith("__")}
        fields = [each[0, 0] for each in loaded.values() if each.dtype.names and each.shape == (1, 1)]
        return loaded | {name: each[name] for each in fields for name in each.dtype.names}
    loaded = np.load(path, allow_pickle=False)
    if isinstance(loaded, np.ndarray):
        return {alone: loaded}
    return {alone: load_npz(path)} if {"format", "shape", "data"} <= set(loaded.files) else dict(loaded)
