"""What a file holds of an optimum: the values, the way to them, and the requirements."""

from __future__ import annotations

from gbeam.io.groups import Group, flags, labels, variable, words
from gbeam.results.studies.optimum import Optimum


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
