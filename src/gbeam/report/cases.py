"""Many cases in words: sweeps with their statistics, sensitivities, fits, optima and shaped commands."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.cases import PROBABILITY, Indices, Sensitivity, Statistics, Sweep
from gbeam.results.result import Floats
from gbeam.results.searches import COMMANDS, Fit, Optimum, Requirement, ShapedCommand

_ROWS = 40  # of the table on the screen
_FAILURES = 5  # that are named


def sweep(sweep: Sweep) -> str:
    """One line per case, or per quantile where the cases are drawn or many; then what failed."""
    heads = [_headed(each.path, each.unit) for each in sweep.parameters if not each.drawn]
    measures = [_headed(name, sweep.units[name]) for name in sweep.measures]
    if sweep.statistics:
        lines = [line for name in sweep.statistics for line in ["", *estimates(sweep, name, heads)]][1:]
    elif sweep.outcome.size > _ROWS:
        lines = columns(["", *measures], _quantiles(sweep))
    elif sweep.measures:
        lines = columns([*heads, *measures, *([] if sweep.state == "done" else ["outcome"])], _cases(sweep))
    else:
        lines = []
    if sweep.statistics and sweep.lost:
        lines += ["", f"{sweep.lost} of {sweep.outcome.size} cases are not done: the estimates are of the others"]
    ended = ", ".join(f"{count} {name}" for name, count in sweep.counts.items())
    last = [f"{sweep.outcome.size} cases: {ended}", *_failures(sweep), *warning_lines(sweep)]
    return "\n".join([*lines, "", *last]).lstrip("\n")


def _headed(name: str, unit: str) -> str:
    return f"{name}{f', {unit}' if unit else ''}"


def _cases(sweep: Sweep) -> list[list[str]]:
    """Parameters and figures of every case of a grid, and its outcome where not all are done."""
    rows = []
    for at in np.ndindex(sweep.outcome.shape):
        places = [each.values[i] for each, i in zip(sweep.parameters, at, strict=True)]
        shown = [value if isinstance(value, str) else f"{value:.6g}" for value in places]
        figures = [number(float(values[at])) for values in sweep.measures.values()]
        rows.append(shown + figures + ([] if sweep.state == "done" else [str(sweep.outcome[at])]))
    return rows


def _quantiles(sweep: Sweep) -> list[list[str]]:
    """Least, mean and largest, and the quantiles of the cases that have a figure."""
    every = [values[np.isfinite(values)] for values in sweep.measures.values()]
    words: dict[str, Any] = {
        "least": np.min,
        "5 %": lambda v: np.quantile(v, 0.05),
        "median": np.median,
        "mean": np.mean,
        "95 %": lambda v: np.quantile(v, 0.95),
        "largest": np.max,
        "standard deviation": lambda v: np.std(v, ddof=1) if len(v) > 1 else np.nan,
    }
    return [
        [word, *(number(float(of(values))) if len(values) else "–" for values in every)] for word, of in words.items()
    ]


def _failures(sweep: Sweep) -> list[str]:
    """The first cases that are not done, by what they say."""
    lines: dict[str, int] = {}
    for at in np.ndindex(sweep.outcome.shape):
        if sweep.outcome[at] != "done":
            said = f"{sweep.outcome[at]}: {sweep.message[at]}" if sweep.message[at] else str(sweep.outcome[at])
            lines[said] = lines.get(said, 0) + 1
    shown = [f"  {count} × {said}" for said, count in list(lines.items())[:_FAILURES]]
    return shown + (["  …"] if len(lines) > _FAILURES else [])


def estimates(sweep: Sweep, name: str, heads: list[str]) -> list[str]:
    """Lines on one measure or history."""
    statistics, unit = sweep.statistics[name], sweep.units[name]
    title = f"{name}{f', {unit}' if unit else ''}"
    if name in sweep.histories:
        return _history(sweep.time, statistics, title)
    if heads:
        return [f"{title}:", *_over_grid(sweep, statistics, heads)]
    draws = int(statistics.count)
    lines = [f"{title}, of {draws} draws, with 95 % confidence:"]
    rows = [[each, number(float(at[0])), between(at)] for each in statistics.names for at in [statistics[each]]]
    width = max(len(each) for each in statistics.names)
    lines += [f"  {row[0]:<{width}}  {row[1]:>11}  {row[2]}" for row in rows]
    return lines + (_shares(sweep.indices[name]) if name in sweep.indices else [])


def between(bounds: Floats) -> str:
    """An interval from an estimate and its bounds, (3,): ``0.1 to 0.2``; one-sided where an end is not known."""
    low, high = (float(each) for each in bounds[1:])
    if math.isnan(low) and math.isnan(high):
        return "too few draws for a bound"
    if math.isnan(low):
        return f"below {number(high)}"
    return f"above {number(low)}" if math.isnan(high) else f"{number(low)} to {number(high)}"


def _shares(indices: Indices) -> list[str]:
    """Sobol indices, the largest in total first."""
    order = np.argsort(-indices.values[:, 1, 0])
    width = max(len(each) for each in indices.parameters)
    lines = [f"  {'share of the variance':<{width}}  {'by itself':<20}  in total"]
    for k in order:
        cells = [f"{value:.3f} ± {high - value:.3f}" for value, _, high in indices.values[k]]
        lines.append(f"  {indices.parameters[k]:<{width}}  {cells[0]:<20}  {cells[1]}")
    return lines


def _over_grid(sweep: Sweep, statistics: Statistics, heads: list[str]) -> list[str]:
    """A line for every point of the grid: mean and quantiles, or the probability."""
    grid = [each for each in sweep.parameters if not each.drawn]
    names = [each for each in statistics.names if each in ("mean", "5 %", "95 %", PROBABILITY)]
    main = names[0]
    rows = []
    for at in np.ndindex(statistics.count.shape):
        places = [each.values[i] for each, i in zip(grid, at, strict=True)]
        row = [value if isinstance(value, str) else f"{value:.6g}" for value in places]
        row += [number(float(statistics[each][at][0])) for each in names]
        row.insert(len(places) + 1, between(statistics[main][at]))
        rows.append(row)
    return columns([*heads, main, "95 % confidence", *names[1:]], rows)


def _history(time: Floats, statistics: Statistics, title: str) -> list[str]:
    """Band over time at the time at which the median is largest, at the first point of the grid."""
    values = statistics.values[(0,) * (statistics.count.ndim - 1)]
    at = [statistics.names.index(each) for each in ("5 %", "median", "95 %")]
    median = np.abs(np.nan_to_num(values[:, at[1], 0]))
    k = int(median.argmax())
    low, middle, high = (number(float(values[k, each, 0])) for each in at)
    least, most = float(values[k, at[0], 1]), float(values[k, at[2], 2])
    lines = [
        f"{title}, over time: the median is largest at {time[k]:.4g} s, {middle}",
        f"  5 % to 95 % of the cases there: {low} to {high}",
    ]
    if math.isfinite(least) and math.isfinite(most):
        lines.append(f"  nine tenths of all lie there, with 95 % confidence, within {number(least)} to {number(most)}")
    return lines


def sensitivity(sensitivity: Sensitivity) -> str:
    """A table for each measure, those parameters first by which it changes most."""
    s = sensitivity
    lines: list[str] = []
    for k, name in enumerate(s.measures):
        lines += [f"{name} = {number(float(s.figures[k]))} {s.units[k]}".rstrip()]
        rows = [_row(s, k, int(j)) for j in s.ranked(name)]
        lines += [
            "  " + line for line in columns(["of", "value", "+1 % changes it by", "derivative, SI", ""], rows)
        ] + [""]
    exact = s.methods.count("exact")
    if exact:
        of_run = "" if np.isnan(s.run_error) else f"; the run's own estimated error: {percent(s.run_error)}"
        lines.append(
            f"{exact} of {len(s.methods)} parameters by the exact derivative of the run, its steps held fixed{of_run}."
        )
    if exact < len(s.methods):
        lines.append("± is how far the differences of second and fourth order are apart.")
    lines += [f"not varied: {each}" for each in s.not_varied]
    return "\n".join([*lines, *warning_lines(s)])


def _row(s: Sensitivity, k: int, j: int) -> list[str]:
    derivative, change = float(s.derivatives[k, j]), 0.01 * float(s.derivatives[k, j] * s.values[j])
    # A figure without a unit is a ratio, and its change one too.
    relative = s.units[k] and s.figures[k]
    share = percent(change / float(s.figures[k])) if relative else f"{number(change)} {s.units[k]}".rstrip()
    error = "" if np.isnan(s.errors[k, j]) else f"± {number(float(s.errors[k, j]), 1)}"
    value = f"{float(s.values[j]):.6g} {s.parameter_units[j]}".rstrip()
    return [
        s.parameters[j],
        value,
        share,
        number(derivative),
        " ".join([error, "kink" if s.kinks[k, j] else ""]).strip(),
    ]


def fit(fit: Fit, written: Path | None = None) -> str:
    """A row for each value, then its correlation with the others and what the data leave."""
    rows = [
        [
            path,
            f"{fit.before[k]:.6g}",
            f"{fit.values[k]:.6g}",
            f"± {number(float(fit.errors[k]), 2)}",
            "on its bound" if fit.at_bound[k] else f"{fit.intervals[k, 0]:.6g} to {fit.intervals[k, 1]:.6g}",
            fit.units[k],
        ]
        for k, path in enumerate(fit.parameters)
    ]
    lines = columns(["value", "was", "is", "one sigma", "95 %", "unit"], rows)
    for k, path in enumerate(fit.parameters):
        lines += [
            f"  correlation of {fit.parameters[j]} and {path}: {fit.correlation[k, j]:+.2f}"
            for j in range(k)
            if fit.correlation[k, j] == fit.correlation[k, j]  # known
        ]
    for each in fit.columns:
        size = f"{number(each.noise)} {each.unit}".rstrip()
        lines.append(f"  residual of {each.name}: {size} ({len(each.measured)} data)")
    if fit.starts > 1:
        lines.append(f"{fit.agreed} of {fit.starts} searches end at these values")
    lines.append(f"{fit.evaluations} evaluations of the scenario")
    return "\n".join([*lines, *warning_lines(fit), *_written(written)])


def optimum(optimum: Optimum, written: Path | None = None) -> str:
    """The figure, the values, and the requirements that decide or are not kept."""
    o = optimum
    lines = [f"{o.minimise}: {number(o.figure)} {o.unit}".rstrip() + f", was {number(o.figure_before)}"]
    rows = [
        [path, f"{o.before[k]:.6g}", f"{o.values[k]:.6g}", o.units[k], "on its bound" if o.at_bound[k] else ""]
        for k, path in enumerate(o.parameters)
    ]
    lines += columns(["value", "was", "is", "unit", ""], rows)
    kept = [each for each in o.requirements if each.kept]
    lines += [f"  decides: {_required(each)}" for each in kept if each.active]
    lines += [f"  NOT KEPT: {_required(each)}" for each in o.requirements if not each.kept]
    if o.requirements:
        lines.append(f"  {len(kept)} of {len(o.requirements)} requirements kept")
    proved = "" if math.isnan(o.error) else f"; the last run's estimated error is {percent(o.error)}"
    if o.starts > 1:
        lines.append(f"{o.agreed} of {o.starts} searches end at these values")
    lines.append(f"{o.evaluations} evaluations of the scenario{proved}")
    return "\n".join([*lines, *warning_lines(o), *_written(written)])


def _required(each: Requirement) -> str:
    side = "at most" if each.bound == each.high else "at least"
    return f"{each.name} {number(each.value)}, {side} {number(each.bound)} {each.unit}".rstrip()


def _written(file: Path | None) -> list[str]:
    return [] if file is None else ["", f"{file} has these values"]


def shaped_command(command: ShapedCommand) -> str:
    """Vibration that each command leaves, the shaped one first."""
    c = command
    rows = [
        [run.name, f"{number(1e3 * run.residual, 3)} mm" if run.outcome == "done" else run.outcome, number(run.largest)]
        for run in c.runs
    ]
    known = f"designed on {c.design}, run on {c.check}"
    span = f", for frequencies wrong by up to {percent(c.robust)}" if c.robust else ""
    lines = [f"{c.kind} {c.task} in {number(c.duration)} s, {known}{span}"]
    lines += ["  " + line for line in columns(["command", "leaves", f"largest, {COMMANDS[c.kind][1]}"], rows)]
    return "\n".join([*lines, *warning_lines(c)])
