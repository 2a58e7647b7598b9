"""An optimum in words."""

from __future__ import annotations

import math

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.searches import Optimum, Requirement


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
