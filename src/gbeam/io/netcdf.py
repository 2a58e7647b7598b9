"""Results as netCDF files, which xarray, MATLAB and h5py open, read back, and as xarray's own objects.

A study is one file: the root says what was computed, from what, and the verdict. ``motions/NAME`` holds the response
in one environment and ``comparisons/NAME`` what a centrifuge's response is compared with. Any other result is a file
without groups. Variables are SI and carry ``units``, ``long_name`` and, for vectors, the ``frame`` of their components.
``xarray.open_datatree`` opens all of it, ``xarray.open_dataset`` one group.
"""

from __future__ import annotations

import io
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import existing
from gbeam.guards.processes import read_confined
from gbeam.io.hdf5 import (
    contents,
    contents_of,
    image,
    provenance_attrs,
    provenance_of,
    provenance_variables,
    write_groups,
)
from gbeam.io.layout import (
    Group,
    Variable,
    completed,
    coordinate,
    drop_unknown,
    group_of,
    in_files,
    labels,
    thinned,
    variable,
    whole_group,
)
from gbeam.results.cases import BOUNDS, ORDERS, PROBABILITY, SAMPLE, Parameter, Sweep
from gbeam.results.comparison import MachinePlan
from gbeam.results.machine import LimitUse
from gbeam.results.provenance import Provenance
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Study


def response_group(response: Response) -> Group:
    """Return what a file holds of a response."""
    group = whole_group(response)
    limits = {} if response.axes is None else limits_variables(response.axes.limits)
    return Group(drop_unknown(group.variables) | limits, group.coordinates, group.attrs)


def plan_group(plan: MachinePlan) -> Group:
    """Return what a file holds of a plan."""
    axes, load, group = group_of(plan.axes), group_of(plan.accounting), whole_group(plan)
    # Where the target is not the flight's load, and where the load is not the flight's, are two things.
    judged = {f"load_{name}" if name in axes.variables else name: entry for name, entry in load.variables.items()}
    variables = axes.variables | limits_variables(plan.axes.limits) | drop_unknown(judged) | group.variables
    return completed(Group(variables, group.coordinates, group.attrs))


def limits_variables(uses: tuple[LimitUse, ...]) -> dict[str, Variable]:
    """Return variables of the use, limit and time of each quantity: of the three axes, or of the arm its power."""
    variables = {}
    for quantity in dict.fromkeys(use.quantity for use in uses):
        rows = [use for use in uses if use.quantity == quantity]
        unit = in_files(rows[0].unit)
        whose, dims = ("of the arm", ()) if quantity == "power" else ("of each axis of the machine", ("machine_axis",))
        used, allowed, time = np.array([(use.used, use.allowed, use.time) for use in rows], dtype=float).T
        if not dims:  # the arm's power is one number
            used, allowed, time = used[0], allowed[0], time[0]
        limit = f"limit of that {quantity}; infinite where none is given"
        variables[f"{quantity}_used"] = variable(dims, used, unit, f"largest {quantity} {whose}, without sign")
        variables[f"{quantity}_allowed"] = variable(dims, allowed, unit, limit)
        variables[f"{quantity}_time"] = variable(dims, time, "s", f"when the largest {quantity} is used")
    return variables


def sweep_group(sweep: Sweep) -> Group:
    """Return what a file holds of a sweep. Randomly drawn parameters lie along ``sample``."""
    dims = sweep.dimensions
    data = {
        name: variable(dims, values, sweep.units[name] or "1", f"{sweep.verb}: {name}")
        for name, values in sweep.measures.items()
    }
    outcome = {
        "outcome": Variable(dims, sweep.outcome, {"long_name": "how the case ended"}),
        "message": Variable(dims, sweep.message, {"long_name": "why the case is not done"}),
    }
    if sweep.histories:
        history_dims = (*dims, "time")
        data |= {
            f"{name} history": variable(history_dims, values, sweep.units[name], f"{name} over time")
            for name, values in sweep.histories.items()
        }
    data |= _statistics(sweep)
    coordinates = {parameter.path: _coordinate(parameter) for parameter in sweep.parameters}
    if SAMPLE in dims:
        count = sweep.outcome.shape[-1]
        coordinates[SAMPLE] = variable((SAMPLE,), np.arange(count), "1", "number of the sample")
    if sweep.histories:
        coordinates |= coordinate("time", sweep.time, "s", "time")
    if sweep.statistics:
        coordinates |= labels("bound", BOUNDS)
    for statistic in sweep.statistics.values():
        if PROBABILITY not in statistic.names:
            coordinates |= labels("statistic", statistic.names)
    for sensitivity in sweep.indices.values():
        coordinates |= labels("parameter", sensitivity.parameters) | labels("order", ORDERS)
    return Group(data | outcome, coordinates, {"title": sweep.title, "verb": sweep.verb, "outcome": sweep.state})


def _statistics(sweep: Sweep) -> dict[str, Variable]:
    """Variables of the statistics and Sobol indices at every point of the grid."""
    grid = tuple(name for name in sweep.dimensions if name != SAMPLE)
    variables = {}
    for name, statistic in sweep.statistics.items():
        dims = (*grid, "time") if name in sweep.histories else grid
        words = f"{name}: estimates with bounds of 95 % confidence"
        if PROBABILITY in statistic.names:
            variables[f"{name} probability"] = variable((*dims, "bound"), statistic[PROBABILITY], "1", words)
        else:
            unit = sweep.units[name] or "1"
            variables[f"{name} statistics"] = variable((*dims, "statistic", "bound"), statistic.values, unit, words)
        variables[f"{name} count"] = variable(dims, statistic.count, "1", f"{name}: draws that the estimates come from")
    for name, shares in sweep.indices.items():
        dims = (*grid, "parameter", "order", "bound")
        variables[f"{name} indices"] = variable(dims, shares.values, "1", f"{name}: Sobol indices")
    return variables


def _coordinate(parameter: Parameter) -> Variable:
    attrs = {"units": parameter.unit or "1"} if parameter.numeric else {}
    distribution = {"distribution": parameter.drawn} if parameter.drawn else {}
    return Variable((parameter.dimension,), parameter.values, attrs | {"long_name": parameter.path} | distribution)


FACTS = "facts"  # the variable of the root with the figures as JSON
# Of kinds whose file has more than their declared fields.
_GROUPS: dict[type, Callable[[Any], Group]] = {
    Response: response_group,
    MachinePlan: plan_group,
    Sweep: sweep_group,
}


def save(result: Any, path: str | os.PathLike[str], facts: str = "") -> None:
    """Write any result to a netCDF file, whole or not at all. Histories are thinned as the result says."""
    groups = groups_of(result, every=False)
    if facts:
        root = groups[""]
        text = Variable((), np.array(facts, dtype=object), {"long_name": "figures, as --json prints them"})
        groups[""] = Group({FACTS: text} | root.variables, root.coordinates, root.attrs)
    write_groups(groups, path)


def groups_of(result: Result, *, every: bool = True) -> dict[str, Group]:
    """Groups of a file by path. The root says what the result is and where it comes from.

    `every` keeps all samples of histories.
    """
    groups = _study(result, every=every) if isinstance(result, Study) else {"": _group(result, every=every)}
    origin = result.provenance or Provenance()
    root = groups[""]
    attrs = provenance_attrs(origin) | {"warnings": "\n".join(result.warnings), "notes": "\n".join(result.notes)}
    variables = provenance_variables(origin) if origin.scenario else {}
    groups[""] = Group(variables | root.variables, root.coordinates, root.attrs | attrs)
    return groups


def to_xarray(result: Any) -> Any:
    """Return a result as an xarray.Dataset, a study as an xarray.DataTree."""
    import xarray as xr  # half a second

    def dataset(group: Group) -> xr.Dataset:
        return xr.Dataset(dict(group.variables), dict(group.coordinates), group.attrs)

    datasets = {path: dataset(group) for path, group in groups_of(result).items()}
    if len(datasets) == 1:
        return datasets[""]
    return xr.DataTree.from_dict({f"/{path}": values for path, values in datasets.items()})


def _group(result: Result, *, every: bool) -> Group:
    """Group of a result, with the samples of histories that files keep, or with `every` one."""
    group = _GROUPS.get(type(result), whole_group)(result)
    return thinned(group, 1 if every else result.kept_every)


def _study(study: Study, *, every: bool) -> dict[str, Group]:
    """Groups of a study: the root with its attributes, every motion, and every comparison."""
    attrs = {
        "title": study.title,
        "outcome": study.outcome,
        "verdict": "\n".join(comparison.verdict for comparison in study.comparisons),
        "summary": repr(study),
    }
    attrs |= {f"failure_{name}": f"{failed.outcome}: {failed.message}" for name, failed in study.failures.items()}
    groups = {"": Group({}, {}, attrs)}
    groups |= {f"motions/{name}": _group(response, every=every) for name, response in study.responses.items()}
    groups |= {
        f"comparisons/{comparison.centrifuge}": _group(comparison, every=every) for comparison in study.comparisons
    }
    return groups


_ROOM = 3 * 2**26  # bytes: stack and heap of a thread of zarr


def write_zarr(sweep: Sweep, path: str | os.PathLike[str]) -> None:
    """Write a sweep as a Zarr store, which ``xarray.open_zarr`` opens, whole or not at all."""
    import zarr  # noqa: F401  # xarray takes one that cannot be loaded for one that is not installed

    np.empty(_ROOM, np.uint8)  # a thread that lacks it is waited for without end: a MemoryError comes first
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


@dataclass(frozen=True)
class Stored:
    """Contents of a file."""

    variables: dict[str, Any]  # by path, ``motions/flight/displacement``; text as str
    attrs: dict[str, dict[str, Any]]  # of variables and groups, by path; ``""`` is the root

    @property
    def provenance(self) -> Provenance:
        """Provenance of the result."""
        return provenance_of({name: entry for name, entry in self.variables.items() if "/" not in name}, self.attrs)


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
    return _stored(**read_confined(contents, path, refuse=refuse))


def _stored(variables: dict[str, Any], attrs: dict[str, dict[str, Any]]) -> Stored:
    arrays = {name: content if isinstance(content, str) else np.asarray(content) for name, content in variables.items()}
    return Stored(arrays, attrs)


_HEAD = "motion,time_s"
_OF_BODIES = {  # variable, name of its columns, unit
    "displacement": ("tip", "m"),
    "section_force": ("root_section_force", "N"),
    "section_moment": ("root_section_moment", "N_m"),
    "root_acceleration": ("root_acceleration", "m_per_s2"),
}
_OF_MACHINES = {
    "load_reference": ("load_target", "m_per_s2"),
    "load_actual": ("load_made", "m_per_s2"),
    "axis_angle": ("axis_angle", "rad"),
    "axis_rate": ("axis_rate", "rad_per_s"),
    "axis_acceleration": ("axis_acceleration", "rad_per_s2"),
}


def csv_of(stored: Stored) -> str:
    """Return one line for each time of each motion, SI, base axes. What a motion does not have is empty.

    Columns of a body begin with its name where there are several. Of the sections' forces, moments and stress a body
    has those of the root, in the axes of its section: those of the beam on its base, and so of another sign than
    root_force and root_moment elsewhere, which are those of the base.
    """
    paths = [path.split("/")[1:] for path in stored.variables if path.startswith("motions/")]
    motions = [name for name, variable in paths if variable == "time"]
    ending = "_displacement"
    bodies = [*dict.fromkeys(name.removesuffix(ending) for _, name in paths if name.endswith(ending))]
    prefixes = {body: f"{body}_" if len(bodies) > 1 else "" for body in bodies}
    vectors = {}
    for body, prefix in prefixes.items():
        for quantity, (name, unit) in _OF_BODIES.items():
            vectors[f"{body}_{quantity}"] = f"{prefix}{name}", unit
    vectors |= _OF_MACHINES
    columns = []
    for quantity, (name, unit) in vectors.items():
        components = "123" if quantity in _OF_MACHINES else "xyz"
        columns += [f"{name}_{component}_{unit}" for component in components]
    stresses = {f"{body}_stress": f"{prefix}stress_Pa" for body, prefix in prefixes.items()}
    lines = [",".join([_HEAD, *columns, *stresses.values()])]
    for name in motions:
        lines.extend(_rows(stored, name, vectors, stresses))
    return "\n".join(lines) + "\n"


def _rows(stored: Stored, name: str, vectors: Iterable[str], stresses: Iterable[str]) -> Iterator[str]:
    """Lines of one motion: its name, the time, components of vectors at the tip or the root, and stress of the root."""
    place = f"motions/{name}/"
    time = stored.variables[f"{place}time"]
    columns = []
    for vector in vectors:
        array = stored.variables.get(f"{place}{vector}", np.full((len(time), 3), np.nan))
        station = -1 if vector.endswith("_displacement") else 0
        columns.append(array[:, station] if array.ndim == 3 else array)
    for stress in stresses:
        columns.append(stored.variables.get(f"{place}{stress}", np.full((len(time), 1), np.nan))[:, :1])
    quoted = f'"{name}"' if "," in name or '"' in name else name
    for t, row in zip(time, np.concatenate(columns, axis=1), strict=True):
        yield f"{quoted},{t:.9g}," + ",".join("" if np.isnan(value) else f"{value:.9g}" for value in row)
