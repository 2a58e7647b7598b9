"""Sensitivities in words."""

from __future__ import annotations

import numpy as np

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.cases import Sensitivity


def text(sensitivity: Sensitivity) -> str:
    """A table for each measure, those parameters first by which it changes most."""
    s = sensitivity
    lines: list[str] = []
    for k, name in enumerate(s.measures):
        lines += [f"{name} = {number(float(s.figures[k]))} {s.units[k]}".rstrip()]
        rows = [_row(s, k, int(j)) for j in s.ranked(name)]
        lines += [
            "  " + line for line in columns(["of", "value", "+1 % changes it by", "derivative, SI", ""], rows)
        ] + [""]
    exact = s.methods.count("exact")
    if exact:
        of_run = "" if np.isnan(s.run_error) else f"; the run's own estimated error: {percent(s.run_error)}"
        lines.append(
            f"{exact} of {len(s.methods)} parameters by the exact derivative of the run, its steps held fixed{of_run}."
        )
    if exact < len(s.methods):
        lines.append("± is how far the differences of second and fourth order are apart.")
    lines += [f"not varied: {each}" for each in s.not_varied]
    return "\n".join([*lines, *warning_lines(s)])


def _row(s: Sensitivity, k: int, j: int) -> list[str]:
    derivative, change = float(s.derivatives[k, j]), 0.01 * float(s.derivatives[k, j] * s.values[j])
    # A figure without a unit is a ratio, and its change one too.
    relative = s.units[k] and s.figures[k]
    share = percent(change / float(s.figures[k])) if relative else f"{number(change)} {s.units[k]}".rstrip()
    error = "" if np.isnan(s.errors[k, j]) else f"± {number(float(s.errors[k, j]), 1)}"
    value = f"{float(s.values[j]):.6g} {s.parameter_units[j]}".rstrip()
    return [
        s.parameters[j],
        value,
        share,
        number(derivative),
        " ".join([error, "kink" if s.kinks[k, j] else ""]).strip(),
    ]
