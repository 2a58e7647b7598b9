"""Groups written to a netCDF-4 file by h5py alone, and what such a file holds.

netCDF-4 is HDF5 with rules: a dimension is a dimension scale, which is its coordinate variable where it has one; every
variable has the scales of its dimensions attached; things are kept in the order of their creation. xarray and h5netcdf
know the rules as well, but importing the one and the bookkeeping of the other take longer than many a computation.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from gbeam.errors import InputError
from gbeam.io.groups import Group, Variable
from gbeam.printable import storable

_BOOKKEEPING = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates")
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"  # the format's words


def write_groups(groups: Mapping[str, Group], path: str | os.PathLike[str]) -> None:
    """Write groups to a file, whole or not at all."""
    write_whole(path, image(groups))


def write_whole(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file under another name beside it, and rename it once it is on the disk; OSError if that cannot be."""
    final = Path(path)
    handle, name = tempfile.mkstemp(prefix=f".{final.name}-", dir=final.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp's files are for their owner only; a result is as readable as any other new file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, final)
    except BaseException:
        os.unlink(name)
        raise


def image(groups: Mapping[str, Group]) -> bytes:
    """Bytes of the file, made in memory: HDF5 ends the process where a disk is full as it closes a file."""
    dimensions = 0  # so far, in the whole file
    options = {"driver": "core", "backing_store": False, "libver": ("earliest", "v110"), "track_order": True}
    with h5py.File("result.nc", "w", **options) as file:
        for path, group in groups.items():
            place = file
            for part in filter(None, path.split("/")):
                place = place[part] if part in place else place.create_group(part, track_order=True)
            for key, value in group.attrs.items():
                _describe(place, key, value)
            dimensions = _fill(place, group, dimensions)
        file.flush()
        return bytes(file.id.get_file_image())


def contents(path: str) -> dict[str, Any]:
    """Return the variables of a file by path, and the attributes of variables and groups, undecoded."""
    try:
        with h5py.File(path) as file:
            return contents_of(file)
    except MemoryError:
        raise
    except Exception:  # a damaged file leads HDF5 to any
        fix = "give a result.nc written by gbeam run"
        raise InputError(path, "is not a netCDF-4 file that can be read", fix) from None


def contents_of(file: h5py.File) -> dict[str, Any]:
    """Return the variables and the attributes of an open file; see :func:`contents`."""
    variables: dict[str, Any] = {}
    attrs = {"": _attrs(file)}

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        attrs[name] = _attrs(node)
        if isinstance(node, h5py.Dataset):
            variables[name] = _present(node.asstr()[()] if node.dtype.kind == "O" else node[()])

    file.visititems(visit)
    return {"variables": variables, "attrs": attrs}


def _attrs(node: h5py.Group | h5py.Dataset) -> dict[str, Any]:
    return {name: _present(value) for name, value in node.attrs.items() if name not in _BOOKKEEPING}


def _present(value: Any) -> Any:
    return "" if isinstance(value, h5py.Empty) else value


def _fill(place: h5py.Group, group: Group, dimensions: int) -> int:
    """Write a group's dimensions, then its variables; return the number of dimensions so far."""
    scales: dict[str, h5py.Dataset] = {}
    every = group.coordinates | group.variables
    for each in every.values():
        for dim, size in zip(each.dims, each.values.shape, strict=True):
            if dim in scales:
                continue
            if dim in group.coordinates:
                scale = _create(place, dim, group.coordinates[dim])
                scale.make_scale(dim)
            else:
                scale = place.create_dataset(dim, shape=(size,), dtype=">f4", track_order=True)
                scale.make_scale(_NO_VARIABLE.format(size))
            scale.attrs["_Netcdf4Dimid"] = np.int32(dimensions)
            scales[dim], dimensions = scale, dimensions + 1
    for name, each in group.variables.items():
        dataset = _create(place, name, each)
        for axis, dim in enumerate(each.dims):
            dataset.dims[axis].attach_scale(scales[dim])
    return dimensions


def _create(place: h5py.Group, name: str, variable: Variable) -> h5py.Dataset:
    values = variable.values
    kind = values.dtype
    if kind.kind in "OU":
        kind = h5py.string_dtype("utf-8")
        values = np.array([storable(str(each)) for each in values.flat], dtype=object).reshape(values.shape)
    fill = np.nan if values.dtype.kind == "f" else None  # what xarray takes for a missing number
    dataset = place.create_dataset(name, data=values, dtype=kind, fillvalue=fill, track_order=True)
    if fill is not None:
        dataset.attrs["_FillValue"] = np.array([fill])
    for key, value in variable.attrs.items():
        _describe(dataset, key, value)
    return dataset


def _describe(place: h5py.Group | h5py.Dataset, key: str, value: str | float | np.ndarray) -> None:
    """Set an attribute: text, or numbers, which netCDF keeps in arrays of one dimension."""
    place.attrs[key] = storable(value) if isinstance(value, str) else np.atleast_1d(value)
