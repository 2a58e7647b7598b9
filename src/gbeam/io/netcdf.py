"""Results as netCDF files, which xarray, MATLAB and h5py open, and as xarray's own objects.

A study is one file: the root says what was computed, from what, and the verdict; ``motions/NAME`` holds the response
in one environment and ``comparisons/NAME`` what a centrifuge's response is compared with. Any other result is a file
without groups. Variables are SI and carry ``units``, ``long_name`` and, for vectors, the ``frame`` of their components.
``xarray.open_datatree`` opens all of it, ``xarray.open_dataset`` one group.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.groups import Group, Variable
from gbeam.io.hdf5 import write_groups
from gbeam.io.layout.comparisons import comparison_group
from gbeam.io.layout.machine import plan_group
from gbeam.io.layout.responses import response_group
from gbeam.io.layout.steady import campbell_group, critical_group, critical_map_group, deflection_group, modes_group
from gbeam.io.layout.studies.fits import fit_group
from gbeam.io.layout.studies.optima import optimum_group
from gbeam.io.layout.studies.sensitivities import sensitivity_group
from gbeam.io.layout.studies.shaping import shaping_group
from gbeam.io.layout.studies.sweeps import sweep_group
from gbeam.io.layout.tables import models_group, placement_group, state_space_group
from gbeam.io.provenance import provenance_attrs, provenance_variables
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.placement import Placement
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.provenance import Provenance
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.modal import Campbell, Modes
from gbeam.results.steady.stability import Critical, CriticalMap
from gbeam.results.steady.state_space import StateSpace
from gbeam.results.studies.fit import Fit
from gbeam.results.studies.optimum import Optimum
from gbeam.results.studies.sensitivity import Sensitivity
from gbeam.results.studies.shaping import ShapedCommand
from gbeam.results.studies.sweep import Sweep
from gbeam.results.study import ModelStudy, Study

if TYPE_CHECKING:
    import xarray as xr

FACTS = "facts"  # the variable of the root with the figures as JSON
_GROUPS: dict[type, Callable[[Any], Group]] = {
    Response: response_group,
    Comparison: comparison_group,
    Deflection: deflection_group,
    Modes: modes_group,
    Campbell: campbell_group,
    Critical: critical_group,
    CriticalMap: critical_map_group,
    Fit: fit_group,
    Optimum: optimum_group,
    MachinePlan: plan_group,
    ModelStudy: models_group,
    Placement: placement_group,
    Sensitivity: sensitivity_group,
    ShapedCommand: shaping_group,
    StateSpace: state_space_group,
    Sweep: sweep_group,
}


def save(result: Any, path: str | os.PathLike[str], facts: str = "") -> None:
    """Write any result to a netCDF file, whole or not at all.

    Parameters
    ----------
    result : Result
    path : path
    facts : str
        Its figures as JSON, from which `gbeam report` makes a page; none where it has no report.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    groups = groups_of(result)
    if facts:
        root = groups[""]
        text = Variable((), np.array(facts, dtype=object), {"long_name": "figures, as --json prints them"})
        groups[""] = Group({FACTS: text} | root.variables, root.coordinates, root.attrs)
    write_groups(groups, path)


def groups_of(result: Result) -> dict[str, Group]:
    """What a file holds of any result, by path: the root says what it is and where it comes from."""
    groups = _study(result) if isinstance(result, Study) else {"": _GROUPS[type(result)](result)}
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


def read(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read a file that :func:`write` or :func:`save` wrote, into memory.

    Parameters
    ----------
    path : path

    Returns
    -------
    xarray.DataTree
        For example ``tree["motions/flight"]["displacement"].sel(axis="z")``.

    Raises
    ------
    InputError
        If there is no such file, or it is not netCDF.
    """
    import xarray as xr

    try:
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()
    except OSError as error:
        reason = error.strerror or "not a netCDF-4 file"
        raise InputError(str(path), f"cannot be read ({reason})", "give a result.nc written by gbeam run") from None


def _study(study: Study) -> dict[str, Group]:
    attrs = {
        "title": study.title,
        "outcome": study.outcome,
        "verdict": "\n".join(each.verdict for each in study.comparisons),
        "summary": repr(study),
    }
    attrs |= {f"failure_{name}": f"{failed.outcome}: {failed.message}" for name, failed in study.failures.items()}
    groups = {"": Group({}, {}, attrs)}
    groups |= {f"motions/{name}": response_group(response) for name, response in study.responses.items()}
    groups |= {f"comparisons/{each.centrifuge}": comparison_group(each) for each in study.comparisons}
    return groups
