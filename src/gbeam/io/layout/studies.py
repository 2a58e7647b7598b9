"""Files of what many runs say together: fits, optima, sensitivities, shaped commands and sweeps."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from gbeam.io.groups import Group, Variable, coordinate, flags, labels, variable, words
from gbeam.results.cases import BOUNDS, ORDERS, PROBABILITY, SAMPLE, Parameter, Sensitivity, Sweep
from gbeam.results.searches import Fit, Optimum, ShapedCommand


def fit_group(fit: Fit) -> Group:
    """Return what a file holds of a fit; each value and datum in its SI unit, which stands beside it."""
    p, at = ("parameter",), "mode" if fit.modal else "time"
    dims = ("column", at)
    data = {
        "before": variable(p, fit.before, "1", "value of the scenario, in its unit"),
        "value": variable(p, fit.values, "1", "value found, in its unit"),
        "value_unit": words(p, fit.units, "SI unit of the value"),
        "error": variable(p, fit.errors, "1", "standard deviation of the value, in its unit"),
        "interval": variable((*p, "side"), fit.intervals, "1", "interval that holds it with a probability of 95 %"),
        "bounds": variable((*p, "side"), fit.bounds, "1", "bounds of the search"),
        "at_bound": flags(p, fit.at_bound, "whether the value lies on its bound", "inside", "at_bound"),
        "covariance": variable((*p, "other"), fit.covariance, "1", "covariance of the values"),
        "correlation": variable((*p, "other"), fit.correlation, "1", "correlation of their errors"),
        "measured": variable(dims, [each.measured for each in fit.columns], "1", "data, in the column's unit"),
        "fitted": variable(dims, [each.fitted for each in fit.columns], "1", "the same of the fitted scenario"),
        "computed_before": variable(
            dims, [each.before for each in fit.columns], "1", "the same of the scenario as it was"
        ),
        "noise": variable(("column",), [each.noise for each in fit.columns], "1", "standard deviation of the residual"),
        "column_unit": words(("column",), [each.unit for each in fit.columns], "SI unit of the column"),
    }
    names = labels("parameter", fit.parameters) | labels("other", fit.parameters)
    names |= labels("column", [each.name for each in fit.columns]) | labels("side", ["low", "high"])
    names[at] = variable((at,), fit.at, "1" if fit.modal else "s", "number of the mode" if fit.modal else "time")
    attrs = {"title": fit.title, "data": fit.data, "condition": fit.condition}
    return Group(data, names, attrs | {"starts": fit.starts, "agreed": fit.agreed})


def optimum_group(o: Optimum) -> Group:
    """Return what a file holds of an optimum; each value in its SI unit, which stands beside it."""
    p, r = ("parameter",), ("requirement",)
    data = {
        "before": variable(p, o.before, "1", "value of the scenario, in its unit"),
        "value": variable(p, o.values, "1", "best value, in its unit"),
        "value_unit": words(p, o.units, "SI unit of the value"),
        "bounds": variable((*p, "side"), o.bounds, "1", "bounds of the search"),
        "at_bound": flags(p, o.at_bound, "whether the value lies on its bound", "inside", "at_bound"),
        "path": variable(("better", *p), o.path, "1", "values tried that were better than those before"),
        "history": variable(("better",), o.history, o.unit or "1", "the figure there"),
    }
    names = labels("parameter", o.parameters) | labels("side", ["low", "high"])
    if o.requirements:
        data["required"] = variable(r, [each.value for each in o.requirements], "1", "figure at the best values")
        data["bound"] = variable(r, [each.bound for each in o.requirements], "1", "bound of the figure")
        names |= labels("requirement", [each.name for each in o.requirements])
    attrs = {"title": o.title, "minimise": o.minimise, "outcome": o.outcome}
    return Group(
        data,
        names,
        attrs | {"figure_before": o.figure_before, "figure": o.figure, "starts": o.starts, "agreed": o.agreed},
    )


def sensitivity_group(s: Sensitivity) -> Group:
    """Return what a file holds of sensitivities; each in the SI unit of its measure over that of its parameter."""
    both = ("measure", "parameter")
    data = {
        "figure": variable(both[:1], s.figures, "1", "value of the measure, in its unit"),
        "figure_unit": words(both[:1], s.units, "SI unit of the measure"),
        "value": variable(both[1:], s.values, "1", "value of the parameter, in its unit"),
        "value_unit": words(both[1:], s.parameter_units, "SI unit of the parameter"),
        "derivative": variable(both, s.derivatives, "1", "derivative, in the measure's unit over the parameter's"),
        "relative": variable(both, s.relative, "1", "relative change of the measure over that of the parameter"),
        "error": variable(
            both, s.errors, "1", "how far differences of two orders are apart; none of an exact derivative"
        ),
        "method": words(both[1:], s.methods, "exact derivative, or difference"),
        "kink": flags(both, s.kinks, "whether the slopes on either side differ", "smooth", "kink"),
    }
    coordinates = labels("measure", s.measures) | labels("parameter", s.parameters)
    attrs = {"title": s.title, "verb": s.verb, "not_varied": "\n".join(s.not_varied), "run_error": s.run_error}
    return Group(data, coordinates, attrs)


def shaping_group(c: ShapedCommand) -> Group:
    """Return what a file holds of a shaped command; the tip's histories are on the first run's times."""
    runs, first = ("run",), c.runs[0]
    unit = "N m" if c.kind == "torque" else "rad s-1"
    tips = [np.stack([np.interp(first.time, r.time, r.tip[:, i]) for i in range(3)], axis=1) for r in c.runs]
    data = {
        "command": variable((*runs, "time"), [each.command for each in c.runs], unit, f"{c.kind} of the hub"),
        "largest": variable(runs, [each.largest for each in c.runs], "1", "largest torque or angular acceleration"),
        "residual": variable(runs, [each.residual for each in c.runs], "m", "amplitude of the tip after the command"),
        "by_ratio": variable(
            (*runs, "ratio"),
            [each.by_ratio for each in c.runs],
            "m",
            "the same of the design's modes",
        ),
        "tip": variable((*runs, "run_time", "axis"), tips, "m", "displacement of the tip"),
        "outcome": words(runs, [each.outcome for each in c.runs], "how the run ended"),
        "coefficients": variable(("spline",), c.coefficients, unit, "of the quintic spline"),
        "frequency": variable(("mode",), c.frequency, "Hz", "frequencies that the design knows"),
    }
    coordinates = labels("run", [each.name for each in c.runs]) | labels("axis", ["x", "y", "z"])
    coordinates["time"] = variable(("time",), c.time, "s", "time")
    coordinates["run_time"] = variable(("run_time",), first.time, "s", "time")
    coordinates["ratio"] = variable(("ratio",), c.ratio, "1", "frequencies over those of the design")
    attrs = {"kind": c.kind, "goal": c.goal, "duration": c.duration, "robust": c.robust}
    return Group(data, coordinates, attrs | {"design": c.design, "check": c.check})


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


def _coordinate(parameter: Parameter) -> Variable:
    attrs = {"units": parameter.unit or "1"} if parameter.numeric else {}
    drawn = {"distribution": parameter.drawn} if parameter.drawn else {}
    return Variable((parameter.dimension,), parameter.values, attrs | {"long_name": parameter.path} | drawn)
