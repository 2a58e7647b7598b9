"""Tornado plot: by how much one percent of each value changes a figure, the most important on top."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.errors import InputError
from gbeam.plots.drawing.style import REFERENCE, colour, heading, panels, styled
from gbeam.results.cases import Sensitivity

_BARS = 14  # that can be read; the others are less
_HEIGHT = 0.13  # of a panel's usual height, for a bar


@styled
def plot_sensitivity(sensitivity: Sensitivity, measure: str = "", title: str = "") -> Figure:
    """Plot how one measure changes with each parameter.

    Parameters
    ----------
    sensitivity : Sensitivity
    measure : str
        The first by default.
    title : str
        First line; the scenario's by default.

    Raises
    ------
    InputError
        If there is no such measure.
    """
    s, name = sensitivity, measure or sensitivity.measures[0]
    if name not in s.measures:
        raise InputError("measure", f"is {name!r}", f"choose {', '.join(s.measures)}")
    k, chosen = s.measures.index(name), s.ranked(name)[:_BARS]
    size = float(s.figures[k])
    subject = f"{name} = {size:.4g} {s.units[k]}".rstrip()
    left_out = len(s.parameters) - len(chosen)
    if left_out:
        subject += f" ({left_out} values that matter less are left out)"
    figure, (panel,) = panels(
        heading(title or s.title, subject, []), 1, heights=[max(1.0, _HEIGHT * len(chosen) + 0.3)]
    )
    change = 0.01 * s.derivatives[k, chosen] * s.values[chosen]
    share = bool(s.units[k]) and size != 0  # a figure without a unit is a ratio, and its change one too
    if share:
        change = 100 * change / abs(size)
    at = -np.arange(len(chosen))
    for sign, label in ((1, "value + 1 %"), (-1, "value \N{MINUS SIGN} 1 %")):
        panel.barh(at, sign * change, height=0.6, color=colour(0 if sign > 0 else 1), label=label)
    panel.axvline(0, color=REFERENCE, lw=0.8)
    panel.set_yticks(at, [_named(s, int(j)) for j in chosen])
    panel.set_xlabel(f"change of {name}, {'%' if share else s.units[k]}".rstrip(", "))
    return figure


def _named(s: Sensitivity, j: int) -> str:
    return f"{s.parameters[j].replace('motion.', '', 1)} = {s.values[j]:.4g} {s.parameter_units[j]}".rstrip()
