"""Shapes of the modes along the beam."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, panels, styled
from gbeam.results.modal import Modes

SHOWN = 6  # modes drawn


@styled
def plot_modes(found: Modes, title: str) -> Figure:
    """Plot the lowest modes, each in the direction in which it moves most.

    Parameters
    ----------
    found : Modes
        With stations along the beam.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Real and, where Coriolis coupling turns the phase, imaginary part (dotted).
    """
    subject = f"{found.motion} at {found.time:.4g} s: modes about the equilibrium, {found.model}"
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    panel.set_xlabel("position from the root, m")
    panel.set_ylabel("displacement,\nlargest 1")
    for k in range(min(SHOWN, len(found.frequency))):
        shape = found.shape[k, :, "xyz".index(found.direction[k])]
        label = f"{found.frequency[k]:.4g} Hz, {found.direction[k]}"
        panel.plot(found.stations, shape.real, color=colour(k), label=label)
        if np.abs(shape.imag).max() > 1e-6:
            panel.plot(found.stations, shape.imag, ":", color=colour(k))
    legend(panel, columns=3)
    return figure
