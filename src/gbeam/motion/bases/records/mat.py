"""MATLAB's MAT files as tables: variables by name, fields of structures by path, vectors of matrices."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import ELEMENTS, refuse_more
from gbeam.motion.bases.records.hdf5 import hdf5_columns
from gbeam.motion.bases.records.table import Column, Table, array_columns


def read_mat(path: str | os.PathLike[str]) -> Table:
    """Read a MAT file of any version; 7.3 is HDF5.

    A vector is a column by its name, ``az``, or a structure's field by its path, ``rec.az``, or the path's last word; a
    matrix is one column per vector, ``acc(:,1)``.

    Parameters
    ----------
    path : path

    Raises
    ------
    InputError
        If the file cannot be read, or holds no numeric variables; MATLAB keeps tables and timetables as objects that
        nothing else reads.
    """
    try:
        columns = _any_version(path)
    except InputError:
        raise
    except Exception as error:  # loadmat raises whatever a damaged file leads to
        raise InputError("record.file", f"{path} is not a MAT file ({error})", "save the record by MATLAB") from None
    if not columns:
        fix = "save vectors of numbers; a table T as s = table2struct(T, 'ToScalar', true)"
        raise InputError("record.file", f"{path} holds no numeric variables", fix)
    return Table(tuple(columns))


def _any_version(path: str | os.PathLike[str]) -> list[Column]:
    import scipy.io  # 0.4 s to import

    try:
        for name, shape, _ in scipy.io.whosmat(path):
            problem = f"of the variable {name!r}"
            refuse_more("record.file", f"numbers {problem}", math.prod(shape), ELEMENTS, 8.0, "save fewer at a time")
        variables = scipy.io.loadmat(path, simplify_cells=True)
    except NotImplementedError:  # scipy's word for version 7.3
        return hdf5_columns(path, matlab=True)
    return [column for name, value in variables.items() for column in _columns(name, value)]


def _columns(name: str, value: Any) -> list[Column]:
    if isinstance(value, dict):
        return [column for field, part in value.items() for column in _columns(f"{name}.{field}", part)]
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "iuf":
        return []
    return array_columns(name, value.shape, lambda: value, matlab=True)
