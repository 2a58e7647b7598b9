"""A sweep in words, and as one JSON object."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report.words import number
from gbeam.results.result import Floats
from gbeam.results.sweep import Sweep

_ROWS = 40  # of the table on the screen
_FAILURES = 5  # that are named


def to_json(sweep: Sweep, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Sweep as JSON: nested lists along the parameters, in their order."""
    return {
        "title": sweep.title,
        "outcome": "done" if set(sweep.counts) == {"done"} else "some cases failed",
        "verb": sweep.verb,
        "parameters": [
            {"path": each.path, "unit": each.unit, "distribution": each.drawn or None, "values": each.values.tolist()}
            for each in sweep.parameters
        ],
        "dimensions": list(sweep.dimensions),
        "measures": {
            name: {"unit": sweep.units[name], "values": values.tolist()} for name, values in sweep.measures.items()
        },
        "outcomes": sweep.outcome.tolist(),
        "messages": sweep.message.tolist(),
        "counts": sweep.counts,
        "files": [str(file) for file in files],
    }


def text(sweep: Sweep) -> str:
    """One line per case, or per quantile where the cases are drawn or many; then what failed."""
    heads = [f"{each.path}{f', {each.unit}' if each.unit else ''}" for each in sweep.parameters]
    measures = [f"{name}{f', {sweep.units[name]}' if sweep.units[name] else ''}" for name in sweep.measures]
    drawn = any(each.drawn for each in sweep.parameters)
    if drawn or sweep.outcome.size > _ROWS:
        lines = _table(["", *measures], _quantiles(sweep))
    else:
        lines = _table([*heads, *measures], _cases(sweep))
    ended = ", ".join(f"{count} {name}" for name, count in sweep.counts.items())
    return "\n".join([*lines, "", f"{sweep.outcome.size} cases: {ended}", *_failures(sweep)])


def _cases(sweep: Sweep) -> list[list[str]]:
    """Of a grid: the parameters and the figures of every case."""
    rows = []
    for at in np.ndindex(sweep.outcome.shape):
        places = [each.values[i] for each, i in zip(sweep.parameters, at, strict=True)]
        shown = [value if isinstance(value, str) else f"{value:.6g}" for value in places]
        rows.append(shown + [number(float(values[at])) for values in sweep.measures.values()])
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


def _table(heads: list[str], rows: list[list[str]]) -> list[str]:
    widths = [max(len(row[k]) for row in [heads, *rows]) for k in range(len(heads))]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in [heads, *rows]]


def _failures(sweep: Sweep) -> list[str]:
    """The first cases that are not done, by what they say."""
    lines: dict[str, int] = {}
    for at in np.ndindex(sweep.outcome.shape):
        if sweep.outcome[at] != "done":
            said = f"{sweep.outcome[at]}: {sweep.message[at]}" if sweep.message[at] else str(sweep.outcome[at])
            lines[said] = lines.get(said, 0) + 1
    shown = [f"  {count} × {said}" for said, count in list(lines.items())[:_FAILURES]]
    return shown + (["  …"] if len(lines) > _FAILURES else [])
