"""Groups written to a netCDF-4 file, its provenance, and what it holds. Xarray takes longer to import than a run."""

from __future__ import annotations

import io
import os
import zlib
from collections.abc import Mapping
from typing import Any

import h5netcdf
import h5py
import numpy as np

from gbeam.errors import InputError
from gbeam.guards.hdf5_files import open_hdf5
from gbeam.guards.limits import EMBEDDED
from gbeam.io.kept import write_whole
from gbeam.io.layout import Group, Variable
from gbeam.printable import storable
from gbeam.results.provenance import Environment, Provenance, RecordFile

# Attributes of the format.
_NO_VARIABLE = b"This is a netCDF dimension but not"  # by netCDF's convention: a dimension without values of its own
_BOOKKEEPING = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_NCProperties"}
_BOOKKEEPING |= {"_Netcdf4Dimid", "_Netcdf4Coordinates"}
# All of a result compressed takes a quarter of the time of a run, and saves 30 %; zeros cost nearly nothing.
_EMPTY, _MANY = 0.3, 2_000  # share of zeros, and number of values, from which on a variable is compressed
_COMPRESSED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def write_groups(groups: Mapping[str, Group], path: str | os.PathLike[str]) -> None:
    """Write groups to a file, whole or not at all."""
    write_whole(path, image(groups))


def image(groups: Mapping[str, Group]) -> bytes:
    """Bytes of a netCDF file, made in memory: HDF5 ends the process if a disk is full when it closes a file."""
    buffer = io.BytesIO()
    with h5netcdf.File(buffer, "w", libver=("earliest", "v110")) as file:
        for path, group in groups.items():
            place = file.create_group(path) if path else file
            _describe(place, group.attrs)
            for name, variable in (group.coordinates | group.variables).items():
                for dim, size in zip(variable.dims, variable.values.shape, strict=True):
                    if dim not in place.dimensions:
                        place.dimensions[dim] = size
                _create(place, name, variable)
    return buffer.getvalue()


def contents(path: str) -> dict[str, Any]:
    """Return the variables of a file by path, and the undecoded attributes of its variables and groups."""
    try:
        with open_hdf5(path) as file:
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
        if isinstance(node, h5py.Dataset) and not bytes(node.attrs.get("NAME", b"")).startswith(_NO_VARIABLE):
            variables[name] = _non_empty(node.asstr()[()] if node.dtype.kind == "O" else node[()])

    file.visititems(visit)
    return {"variables": variables, "attrs": attrs}


def _attrs(node: h5py.Group | h5py.Dataset) -> dict[str, Any]:
    return {name: _non_empty(value) for name, value in node.attrs.items() if name not in _BOOKKEEPING}


def _non_empty(value: Any) -> Any:
    return "" if isinstance(value, h5py.Empty) else value


def _create(place: h5netcdf.Group, name: str, variable: Variable) -> None:
    """Create a variable of a group. Text is stored as UTF-8; a missing number is NaN."""
    values = variable.values
    kind = values.dtype
    if kind.kind in "OU":
        kind = h5py.string_dtype("utf-8")
        values = np.array([storable(str(text)) for text in values.flat], dtype=object).reshape(values.shape)
    fill = np.nan if values.dtype.kind == "f" else None  # what xarray takes for a missing number
    zeros = values.size - np.count_nonzero(values) if fill is not None else 0
    storage = _COMPRESSED if values.size >= _MANY and zeros >= _EMPTY * values.size else {}
    _describe(place.create_variable(name, variable.dims, kind, values, fill, **storage), variable.attrs)


def _describe(place: h5netcdf.Group | h5netcdf.Variable, attrs: Mapping[str, Any]) -> None:
    place.attrs.update({key: storable(value) if isinstance(value, str) else value for key, value in attrs.items()})


RECORD = "record_"  # before the flight's name
_LEVEL = 4  # of compression: more saves 3 % of a record's text in six times the time


def provenance_attrs(provenance: Provenance) -> dict[str, str]:
    """Return the short parts of a provenance as attributes of the root."""
    provenance, environment = provenance.stated()
    return {
        "gbeam_version": environment.gbeam,
        "python_version": environment.python,
        "platform": environment.platform,
        "dependencies": "\n".join(f"{name} {version}" for name, version in environment.dependencies.items()),
        "date": provenance.date,
        "command": provenance.command,
        "overrides": "\n".join(provenance.overrides),
        "scenario_sha256": provenance.sha256,
    }


def provenance_variables(provenance: Provenance) -> dict[str, Variable]:
    """Return a scenario's text and its records as variables of the root: attributes, of 64 KiB, are too
    short for them.
    """
    text = np.array(provenance.scenario, dtype=object)
    variables = {"scenario": Variable((), text, {"long_name": "text of the scenario file"})}
    for record in provenance.records:
        packed = b"" if record.content is None else zlib.compress(record.content, _LEVEL)
        attrs = {"long_name": "bytes of the record file, compressed by zlib; none where it is too large"}
        attrs |= {"file": record.file, "sha256": record.sha256}
        name = f"{RECORD}{record.motion}"
        # netCDF takes a dimension of length zero for an unlimited one.
        values = np.frombuffer(packed or b"\0", dtype=np.uint8)
        variables[name] = Variable((f"{name}_byte",), values, attrs)
    return variables


def provenance_of(variables: Mapping[str, Any], attrs: Mapping[str, Mapping[str, Any]]) -> Provenance:
    """Return the provenance that the variables and attributes of a file hold."""
    root = attrs[""]
    dependencies = dict(line.split(" ", 1) for line in str(root.get("dependencies", "")).splitlines())
    versions = [str(root.get(name, "")) for name in ("gbeam_version", "python_version", "platform")]
    records = []
    for name, values in variables.items():
        if name.startswith(RECORD) and "sha256" in attrs[name]:
            packed = values.tobytes()
            content = zlib.decompressobj().decompress(packed, EMBEDDED) if len(packed) > 1 else None
            file, digest = str(attrs[name]["file"]), str(attrs[name]["sha256"])
            records.append(RecordFile(name.removeprefix(RECORD), file, digest, content))
    text = variables.get("scenario")
    return Provenance(
        scenario=text if isinstance(text, str) else "",
        overrides=tuple(str(root.get("overrides", "")).splitlines()),
        sha256=str(root.get("scenario_sha256", "")),
        records=tuple(records),
        command=str(root.get("command", "")),
        environment=Environment(versions[0], versions[1], versions[2], dependencies),
        date=str(root.get("date", "")),
    )
