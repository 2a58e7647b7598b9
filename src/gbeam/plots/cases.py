"""Figures of many cases, and of what samples say."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gbeam.errors import InputError
from gbeam.plots.style import colour, heading, panels, show_zero, styled, subtitle
from gbeam.plots.units import scaled_label
from gbeam.results.cases import PROBABILITY, SAMPLE, Parameter, Sweep
from gbeam.results.result import Floats

FAMILY = 6  # lines that can be told apart; more are a heat map


@styled
def plot_sweep(sweep: Sweep, measure: str = "", title: str = "") -> Figure:
    """Plot one measure of a sweep over its parameters."""
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


_POINTS = 3  # of a grid that are drawn as bands of their own


@styled
def plot_history(sweep: Sweep, name: str, title: str = "") -> Figure:
    """Plot a history of all cases: the median and the band of nine tenths, or one line per case of a grid."""
    values = sweep.histories[name]
    power, label = scaled_label(name, sweep.units[name], values)
    figure, (panel,) = panels(heading(title or sweep.title, f"{name} over time", []), 1, heights=[2.0])
    scale = 10.0**-power
    if name in sweep.statistics:
        known = sweep.statistics[name]
        points = list(np.ndindex(known.values.shape[:-3]))[:_POINTS]
        for k, at in enumerate(points):
            low, middle, high = (scale * known[each][at] for each in ("5 %", "median", "95 %"))
            place = _place(sweep, at)
            panel.fill_between(sweep.time, low[:, 0], high[:, 0], color=colour(k), alpha=0.3, lw=0, label="5 to 95 %")
            for outer in (low[:, 1], high[:, 2]):
                panel.plot(sweep.time, outer, color=colour(k), lw=0.7, ls=":")
            panel.plot(sweep.time, middle[:, 0], color=colour(k), label=f"median{place}")
        subtitle(panel, "dotted: 95 % confidence of the band's edges")
    else:
        for k, at in enumerate(np.ndindex(values.shape[:-1])):
            panel.plot(sweep.time, scale * values[at], color=colour(k), lw=0.8)
    panel.set_ylabel(label)
    return figure


@styled
def plot_indices(sweep: Sweep, name: str, title: str = "") -> Figure:
    """Plot the Sobol indices of a measure, at the first point of the grid, the largest on top."""
    indices = sweep.indices[name]
    at = (0,) * (indices.values.ndim - 3)
    values = np.nan_to_num(indices.values[at])
    order = np.argsort(values[:, 1, 0])
    figure, (panel,) = panels(heading(title or sweep.title, f"{name}: share of its variance", []), 1, heights=[2.0])
    place = np.arange(len(order))
    for k, words in enumerate(("by itself", "in total")):
        middle, low, high = values[order, k].T
        bars = panel.barh(place + 0.2 - 0.4 * k, middle, height=0.36, color=colour(k), label=words)
        panel.errorbar(
            middle, [bar.get_y() + bar.get_height() / 2 for bar in bars], xerr=[middle - low, high - middle],
            fmt="none", ecolor="black", elinewidth=0.9, capsize=2.5,
        )  # fmt: skip
    panel.set_yticks(place, [indices.parameters[k] for k in order])
    subtitle(panel, "bars: 95 % confidence")
    panel.set_xlabel("Sobol index")
    return figure


@styled
def plot_probability(sweep: Sweep, name: str, title: str = "") -> Figure:
    """Plot a probability with its bounds over the one parameter of the grid."""
    (parameter,) = _grid(sweep)
    middle, low, high = sweep.statistics[name][PROBABILITY].T
    figure, (panel,) = panels(heading(title or sweep.title, f"{name}: probability", []), 1, heights=[2.0])
    at = parameter.values.astype(float) if parameter.numeric else np.arange(len(parameter.values), dtype=float)
    if not parameter.numeric:
        panel.set_xticks(at, [str(value) for value in parameter.values])
    panel.errorbar(at, middle, yerr=[middle - low, high - middle], fmt="o-", ms=3.5, color=colour(0), capsize=2.5)
    subtitle(panel, "bars: 95 % confidence")
    panel.set_xlabel(f"{parameter.path}{f', {parameter.unit}' if parameter.unit else ''}")
    panel.set_ylabel(f"probability of {name}")
    show_zero(panel)
    return figure


def _grid(sweep: Sweep) -> list[Parameter]:
    return [each for each in sweep.parameters if not each.drawn]


def _place(sweep: Sweep, at: tuple[int, ...]) -> str:
    """A point of the grid, in words."""
    words = []
    for each, i in zip(_grid(sweep), at, strict=True):
        value = each.values[i]
        words.append(value if isinstance(value, str) else f"{value:.4g} {each.unit}".rstrip())
    return f", {', '.join(words)}" if words else ""
