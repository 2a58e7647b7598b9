"""A fit: the data with what the scenario says before and after, and the residuals."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.drawing.style import REFERENCE, colour, heading, panels, styled, subtitle
from gbeam.plots.drawing.units import scaled_label
from gbeam.results.searches import Fit, FittedColumn

_DOTS = 400  # data that can be told apart
_BAND = 2.0  # sigma


@styled
def plot_fit(fit: Fit, title: str = "") -> Figure:
    """Plot every column of the data and its residual.

    Parameters
    ----------
    fit : Fit
    title : str
        First line; the scenario's by default.
    """
    found = ", ".join(
        f"{path.rpartition('.')[2]} {value:.4g} {unit}".rstrip()
        for path, value, unit in zip(fit.parameters, fit.values, fit.units, strict=True)
    )
    heights = [each for _ in fit.columns for each in ((0.9,) if fit.modal else (1.2, 0.6))]
    figure, drawn = panels(heading(title or fit.title, f"fit: {found}", []), len(heights), heights=heights)
    for k, column in enumerate(fit.columns):
        if fit.modal:
            _modes(drawn[k], fit, column)
        else:
            _history(drawn[2 * k], fit, column)
            _residual(drawn[2 * k + 1], fit, column)
    if fit.modal:
        drawn[-1].set_xlabel("mode")
        drawn[-1].set_xticks(fit.at)
    return figure


def _history(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    power, label = scaled_label(column.name, column.unit, column.measured)
    size = 10.0**power
    every = max(1, len(fit.at) // _DOTS)
    panel.plot(fit.at, column.before / size, color="0.6", lw=0.9, label="scenario as it was")
    panel.plot(fit.at, column.fitted / size, color=colour(0), label="fitted")
    panel.plot(fit.at[::every], column.measured[::every] / size, ".", ms=2.5, color=REFERENCE, label="measured")
    panel.set_ylabel(label)


def _residual(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    power, label = scaled_label("", column.unit, column.residual)
    size = 10.0**power
    panel.plot(fit.at, column.residual / size, ".", ms=2.5, color=REFERENCE)
    panel.axhspan(-_BAND * column.noise / size, _BAND * column.noise / size, color=colour(0), alpha=0.15, lw=0)
    subtitle(panel, "measured less fitted, and twice its standard deviation")
    panel.set_ylabel(label.removeprefix(", ").strip())


def _modes(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    shares = [100 * (column.measured - values) / np.abs(column.measured) for values in (column.before, column.fitted)]
    looks = ("0.6", colour(0)), ("before", "fitted")
    for offset, values, shade, label in zip((-0.17, 0.17), shares, *looks, strict=True):
        panel.bar(fit.at + offset, values, width=0.3, color=shade, label=label)
    panel.axhline(0, color=REFERENCE, lw=0.8)
    subtitle(panel, f"{column.name}: measured less computed")
    panel.set_ylabel("%")
