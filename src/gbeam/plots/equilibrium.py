"""Where the beam rests, and the speed at which it no longer can."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, named, panels, show_zero, styled
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.stability import CriticalMap


@styled
def plot_static(deflections: Sequence[Deflection], title: str = "") -> Figure:
    """Plot where the beam rests, one panel for each direction in which it moves.

    Parameters
    ----------
    deflections : sequence of Deflection
        With stations along the beam.
    title : str
        Of the scenario.
    """
    size = np.max([np.abs(each.displacement).max(axis=0) for each in deflections], axis=0)
    axes = [i for i in range(3) if size[i] > 1e-9 * size.max()] or [2]
    subject = f"displacement at rest relative to the base, {deflections[0].model}, t = {deflections[0].time:.4g} s"
    figure, drawn = panels(heading(title, subject, []), len(axes))
    drawn[-1].set_xlabel("position from the root, m")
    for panel, i in zip(drawn, axes, strict=True):
        for k, each in enumerate(deflections):
            dot = "o" if len(each.stations) < 3 else ""  # too few for a line
            panel.plot(each.stations, 1e3 * each.displacement[:, i], color=colour(k), label=each.motion, marker=dot)
        panel.set_ylabel(f"{'xyz'[i]}, mm")
        show_zero(panel)
    if len(deflections) > 1:
        legend(drawn[0])
    return figure


@styled
def plot_critical_map(critical: CriticalMap, title: str = "") -> Figure:
    """Plot a map of critical speeds, one line per mass (2009 Fig. 9 shows the stiffness at one speed instead).

    Parameters
    ----------
    critical : CriticalMap
    title : str
        Of the scenario.
    """
    subject = named(critical.motion, f"critical hub rate with one more mass, {critical.model}")
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    panel.set_xlabel("position of the mass from the root, m")
    panel.set_ylabel("hub rate, rad/s")
    for k, (mass, speed) in enumerate(zip(critical.mass, critical.speed, strict=True)):
        panel.plot(critical.position, speed, "o-", ms=3, color=colour(k), label=f"{mass:g} kg")
    if np.isnan(critical.speed).all():
        panel.set_ylim(0, critical.searched_to)
        none = f"no loss of equilibrium up to {critical.searched_to:.4g} rad/s"
        panel.text(0.5, 0.5, none, transform=panel.transAxes, ha="center")
    else:
        legend(panel)
        show_zero(panel)
    return figure
