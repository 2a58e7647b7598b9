"""A fit in words, and as one JSON object."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from gbeam.report.words import columns, number, warning_lines
from gbeam.results.searches import Fit


def to_json(fit: Fit, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Fit as JSON; SI."""
    return {
        "title": fit.title,
        "outcome": "done",
        "data": fit.data,
        "parameters": {
            path: {
                "unit": fit.units[k],
                "before": float(fit.before[k]),
                "value": float(fit.values[k]),
                "error": float(fit.errors[k]),
                "interval": fit.intervals[k].tolist(),
                "bounds": fit.bounds[k].tolist(),
                "at_bound": bool(fit.at_bound[k]),
            }
            for k, path in enumerate(fit.parameters)
        },
        "covariance": fit.covariance.tolist(),
        "correlation": fit.correlation.tolist(),
        "condition": fit.condition,
        "columns": {
            each.name: {"unit": each.unit, "noise": each.noise, "correlation_of_residuals": each.correlation}
            for each in fit.columns
        },
        "evaluations": fit.evaluations,
        "starts": {"tried": fit.starts, "agreed": fit.agreed},
        "warnings": list(fit.warnings),
        "files": [str(file) for file in files],
    }


def text(fit: Fit) -> str:
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
    return "\n".join([*lines, *warning_lines(fit)])
