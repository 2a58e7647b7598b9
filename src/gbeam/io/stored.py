"""Files of results read back as they were written: every variable and attribute, undecoded."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import existing
from gbeam.io.hdf5 import image
from gbeam.io.netcdf import groups_of
from gbeam.io.provenance import provenance_of
from gbeam.results.provenance import Provenance
from gbeam.results.result import Result

_BOOKKEEPING = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates")


@dataclass(frozen=True)
class Stored:
    """What a file holds.

    Parameters
    ----------
    variables : dict of str to array
        By path, ``motions/flight/displacement``; text as str.
    attrs : dict of str to dict
        Of variables and groups, by path; ``""`` is the root.
    """

    variables: dict[str, Any]
    attrs: dict[str, dict[str, Any]]

    @property
    def provenance(self) -> Provenance:
        """Where it comes from."""
        return provenance_of({name: each for name, each in self.variables.items() if "/" not in name}, self.attrs)


def stored(result: Result) -> Stored:
    """What a result's file would hold."""
    with h5py.File(io.BytesIO(image(groups_of(result)))) as file:
        return _contents(file)


def read_stored(path: str | os.PathLike[str]) -> Stored:
    """Read a file.

    Raises
    ------
    InputError
        If there is none, or it is no netCDF-4 file.
    """
    fix = "give a result.nc written by gbeam run"
    if not existing(Path(path)) or not Path(path).is_file():
        raise InputError(str(path), "is no file", fix)
    try:
        with h5py.File(path) as file:
            return _contents(file)
    except MemoryError:
        raise
    except Exception:  # a damaged file leads HDF5 to any
        raise InputError(str(path), "is not a netCDF-4 file that can be read", fix) from None


def _contents(file: h5py.File) -> Stored:
    found = Stored({}, {"": _attrs(file)})

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        found.attrs[name] = _attrs(node)
        if isinstance(node, h5py.Dataset):
            values = node.asstr()[()] if node.dtype.kind == "O" else node[()]
            found.variables[name] = values if isinstance(values, str) else np.asarray(values)

    file.visititems(visit)
    return found


def _attrs(node: Any) -> dict[str, Any]:
    return {name: value for name, value in node.attrs.items() if name not in _BOOKKEEPING}
