"""A fit in words."""

from __future__ import annotations

from gbeam.report.words import columns, number, warning_lines
from gbeam.results.searches import Fit


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
