"""Critical hub rates against a mass on the beam and where it sits."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, panels, show_zero, styled
from gbeam.results.modal import CriticalMap


@styled
def plot_critical_map(found: CriticalMap, title: str) -> Figure:
    """Plot a map of critical speeds, one line per mass (2009 Fig. 9 shows the stiffness at one speed instead).

    Parameters
    ----------
    found : CriticalMap
    title : str
        Of the scenario.
    """
    subject = f"{found.motion}: critical hub rate with one more mass, {found.model}"
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    panel.set_xlabel("position of the mass from the root, m")
    panel.set_ylabel("hub rate, rad/s")
    for k, (mass, speed) in enumerate(zip(found.mass, found.speed, strict=True)):
        panel.plot(found.position, speed, "o-", ms=3, color=colour(k), label=f"{mass:g} kg")
    if np.isnan(found.speed).all():
        panel.set_ylim(0, found.searched_to)
        told = f"no loss of equilibrium up to {found.searched_to:.4g} rad/s"
        panel.text(0.5, 0.5, told, transform=panel.transAxes, ha="center")
    else:
        legend(panel)
        show_zero(panel)
    return figure
