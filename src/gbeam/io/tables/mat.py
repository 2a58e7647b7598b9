"""MATLAB's MAT files as tables: variables by name, fields of structures by path, vectors of matrices."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.limits import ELEMENTS, refuse_more
from gbeam.io.tables.hdf5 import hdf5_columns
from gbeam.io.tables.table import Column, Table, array_columns

_STRUCTURES = ("struct", "object")
_NUMBERS = ("double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))


def read_mat(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read a MAT file of any version; 7.3 is HDF5.

    A vector is a column by its name, ``az``, or a structure's field by its path, ``rec.az``, or the path's last word; a
    matrix is one column per vector, ``acc(:,1)``.
    """
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", ".*may be corrupt")  # numbers of a VAX or a Cray, which SciPy misreads
            columns = _any_version(path, words)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # loadmat raises whatever a damaged file leads to
        raise InputError("record.file", f"{path} is not a MAT file ({error})", "save the record by MATLAB") from None
    if not columns:
        fix = "save vectors of numbers; a table T as s = table2struct(T, 'ToScalar', true)"
        raise InputError("record.file", f"{path} holds no numeric variables", fix)
    return Table(tuple(columns))


def _any_version(path: str | os.PathLike[str], words: Sequence[str]) -> list[Column]:
    import scipy.io  # 0.2 s to import

    try:
        variables = scipy.io.whosmat(path)
    except NotImplementedError:  # scipy's word for version 7.3
        return hdf5_columns(path, matlab=True)
    columns: list[Column] = []
    for name, shape, kind in variables:
        if kind in _NUMBERS:
            squeezed = tuple(size for size in shape if size != 1)
            columns += array_columns(name, squeezed, partial(_array, path, name, shape), matlab=True)
    structures = [name for name, _, kind in variables if kind in _STRUCTURES]
    missing = {word.removeprefix("-").strip() for word in words} - {each.name for each in columns} - {"0"}
    named = [name for name in structures if any(word.startswith(f"{name}.") for word in missing)]
    columns += [column for name in named for column in _columns(name, _loaded(path, name))]
    if not words or missing - {each.name for each in columns}:  # a part's last word, or a mistake
        columns += [c for name in structures if name not in named for c in _columns(name, _loaded(path, name))]
    return columns


def _loaded(path: str | os.PathLike[str], name: str) -> Any:
    import scipy.io

    return scipy.io.loadmat(path, simplify_cells=True, variable_names=[name])[name]


def _array(path: str | os.PathLike[str], name: str, shape: tuple[int, ...]) -> NDArray[Any]:
    refuse_more("", "numbers", math.prod(shape), ELEMENTS, 8.0, "save fewer at a time")
    values: NDArray[Any] = _loaded(path, name)
    if values.dtype.kind not in "iuf":
        raise InputError("", "holds complex numbers", "save their real parts")
    return values


def _columns(name: str, value: Any) -> list[Column]:
    if isinstance(value, dict):
        return [column for field, part in value.items() for column in _columns(f"{name}.{field}", part)]
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "iuf":
        return []
    return array_columns(name, value.shape, lambda: value, matlab=True)
