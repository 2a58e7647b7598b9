"""What the base does in one environment: its acceleration and turning, a hub."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.drawing.lines import components, line
from gbeam.plots.drawing.stretches import shade, stretches
from gbeam.plots.drawing.style import colour, heading, named, panels, styled
from gbeam.plots.drawing.units import unit_for
from gbeam.results.response import HubResult, Response
from gbeam.results.result import Floats


@styled
def plot_base(response: Response, title: str = "") -> Figure:
    """Plot the motion of the root.

    Parameters
    ----------
    response : Response
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Acceleration, and where the base turns its angular velocity and acceleration; what is not followed shaded.
    """
    base = response.base
    unit = unit_for("acceleration", base.a_WO_B)
    shown: list[tuple[Floats, str]] = [(unit.factor * base.a_WO_B, f"acceleration\nof the root, {unit.name}")]
    if np.any(base.w_WB_B) or np.any(base.alpha_WB_B):
        shown += [(base.w_WB_B, "angular\nvelocity, rad/s"), (base.alpha_WB_B, "angular\nacceleration, rad/s²")]
    figure, axes = panels(
        heading(title, named(response.name, "motion of the base, base axes"), [response]),
        len(shown),
        heights=None if len(shown) > 1 else [1.6],
    )
    for panel, (values, label) in zip(axes, shown, strict=True):
        components(panel, response.time, values, "xyz")
        panel.set_ylabel(label)
    shade(axes, stretches(response.axes, response.time))
    return figure


@styled
def plot_hub(response: Response, hub: HubResult, title: str = "") -> Figure:
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
        Angle, rate, and the torque of the drive where the rate is not prescribed.
    """
    shown: list[tuple[Floats, str]] = [(hub.angle, "angle, rad"), (hub.rate, "rate, rad/s")]
    if hub.drive_torque is not None:
        unit = unit_for("moment", hub.drive_torque)
        shown.append((unit.factor * hub.drive_torque, f"drive torque, {unit.name}"))
    figure, axes = panels(heading(title, named(response.name, "the hub, about z"), [response]), len(shown))
    for panel, (values, label) in zip(axes, shown, strict=True):
        line(panel, response.time, values, color=colour(0))
        panel.set_ylabel(label)
    return figure
