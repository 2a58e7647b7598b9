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
from gbeam.guards.confined import confined
from gbeam.guards.limits import existing
from gbeam.io.hdf5 import contents, contents_of, image
from gbeam.io.netcdf import groups_of
from gbeam.io.provenance import provenance_of
from gbeam.results.provenance import Provenance
from gbeam.results.result import Result


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
    with h5py.File(io.BytesIO(image(groups_of(result, every=False)))) as file:
        return _stored(**contents_of(file))


def read_stored(path: str | os.PathLike[str]) -> Stored:
    """Read a file, in a process of its own.

    Raises
    ------
    InputError
        If there is none, or it is no netCDF-4 file.
    """

    def refuse(problem: str) -> InputError:
        return InputError(str(path), problem, "give a result.nc written by gbeam run")

    if not existing(Path(path)) or not Path(path).is_file():
        raise refuse("is no file")
    return _stored(**confined(contents, path, refuse=refuse))


def _stored(variables: dict[str, Any], attrs: dict[str, dict[str, Any]]) -> Stored:
    arrays = {name: each if isinstance(each, str) else np.asarray(each) for name, each in variables.items()}
    return Stored(arrays, attrs)
