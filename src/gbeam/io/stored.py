"""Results read from a file, and the histories of a run as a table of text."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import existing
from gbeam.guards.processes import confined
from gbeam.io.hdf5 import contents, contents_of, image, provenance_of
from gbeam.io.netcdf import groups_of
from gbeam.results.provenance import Provenance
from gbeam.results.result import Result


@dataclass(frozen=True)
class Stored:
    """Contents of a file."""

    variables: dict[str, Any]  # by path, ``motions/flight/displacement``; text as str
    attrs: dict[str, dict[str, Any]]  # of variables and groups, by path; ``""`` is the root

    @property
    def provenance(self) -> Provenance:
        """Provenance of the result."""
        return provenance_of({name: each for name, each in self.variables.items() if "/" not in name}, self.attrs)


def stored(result: Result) -> Stored:
    """Contents of the file that a result would have."""
    with h5py.File(io.BytesIO(image(groups_of(result, every=False)))) as file:
        return _stored(**contents_of(file))


def read_stored(path: str | os.PathLike[str]) -> Stored:
    """Read a file, in a process of its own."""

    def refuse(problem: str) -> InputError:
        return InputError(str(path), problem, "give a result.nc written by gbeam run")

    if not existing(Path(path)) or not Path(path).is_file():
        raise refuse("is no file")
    return _stored(**confined(contents, path, refuse=refuse))


def _stored(variables: dict[str, Any], attrs: dict[str, dict[str, Any]]) -> Stored:
    arrays = {name: each if isinstance(each, str) else np.asarray(each) for name, each in variables.items()}
    return Stored(arrays, attrs)


_HEAD = "motion,time_s"
_VECTORS = {  # variable, name of its columns, unit
    "tip": ("tip", "m"),
    "section_force": ("root_section_force", "N"),
    "section_moment": ("root_section_moment", "N_m"),
    "root_acceleration": ("root_acceleration", "m_per_s2"),
    "load_reference": ("load_target", "m_per_s2"),
    "load_actual": ("load_made", "m_per_s2"),
    "axis_angle": ("axis_angle", "rad"),
    "axis_rate": ("axis_rate", "rad_per_s"),
    "axis_acceleration": ("axis_acceleration", "rad_per_s2"),
}


def csv_of(stored: Stored) -> str:
    """Return one line for each time of each motion, SI, base axes; what a motion does not have is empty.

    Of the sections' forces, moments and stress it has those of the root, in the axes of its section: those of the beam
    on its base, and so of another sign than root_force and root_moment elsewhere, which are those of the base.
    """
    names = [path.split("/")[1] for path in stored.variables if path.startswith("motions/") and path.endswith("/time")]
    columns = [
        f"{name}_{part}_{unit}"
        for variable, (name, unit) in _VECTORS.items()
        for part in ("123" if variable.startswith("axis") else "xyz")
    ]
    lines = [",".join([_HEAD, *columns, "stress_Pa"])]
    for name in names:
        lines.extend(_rows(stored, name, len(columns)))
    return "\n".join(lines) + "\n"


def _rows(stored: Stored, name: str, count: int) -> Iterator[str]:
    place = f"motions/{name}/"
    time = stored.variables[f"{place}time"]
    values = np.full((len(time), count + 1), np.nan)
    for k, variable in enumerate(_VECTORS):
        array = stored.variables.get(place + ("displacement" if variable == "tip" else variable))
        if array is not None:
            station = -1 if variable == "tip" else 0
            values[:, 3 * k : 3 * k + 3] = array[:, station] if array.ndim == 3 else array
    stress = stored.variables.get(f"{place}stress")
    if stress is not None:
        values[:, -1] = stress[:, 0]
    quoted = f'"{name}"' if "," in name or '"' in name else name
    for t, row in zip(time, values, strict=True):
        yield f"{quoted},{t:.9g}," + ",".join("" if np.isnan(each) else f"{each:.9g}" for each in row)
