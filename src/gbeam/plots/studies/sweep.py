"""A sweep: a line over one parameter, a family of lines or a heat map over two, histograms of what is drawn."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gbeam.errors import InputError
from gbeam.plots.drawing.style import colour, heading, panels, styled, subtitle
from gbeam.plots.drawing.units import scaled_label
from gbeam.results.cases import SAMPLE, Parameter, Sweep
from gbeam.results.result import Floats

FAMILY = 6  # lines that can be told apart; more are a heat map


@styled
def plot_sweep(sweep: Sweep, measure: str = "", title: str = "") -> Figure:
    """Plot one measure of a sweep over its parameters.

    Parameters
    ----------
    sweep : Sweep
        Of one or two dimensions.
    measure : str
        The first by default.
    title : str
        First line; the scenario's by default.

    Raises
    ------
    InputError
        If there is no such measure, or more than two dimensions.
    """
    name = measure or next(iter(sweep.measures))
    if name not in sweep.measures:
        raise InputError("measure", f"is {name!r}", f"choose {', '.join(sweep.measures)}")
    values = sweep.measures[name]
    power, label = scaled_label(name, sweep.units[name], values)
    ended = [f"{count} {each}" for each, count in sweep.counts.items() if each != "done"]
    subject = name + (f" (of {sweep.outcome.size} cases {', '.join(ended)})" if ended else "")
    figure, (panel,) = panels(heading(title or sweep.title, subject, []), 1, heights=[2.0])
    scaled = values / 10.0**power
    if sweep.dimensions == (SAMPLE,):
        _histogram(panel, scaled, label)
    elif values.ndim == 1:
        _line(panel, sweep.parameters[0], scaled, label)
    elif values.ndim == 2 and SAMPLE not in sweep.dimensions:
        _surface(figure, panel, sweep, scaled, label)
    elif values.ndim == 2:
        _bands(panel, sweep.parameters[0], scaled, label)
    else:
        raise InputError("sweep", f"varies {values.ndim} values", "draw one with to_xarray(), or vary two or fewer")
    return figure


def _line(panel: Axes, parameter: Parameter, values: Floats, label: str) -> None:
    at = _across(panel, parameter)
    panel.plot(at, values, "o-", ms=3.5, color=colour(0))
    panel.set_ylabel(label)


def _surface(figure: Figure, panel: Axes, sweep: Sweep, values: Floats, label: str) -> None:
    """A family of lines where the shorter parameter has few values, else a heat map."""
    first, second = sweep.parameters
    if len(first.values) < len(second.values) or not first.numeric:
        first, second, values = second, first, values.T
    if len(second.values) <= FAMILY or not (first.numeric and second.numeric):
        at = _across(panel, first)
        for k, value in enumerate(second.values):
            name = value if isinstance(value, str) else f"{value:.4g} {second.unit}".rstrip()
            panel.plot(at, values[:, k], "o-", ms=3.5, color=colour(k), label=name)
        subtitle(panel, _last(second.path))
        panel.set_ylabel(label)
        return
    mesh = panel.pcolormesh(first.values, second.values, values.T, cmap="cividis", shading="nearest", zorder=0.6)
    panel.set_xlabel(_axis(first))
    panel.set_ylabel(_axis(second))
    # Above the panel, where the others have a legend: the layout keeps room there and none on the right.
    bar = figure.colorbar(mesh, cax=panel.inset_axes((0.5, 1.012, 0.5, 0.02)), orientation="horizontal")
    bar.ax.xaxis.set_ticks_position("top")
    bar.locator = MaxNLocator(5)
    panel.set_title(label, loc="left", fontsize=9, y=1.0)  # or matplotlib lifts the title above the bar


def _bands(panel: Axes, parameter: Parameter, values: Floats, label: str) -> None:
    """Median and the middle nine tenths of the samples over a parameter."""
    at = _across(panel, parameter)
    known, quantiles = np.isfinite(values).any(axis=1), np.full((3, len(values)), np.nan)
    quantiles[:, known] = np.nanquantile(values[known], [0.05, 0.5, 0.95], axis=1)
    low, middle, high = quantiles
    panel.fill_between(at, low, high, color=colour(0), alpha=0.25, lw=0, label="5 % to 95 %")
    panel.plot(at, middle, "o-", ms=3.5, color=colour(0), label="median")
    panel.set_ylabel(label)


def _histogram(panel: Axes, values: Floats, label: str) -> None:
    known = values[np.isfinite(values)]
    if len(known):
        panel.hist(known, bins=max(5, round(math.sqrt(len(known)))), color=colour(0), alpha=0.7, edgecolor="white")
        for share, style in ((0.05, ":"), (0.5, "-"), (0.95, ":")):
            panel.axvline(float(np.quantile(known, share)), color="black", lw=1.0, ls=style)
    subtitle(panel, "lines: median, 5 and 95 %")
    panel.set_xlabel(label)
    panel.set_ylabel("cases")


def _across(panel: Axes, parameter: Parameter) -> Floats:
    """Label the lower axis with a parameter, and return where its values stand."""
    panel.set_xlabel(_axis(parameter))
    if parameter.numeric:
        return np.asarray(parameter.values, dtype=float)
    at = np.arange(len(parameter.values), dtype=float)
    panel.set_xticks(at, [str(value) for value in parameter.values])
    return at


def _axis(parameter: Parameter) -> str:
    return f"{parameter.path}{f', {parameter.unit}' if parameter.unit else ''}"


def _last(path: str) -> str:
    return path.replace("motion.", "", 1)
