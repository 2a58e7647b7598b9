"""A sweep in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.report.studies.estimates import estimates
from gbeam.report.words import columns, number, warning_lines
from gbeam.results.cases import Sweep
from gbeam.results.result import Floats

_ROWS = 40  # of the table on the screen
_FAILURES = 5  # that are named


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
