"""What a file holds of a sweep: one array per measure, along the parameters."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from gbeam.io.groups import Group, Variable, coordinate, labels, variable
from gbeam.results.studies.sweep import SAMPLE, Parameter, Sweep
from gbeam.results.studies.uncertainty import BOUNDS, ORDERS, PROBABILITY

_ROOM = 3 * 2**26  # bytes: stack and heap of a thread of zarr


def sweep_group(sweep: Sweep) -> Group:
    """Return what a file holds of a sweep; what is drawn is a coordinate along ``sample``."""
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
        along = (*dims, "time")
        data |= {
            f"{name} history": variable(along, values, sweep.units[name], f"{name} over time")
            for name, values in sweep.histories.items()
        }
    data |= _statistics(sweep)
    coordinates = {each.path: _coordinate(each) for each in sweep.parameters}
    if SAMPLE in dims:
        count = sweep.outcome.shape[-1]
        coordinates[SAMPLE] = variable((SAMPLE,), np.arange(count), "1", "number of the sample")
    if sweep.histories:
        coordinates |= coordinate("time", sweep.time, "s", "time")
    if sweep.statistics:
        coordinates |= labels("bound", BOUNDS)
    for each in sweep.statistics.values():
        if PROBABILITY not in each.names:
            coordinates |= labels("statistic", each.names)
    for shares in sweep.indices.values():
        coordinates |= labels("parameter", shares.parameters) | labels("order", ORDERS)
    return Group(data | outcome, coordinates, {"title": sweep.title, "verb": sweep.verb, "outcome": sweep.state})


def _statistics(sweep: Sweep) -> dict[str, Variable]:
    """What samples say, at every point of the grid."""
    grid = tuple(name for name in sweep.dimensions if name != SAMPLE)
    found = {}
    for name, each in sweep.statistics.items():
        dims = (*grid, "time") if name in sweep.histories else grid
        words = f"{name}: estimates with bounds of 95 % confidence"
        if PROBABILITY in each.names:
            found[f"{name} probability"] = variable((*dims, "bound"), each[PROBABILITY], "1", words)
        else:
            unit = sweep.units[name] or "1"
            found[f"{name} statistics"] = variable((*dims, "statistic", "bound"), each.values, unit, words)
        found[f"{name} count"] = variable(dims, each.count, "1", f"{name}: draws that the estimates come from")
    for name, shares in sweep.indices.items():
        dims = (*grid, "parameter", "order", "bound")
        found[f"{name} indices"] = variable(dims, shares.values, "1", f"{name}: Sobol indices")
    return found


def write_zarr(sweep: Sweep, path: str | os.PathLike[str]) -> None:
    """Write a sweep as a Zarr store, which ``xarray.open_zarr`` opens, whole or not at all.

    Parameters
    ----------
    sweep : Sweep
    path : path
        Replaced if it exists.

    Raises
    ------
    OSError
        If it cannot be written.
    """
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


def _coordinate(parameter: Parameter) -> Variable:
    attrs = {"units": parameter.unit or "1"} if parameter.numeric else {}
    drawn = {"distribution": parameter.drawn} if parameter.drawn else {}
    return Variable((parameter.dimension,), parameter.values, attrs | {"long_name": parameter.path} | drawn)
