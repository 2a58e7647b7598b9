"""Results as netCDF files, which xarray, MATLAB and h5py open, and as xarray's own objects.

A study is one file: the root says what was computed, from what, and the verdict; ``motions/NAME`` holds the response
in one environment and ``comparisons/NAME`` what a centrifuge's response is compared with. Any other result is a file
without groups. Variables are SI and carry ``units``, ``long_name`` and, for vectors, the ``frame`` of their components.
``xarray.open_datatree`` opens all of it, ``xarray.open_dataset`` one group.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.io.groups import Group, Variable, thinned
from gbeam.io.hdf5 import write_groups
from gbeam.io.layout import whole_group
from gbeam.io.provenance import provenance_attrs, provenance_variables
from gbeam.io.special import deflection_group, plan_group, response_group, sweep_group
from gbeam.results.cases import Sweep
from gbeam.results.equilibrium import Deflection
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.provenance import Provenance
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Answers
from gbeam.results.system import SystemResponse

FACTS = "facts"  # the variable of the root with the figures as JSON
# Of kinds whose file has more than their declared fields.
_GROUPS: dict[type, Callable[[Any], Group]] = {
    Response: response_group,
    Deflection: deflection_group,
    MachinePlan: plan_group,
    Sweep: sweep_group,
}


def save(result: Any, path: str | os.PathLike[str], facts: str = "") -> None:
    """Write any result to a netCDF file, whole or not at all; of histories so many samples as the result says."""
    groups = groups_of(result, every=False)
    if facts:
        root = groups[""]
        text = Variable((), np.array(facts, dtype=object), {"long_name": "figures, as --json prints them"})
        groups[""] = Group({FACTS: text} | root.variables, root.coordinates, root.attrs)
    write_groups(groups, path)


def groups_of(result: Result, *, every: bool = True) -> dict[str, Group]:
    """Groups of a file by path: the root says what it is and where it comes from."""
    groups = _study(result, every=every) if isinstance(result, Answers) else {"": _group(result, every=every)}
    origin = result.provenance or Provenance()
    root = groups[""]
    about = provenance_attrs(origin) | {"warnings": "\n".join(result.warnings)}
    variables = provenance_variables(origin) if origin.scenario else {}
    groups[""] = Group(variables | root.variables, root.coordinates, root.attrs | about)
    return groups


def to_xarray(result: Any) -> Any:
    """Return a result as an xarray.Dataset, a study as an xarray.DataTree."""
    import xarray as xr  # half a second

    def dataset(group: Group) -> xr.Dataset:
        return xr.Dataset(dict(group.variables), dict(group.coordinates), group.attrs)

    every = {path: dataset(group) for path, group in groups_of(result).items()}
    return xr.DataTree.from_dict({f"/{path}": each for path, each in every.items()}) if len(every) > 1 else every[""]


def _group(result: Result, *, every: bool) -> Group:
    group = _GROUPS.get(type(result), whole_group)(result)
    return (
        thinned(group, result.kept_every)
        if isinstance(result, (Response, SystemResponse, Comparison)) and not every
        else group
    )


def _study(study: Answers, *, every: bool) -> dict[str, Group]:
    attrs = {
        "title": study.title,
        "outcome": study.outcome,
        "verdict": "\n".join(each.verdict for each in study.comparisons),
        "summary": repr(study),
    }
    attrs |= {f"failure_{name}": f"{failed.outcome}: {failed.message}" for name, failed in study.failures.items()}
    groups = {"": Group({}, {}, attrs)}
    groups |= {f"motions/{name}": _group(response, every=every) for name, response in study.responses.items()}
    groups |= {f"comparisons/{each.centrifuge}": _group(each, every=every) for each in study.comparisons}
    return groups


_ROOM = 3 * 2**26  # bytes: stack and heap of a thread of zarr


def write_zarr(sweep: Sweep, path: str | os.PathLike[str]) -> None:
    """Write a sweep as a Zarr store, which ``xarray.open_zarr`` opens, whole or not at all."""
    import zarr  # noqa: F401  # xarray takes one that cannot be loaded for one that is not installed

    bytearray(_ROOM)  # a thread that lacks it is waited for without end: a MemoryError comes first
    final = Path(path)
    hidden = Path(tempfile.mkdtemp(prefix=f".{final.name}-", dir=final.parent))
    try:
        # Format 2 has strings of any length that every reader knows.
        sweep.to_xarray().to_zarr(hidden / final.name, mode="w", zarr_format=2, consolidated=True)
        if final.exists():
            os.rename(final, hidden / "replaced")
        os.rename(hidden / final.name, final)
    finally:
        shutil.rmtree(hidden, ignore_errors=True)
