"""What the base does in one environment: its acceleration and turning, the axes of a centrifuge, a hub."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import REFERENCE, colour, heading, legend, line, named, panels, shade, styled
from gbeam.results.machine import AxesResult
from gbeam.results.response import HubResult, PlotHeading, Response
from gbeam.results.result import Floats

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
        heading(title, named(response.name, "motion of the base, base axes"), [response]),
        len(shown),
        heights=None if len(shown) > 1 else [1.6],
    )
    for panel, (values, label) in zip(axes, shown, strict=True):
        for i, name in enumerate("xyz"):
            line(panel, response.time, values[:, i], color=colour(i), label=name)
        panel.set_ylabel(label)
    legend(axes[0])
    return figure


@styled
def plot_axes(response: PlotHeading, axes: AxesResult, title: str) -> Figure:
    """Plot a centrifuge's axes and how well they track.

    Parameters
    ----------
    response : Response or MachinePlan
    axes : AxesResult
        Of the response.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Rates and accelerations of the three axes, reference and actual load at the control point, tracking error;
        held times shaded.
    """
    figure, (rate, acceleration, load, error) = panels(
        heading(title, named(response.name, "axes of the machine, and the load at the control point"), [response]), 4
    )
    time = response.time
    for i in range(3):
        line(rate, time, axes.rate[:, i], color=colour(i), label=f"axis {i + 1}")
        line(acceleration, time, axes.acceleration[:, i], color=colour(i))
        line(load, time, axes.actual[:, i] / G0, color=colour(i), label="xyz"[i])
        # The two agree to a line's width: dashes show that both are there.
        line(
            load,
            time,
            axes.reference[:, i] / G0,
            color=REFERENCE,
            dashes=(2, 4),
            lw=0.9,
            label="reference" if i == 2 else None,
        )
    line(error, time, axes.tracking_error, color=colour(3))
    rate.set_ylabel("rate, rad/s")
    acceleration.set_ylabel("acceleration,\nrad/s²")
    load.set_ylabel("load, g0")
    error.set_ylabel("tracking error,\nm/s²")
    # Below a millionth of the load it is rounding, and shown as none.
    error.set_ylim(0, max(error.get_ylim()[1], 1e-6 * np.abs(axes.reference).max()) or 1.0)
    for panel in (rate, acceleration, load, error):
        shade(panel, time, axes.not_followed)
    legend(rate)
    legend(load, columns=5)
    return figure


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
        Angle, rate, and the torque of the drive where the rate is not prescribed.
    """
    shown: list[tuple[Floats, str]] = [(hub.angle, "angle, rad"), (hub.rate, "rate, rad/s")]
    if np.isfinite(hub.drive_torque).any():
        shown.append((hub.drive_torque, "drive torque, N m"))
    figure, axes = panels(heading(title, named(response.name, "the hub, about z"), [response]), len(shown))
    for panel, (values, label) in zip(axes, shown, strict=True):
        line(panel, response.time, values, color=colour(0))
        panel.set_ylabel(label)
    return figure
