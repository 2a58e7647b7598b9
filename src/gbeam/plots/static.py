"""Static deflection along the beam."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, panels, show_zero, styled
from gbeam.results.modal import Deflection


@styled
def plot_static(found: Sequence[Deflection], title: str) -> Figure:
    """Plot where the beam rests, one panel for each direction in which it moves.

    Parameters
    ----------
    found : sequence of Deflection
        With stations along the beam.
    title : str
        Of the scenario.
    """
    size = np.max([np.abs(it.displacement).max(axis=0) for it in found], axis=0)
    axes = [i for i in range(3) if size[i] > 1e-9 * size.max()] or [2]
    subject = f"displacement at rest relative to the base, {found[0].model}, t = {found[0].time:.4g} s"
    figure, drawn = panels(heading(title, subject, []), len(axes))
    drawn[-1].set_xlabel("position from the root, m")
    for panel, i in zip(drawn, axes, strict=True):
        for k, it in enumerate(found):
            panel.plot(it.stations, 1e3 * it.displacement[:, i], color=colour(k), label=it.motion)
        panel.set_ylabel(f"{'xyz'[i]}, mm")
        show_zero(panel)
    if len(found) > 1:
        legend(drawn[0])
    return figure
