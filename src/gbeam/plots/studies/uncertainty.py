"""What samples say: bands of a history, the shares that Sobol indices give, a probability over a parameter."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.drawing.style import colour, heading, panels, show_zero, styled, subtitle
from gbeam.plots.drawing.units import scaled_label
from gbeam.results.cases import PROBABILITY, Parameter, Sweep

_POINTS = 3  # of a grid that are drawn as bands of their own


@styled
def plot_history(sweep: Sweep, name: str, title: str = "") -> Figure:
    """Plot a history of all cases: the median and the band of nine tenths, or one line per case of a grid.

    Parameters
    ----------
    sweep : Sweep
    name : str
        Of the history.
    title : str
        First line; the scenario's by default.
    """
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
    """Plot the Sobol indices of a measure, at the first point of the grid, the largest on top.

    Parameters
    ----------
    sweep : Sweep
    name : str
        Of the measure.
    title : str
        First line; the scenario's by default.
    """
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
    """Plot a probability with its bounds over the one parameter of the grid.

    Parameters
    ----------
    sweep : Sweep
    name : str
        Of the measure.
    title : str
        First line; the scenario's by default.
    """
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
