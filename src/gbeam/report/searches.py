"""Searches in words: a fit, an optimum, a shaped command."""

from __future__ import annotations

import math
from pathlib import Path

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.searches import Fit, Optimum, Requirement, ShapedCommand


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
    aim = f"to {number(c.goal)} rad/s" if c.to_rate else f"by {number(c.goal)} rad"
    drive = "largest, N m" if c.kind == "torque" else "largest, rad/s^2"
    rows = [
        [run.name, f"{number(1e3 * run.residual, 3)} mm" if run.outcome == "done" else run.outcome, number(run.largest)]
        for run in c.runs
    ]
    known = f"designed on {c.design}, run on {c.check}"
    span = f", for frequencies wrong by up to {percent(c.robust)}" if c.robust else ""
    lines = [f"{c.kind} {aim} in {number(c.duration)} s, {known}{span}"]
    lines += ["  " + line for line in columns(["command", "leaves", drive], rows)]
    return "\n".join([*lines, *warning_lines(c)])
