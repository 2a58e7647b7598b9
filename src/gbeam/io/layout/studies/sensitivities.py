"""What a file holds of sensitivities: derivatives by measure and parameter."""

from __future__ import annotations

from gbeam.io.groups import Group, flags, labels, variable, words
from gbeam.results.studies.sensitivity import Sensitivity


def sensitivity_group(s: Sensitivity) -> Group:
    """Return what a file holds of sensitivities; each in the SI unit of its measure over that of its parameter."""
    both = ("measure", "parameter")
    data = {
        "figure": variable(both[:1], s.figures, "1", "value of the measure, in its unit"),
        "figure_unit": words(both[:1], s.units, "SI unit of the measure"),
        "value": variable(both[1:], s.values, "1", "value of the parameter, in its unit"),
        "value_unit": words(both[1:], s.parameter_units, "SI unit of the parameter"),
        "derivative": variable(both, s.derivatives, "1", "derivative, in the measure's unit over the parameter's"),
        "relative": variable(both, s.relative, "1", "relative change of the measure over that of the parameter"),
        "error": variable(
            both, s.errors, "1", "how far differences of two orders are apart; none of an exact derivative"
        ),
        "method": words(both[1:], s.methods, "exact derivative, or difference"),
        "kink": flags(both, s.kinks, "whether the slopes on either side differ", "smooth", "kink"),
    }
    coordinates = labels("measure", s.measures) | labels("parameter", s.parameters)
    attrs = {"title": s.title, "verb": s.verb, "not_varied": "\n".join(s.not_varied), "run_error": s.run_error}
    return Group(data, coordinates, attrs)
