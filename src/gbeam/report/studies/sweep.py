"""A sweep in words, and as one JSON object."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report.studies.estimates import estimates
from gbeam.report.words import columns, number, warning_lines
from gbeam.results.cases import BOUNDS, ORDERS, Indices, Statistics, Sweep
from gbeam.results.result import Floats

_ROWS = 40  # of the table on the screen
_FAILURES = 5  # that are named


def to_json(sweep: Sweep, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Sweep as JSON: nested lists along the parameters, in their order."""
    return {
        "title": sweep.title,
        "outcome": sweep.state,
        "verb": sweep.verb,
        "parameters": [
            {"path": each.path, "unit": each.unit, "distribution": each.drawn or None, "values": each.values.tolist()}
            for each in sweep.parameters
        ],
        "dimensions": list(sweep.dimensions),
        "measures": {
            name: {"unit": sweep.units[name], "values": values.tolist()} for name, values in sweep.measures.items()
        },
        "histories": {name: {"unit": sweep.units[name]} for name in sweep.histories},
        "statistics": {name: _statistics(each) for name, each in sweep.statistics.items()},
        "indices": {name: _indices(each) for name, each in sweep.indices.items()},
        "time": sweep.time.tolist(),
        "outcomes": sweep.outcome.tolist(),
        "messages": sweep.message.tolist(),
        "counts": sweep.counts,
        "warnings": list(sweep.warnings),
        "files": [str(file) for file in files],
    }


def _statistics(statistics: Statistics) -> dict[str, Any]:
    """Every estimate by name with its bounds; lists along the grid, and along the times of a history."""
    return {
        "draws": statistics.count.tolist(),
        **{name: _bounds(statistics[name]) for name in statistics.names},
    }


def _bounds(values: Floats) -> dict[str, Any]:
    """Estimate, low and high; lists along the grid."""
    return dict(zip(BOUNDS, np.moveaxis(values, -1, 0).tolist(), strict=True))


def _indices(indices: Indices) -> dict[str, Any]:
    """First and total index of every parameter with its bounds; lists along the grid."""
    return {
        parameter: {order: _bounds(indices.values[..., k, i, :]) for i, order in enumerate(ORDERS)}
        for k, parameter in enumerate(indices.parameters)
    }


def text(sweep: Sweep) -> str:
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
    """Of a grid: the parameters and the figures of every case, and how it ended where not all are done."""
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
    words = {
        "least": np.min,
        "5 %": lambda v: np.quantile(v, 0.05),
        "median": np.median,
        "mean": np.mean,
        "95 %": lambda v: np.quantile(v, 0.95),
        "largest": np.max,
        "standard deviation": lambda v: np.std(v, ddof=1) if len(v) > 1 else np.nan,
    }
    return [[word, *(_figure(of, values) for values in every)] for word, of in words.items()]


def _figure(of: Any, values: Floats) -> str:
    return number(float(of(values))) if len(values) else "–"


def _failures(sweep: Sweep) -> list[str]:
    """The first cases that are not done, by what they say."""
    lines: dict[str, int] = {}
    for at in np.ndindex(sweep.outcome.shape):
        if sweep.outcome[at] != "done":
            said = f"{sweep.outcome[at]}: {sweep.message[at]}" if sweep.message[at] else str(sweep.outcome[at])
            lines[said] = lines.get(said, 0) + 1
    shown = [f"  {count} × {said}" for said, count in list(lines.items())[:_FAILURES]]
    return shown + (["  …"] if len(lines) > _FAILURES else [])
