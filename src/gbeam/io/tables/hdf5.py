"""HDF5 and netCDF files as tables: every vector is a column by its path, every matrix several."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.limits import ELEMENTS, refuse_more
from gbeam.io.tables.table import Column, Table, array_columns

if TYPE_CHECKING:
    import h5py

_NETCDF_3 = b"CDF"  # which is not HDF5


def read_hdf5(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read an HDF5 or netCDF file.

    A vector is a column by its path, ``group/az``, or the path's last word; a matrix is one column per vector,
    ``acc[:,0]``. The attribute `units` is the unit; `scale_factor`, `add_offset` and `_FillValue` are applied.
    """
    try:
        with open(path, "rb") as file:
            old = file.read(3) == _NETCDF_3
        return Table(tuple(_netcdf_3(path) if old else hdf5_columns(path)))
    except MemoryError:
        raise
    except Exception as error:  # a damaged file leads to any
        raise InputError("record.file", f"{path} cannot be read ({error})", "give an HDF5 or netCDF file") from None


def hdf5_columns(path: str | os.PathLike[str], *, matlab: bool = False) -> list[Column]:
    """Columns of an HDF5 file; MATLAB's hold every matrix transposed."""
    import h5py  # 0.2 s to import

    columns: list[Column] = []

    def add(path_inside: str, item: h5py.Dataset | h5py.Group) -> None:
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "iuf" or path_inside.startswith("#"):
            return
        shape = item.shape[::-1] if matlab else item.shape
        name = path_inside.replace("/", ".") if matlab else path_inside
        unit = _words(item.attrs.get("units", ""))
        columns.extend(array_columns(name, shape, lambda: values(path_inside), unit=unit, matlab=matlab))

    def values(path_inside: str) -> NDArray[Any]:
        with h5py.File(path) as file:
            item = file[path_inside]
            refuse_more("", "numbers", item.size, ELEMENTS, 40.0, "save fewer at a time")
            array = _unpacked(np.asarray(item), item.attrs)
        return array.T if matlab else array

    with h5py.File(path) as file:
        file.visititems(add)
    return columns


def _netcdf_3(path: str | os.PathLike[str]) -> list[Column]:
    from scipy.io import netcdf_file  # 0.4 s to import

    columns: list[Column] = []
    with netcdf_file(path, mmap=False) as file:
        for name, variable in file.variables.items():
            if variable.data.dtype.kind in "iuf":
                attributes = {name: getattr(variable, name) for name in _ATTRIBUTES if hasattr(variable, name)}
                array = _unpacked(np.array(variable.data, dtype=np.float64), attributes)
                unit = _words(attributes.get("units", ""))
                columns += array_columns(name, array.shape, lambda array=array: array, unit=unit)  # type: ignore[misc]
    return columns


def _unpacked(array: NDArray[Any], attributes: Mapping[str, Any]) -> NDArray[np.float64]:
    """Undo the packing of the CF conventions: samples that are missing are NaN."""
    missing = [np.ravel(attributes[name])[0] for name in ("_FillValue", "missing_value") if name in attributes]
    empty = np.isin(array, missing) if missing else False
    scale, offset = (np.ravel(attributes.get(name, default))[0] for name, default in _PACKING.items())
    with np.errstate(all="ignore"):  # what is no number is refused where its sample is used
        values = array.astype(np.float64) * np.float64(scale) + np.float64(offset)
    return np.where(empty, np.nan, values) if missing else values


_PACKING = {"scale_factor": 1.0, "add_offset": 0.0}
_ATTRIBUTES = "units", "_FillValue", "missing_value", *_PACKING


def _words(attribute: Any) -> str:
    value = np.ravel(attribute)[0] if np.size(attribute) else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
