"""An optimum: the figure and the values on the way to it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gbeam.plots.drawing.style import REFERENCE, colour, heading, panels, styled, subtitle
from gbeam.plots.drawing.units import scaled_label
from gbeam.results.searches import Optimum


@styled
def plot_optimum(optimum: Optimum, title: str = "") -> Figure:
    """Plot the figure over the tries that were better than those before, and where the values lie between their bounds.

    Parameters
    ----------
    optimum : Optimum
    title : str
        First line; the scenario's by default.
    """
    o = optimum
    found = ", ".join(
        f"{path.replace('motion.', '', 1)} {value:.4g} {unit}".rstrip()
        for path, value, unit in zip(o.parameters, o.values, o.units, strict=True)
    )
    subject = f"{o.minimise} from {o.figure_before:.4g} to {o.figure:.4g} {o.unit}".rstrip()
    first = (title or o.title) if o.outcome == "done" else f"{o.outcome.upper()} – {title or o.title}"
    figure, (top, below) = panels(heading(first, f"{subject}\n{found}", []), 2, heights=[1.2, 1.0])
    at = np.arange(len(o.history))
    power, label = scaled_label(o.minimise, o.unit, o.history)
    top.plot(at, o.history / 10.0**power, "o-", ms=3.5, color=REFERENCE)
    top.set_ylabel(label)
    low, width = o.bounds[:, 0], o.bounds[:, 1] - o.bounds[:, 0]
    for k, path in enumerate(o.parameters):
        below.plot(at, 100 * (o.path[:, k] - low[k]) / width[k], "o-", ms=3.5, color=colour(k), label=path)
    below.set_ylim(-3, 103)
    subtitle(below, "between bounds")
    below.set_ylabel("%")
    below.set_xlabel("tries that were better")
    below.xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure
