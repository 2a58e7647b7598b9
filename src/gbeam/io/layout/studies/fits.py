"""What a file holds of a fit: the values, their covariance, the data and what is left of them."""

from __future__ import annotations

from gbeam.io.groups import Group, flags, labels, variable, words
from gbeam.results.studies.fit import Fit


def fit_group(fit: Fit) -> Group:
    """Return what a file holds of a fit; each value and datum in its SI unit, which stands beside it."""
    p, at = ("parameter",), "mode" if fit.modal else "time"
    dims = ("column", at)
    data = {
        "before": variable(p, fit.before, "1", "value of the scenario, in its unit"),
        "value": variable(p, fit.values, "1", "value found, in its unit"),
        "value_unit": words(p, fit.units, "SI unit of the value"),
        "error": variable(p, fit.errors, "1", "standard deviation of the value, in its unit"),
        "interval": variable((*p, "side"), fit.intervals, "1", "interval that holds it with a probability of 95 %"),
        "bounds": variable((*p, "side"), fit.bounds, "1", "bounds of the search"),
        "at_bound": flags(p, fit.at_bound, "whether the value lies on its bound", "inside", "at_bound"),
        "covariance": variable((*p, "other"), fit.covariance, "1", "covariance of the values"),
        "correlation": variable((*p, "other"), fit.correlation, "1", "correlation of their errors"),
        "measured": variable(dims, [each.measured for each in fit.columns], "1", "data, in the column's unit"),
        "fitted": variable(dims, [each.fitted for each in fit.columns], "1", "the same of the fitted scenario"),
        "computed_before": variable(
            dims, [each.before for each in fit.columns], "1", "the same of the scenario as it was"
        ),
        "noise": variable(("column",), [each.noise for each in fit.columns], "1", "standard deviation of the residual"),
        "column_unit": words(("column",), [each.unit for each in fit.columns], "SI unit of the column"),
    }
    names = labels("parameter", fit.parameters) | labels("other", fit.parameters)
    names |= labels("column", [each.name for each in fit.columns]) | labels("side", ["low", "high"])
    names[at] = variable((at,), fit.at, "1" if fit.modal else "s", "number of the mode" if fit.modal else "time")
    attrs = {"title": fit.title, "data": fit.data, "condition": fit.condition}
    return Group(data, names, attrs | {"starts": fit.starts, "agreed": fit.agreed})
