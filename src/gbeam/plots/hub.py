"""What a hub does: angle, rate and, where it is free, the torque that drives it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, panels, styled
from gbeam.results.response import Floats, HubResult, Response


@styled
def plot_hub(response: Response, hub: HubResult, title: str) -> Figure:
    """Plot the turning of a hub about z.

    Parameters
    ----------
    response : Response
    hub : HubResult
        Of the response.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Angle, rate, and the torque where it is given rather than the rate.
    """
    shown: list[tuple[Floats, str]] = [(hub.angle, "angle, rad"), (hub.rate, "rate, rad/s")]
    if np.isfinite(hub.torque).any():
        shown.append((hub.torque, "torque, N m"))
    figure, axes = panels(heading(title, f"{response.name}: the hub, about z", [response]), len(shown))
    for panel, (values, label) in zip(axes, shown, strict=True):
        panel.plot(response.time, values, color=colour(0))
        panel.set_ylabel(label)
    return figure
