"""What the base does in one environment: acceleration of the root and turning, in base axes."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, panels, styled
from gbeam.results.response import Floats, Response

G0 = 9.80665  # m/s²


@styled
def plot_base(response: Response, title: str) -> Figure:
    """Plot the motion of the root.

    Parameters
    ----------
    response : Response
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Acceleration in g0, and where the base turns its angular velocity and acceleration.
    """
    base = response.base
    shown: list[tuple[Floats, str]] = [(base.a_WO_B / G0, "acceleration\nof the root, g0")]
    if np.any(base.w_WB_B) or np.any(base.alpha_WB_B):
        shown += [(base.w_WB_B, "angular\nvelocity, rad/s"), (base.alpha_WB_B, "angular\nacceleration, rad/s²")]
    figure, axes = panels(
        heading(title, f"{response.name}: motion of the base, base axes", [response]),
        len(shown),
        heights=None if len(shown) > 1 else [1.6],
    )
    for panel, (values, label) in zip(axes, shown, strict=True):
        for i, name in enumerate("xyz"):
            panel.plot(response.time, values[:, i], color=colour(i), label=name)
        panel.set_ylabel(label)
    legend(axes[0])
    return figure
