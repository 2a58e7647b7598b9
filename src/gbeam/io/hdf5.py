"""Groups written to a netCDF-4 file by h5py alone.

netCDF-4 is HDF5 with rules: a dimension is a dimension scale, which is its coordinate variable where it has one; every
variable has the scales of its dimensions attached; things are kept in the order of their creation. xarray and h5netcdf
know the rules as well, but importing the one and the bookkeeping of the other take longer than many a computation.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

import h5py
import numpy as np

from gbeam.io.groups import Group, Variable

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"  # the format's words


def write_groups(groups: Mapping[str, Group], path: str | os.PathLike[str]) -> None:
    """Write groups to a file, whole or not at all.

    Parameters
    ----------
    groups : mapping of str to Group
        By path: ``""`` is the root, ``motions/flight`` a group in a group.
    path : path
        Replaced if it exists.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    final = Path(path)
    # Beside the file, so that the renaming is one step on the same disk.
    handle, name = tempfile.mkstemp(prefix=f".{final.name}-", suffix=".nc", dir=final.parent)
    os.close(handle)
    try:
        _write(groups, name)
        # mkstemp's files are for their owner only; a result is as readable as any other new file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, final)
    except BaseException:
        os.unlink(name)
        raise


def _write(groups: Mapping[str, Group], name: str) -> None:
    dimensions = 0  # so far, in the whole file
    with h5py.File(name, "w", track_order=True, libver=("earliest", "v110")) as file:
        for path, group in groups.items():
            place = file
            for part in filter(None, path.split("/")):
                place = place[part] if part in place else place.create_group(part, track_order=True)
            for key, value in group.attrs.items():
                _describe(place, key, value)
            dimensions = _fill(place, group, dimensions)


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
        made = _create(place, name, each)
        for axis, dim in enumerate(each.dims):
            made.dims[axis].attach_scale(scales[dim])
    return dimensions


def _create(place: h5py.Group, name: str, variable: Variable) -> h5py.Dataset:
    values = variable.values
    kind = h5py.string_dtype("utf-8") if values.dtype.kind in "OU" else values.dtype
    fill = np.nan if values.dtype.kind == "f" else None  # what xarray takes for a missing number
    made = place.create_dataset(name, data=values, dtype=kind, fillvalue=fill, track_order=True)
    if fill is not None:
        made.attrs["_FillValue"] = np.array([fill])
    for key, value in variable.attrs.items():
        _describe(made, key, value)
    return made


def _describe(place: h5py.Group | h5py.Dataset, key: str, value: str | float | np.ndarray) -> None:
    """Set an attribute: text, or numbers, which netCDF keeps in arrays of one dimension."""
    place.attrs[key] = value if isinstance(value, str) else np.atleast_1d(value)
