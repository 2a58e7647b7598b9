"""Provenance in files."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.guards.limits import EMBEDDED
from gbeam.io.layout import Variable
from gbeam.results.provenance import Environment, Provenance, RecordFile

RECORD = "record_"  # before the flight's name
_LEVEL = 4  # of compression: more saves 3 % of a record's text in six times the time


def provenance_attrs(provenance: Provenance) -> dict[str, str]:
    """Attributes of the root: what is short."""
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
    """Variables of the root: the scenario's text, since an attribute ends at 64 KiB, and the records."""
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
    """The provenance that a file holds."""
    root = attrs[""]
    dependencies = dict(line.split(" ", 1) for line in str(root.get("dependencies", "")).splitlines())
    versions = [str(root.get(name, "")) for name in ("gbeam_version", "python_version", "platform")]
    records = []
    for name, values in variables.items():
        if name.startswith(RECORD) and "sha256" in attrs[name]:
            packed = values.tobytes()
            content = zlib.decompressobj().decompress(packed, EMBEDDED) if len(packed) > 1 else None
            file, digest = (str(attrs[name][key]) for key in ("file", "sha256"))
            records.append(RecordFile(name.removeprefix(RECORD), file, digest, content))
    return Provenance(
        scenario=str(variables["scenario"]) if "scenario" in variables else "",
        overrides=tuple(str(root.get("overrides", "")).splitlines()),
        sha256=str(root.get("scenario_sha256", "")),
        records=tuple(records),
        command=str(root.get("command", "")),
        environment=Environment(versions[0], versions[1], versions[2], dependencies),
        date=str(root.get("date", "")),
    )
