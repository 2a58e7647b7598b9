"""An optimum in words, and as one JSON object."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.searches import Optimum, Requirement


def to_json(optimum: Optimum, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Optimum as JSON; SI."""
    o = optimum
    return {
        "title": o.title,
        "outcome": o.outcome,
        "minimise": {"name": o.minimise, "unit": o.unit, "before": o.figure_before, "value": o.figure},
        "parameters": {
            path: {
                "unit": o.units[k],
                "before": float(o.before[k]),
                "value": float(o.values[k]),
                "bounds": o.bounds[k].tolist(),
                "at_bound": bool(o.at_bound[k]),
            }
            for k, path in enumerate(o.parameters)
        },
        "subject_to": [
            {
                "name": each.name, "unit": each.unit, "low": each.low, "high": each.high, "before": each.before,
                "value": each.value, "kept": each.kept, "active": each.active,
            }
            for each in o.requirements
        ],
        "error_estimate": o.error,
        "evaluations": o.evaluations,
        "starts": {"tried": o.starts, "agreed": o.agreed},
        "warnings": list(o.warnings),
        "files": [str(file) for file in files],
    }  # fmt: skip


def text(optimum: Optimum) -> str:
    """The figure, the values, and the requirements that decide or are not kept."""
    o = optimum
    lines = [f"{o.minimise}: {number(o.figure)} {o.unit}".rstrip() + f", was {number(o.figure_before)}"]
    rows = [
        [path, f"{o.before[k]:.6g}", f"{o.values[k]:.6g}", o.units[k], "on its bound" if o.at_bound[k] else ""]
        for k, path in enumerate(o.parameters)
    ]
    lines += columns(["value", "was", "is", "unit", ""], rows)
    kept = [each for each in o.requirements if each.kept]
    lines += [f"  decides: {_words(each)}" for each in kept if each.active]
    lines += [f"  NOT KEPT: {_words(each)}" for each in o.requirements if not each.kept]
    if o.requirements:
        lines.append(f"  {len(kept)} of {len(o.requirements)} requirements kept")
    proved = "" if math.isnan(o.error) else f"; the last run's estimated error is {percent(o.error)}"
    if o.starts > 1:
        lines.append(f"{o.agreed} of {o.starts} searches end at these values")
    lines.append(f"{o.evaluations} evaluations of the scenario{proved}")
    return "\n".join([*lines, *warning_lines(o)])


def _words(each: Requirement) -> str:
    side = "at most" if each.bound == each.high else "at least"
    return f"{each.name} {number(each.value)}, {side} {number(each.bound)} {each.unit}".rstrip()
