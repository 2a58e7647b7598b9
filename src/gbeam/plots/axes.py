"""What a three-axis centrifuge does: its axes, the load they make and the load wanted."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.base import G0
from gbeam.plots.style import REFERENCE, colour, heading, legend, panels, shade, styled
from gbeam.results.response import AxesResult, PlotHeading


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
        Rates and accelerations of the three axes, load wanted and achieved at the control point, tracking error;
        held times shaded.
    """
    figure, (rate, acceleration, load, error) = panels(
        heading(title, f"{response.name}: axes of the machine, and the load at the control point", [response]), 4
    )
    time = response.time
    for i in range(3):
        rate.plot(time, axes.rate[:, i], color=colour(i), label=f"axis {i + 1}")
        acceleration.plot(time, axes.acceleration[:, i], color=colour(i))
        load.plot(time, axes.actual[:, i] / G0, color=colour(i), label="xyz"[i])
        # The two agree to a line's width: dashes show that both are there.
        load.plot(
            time,
            axes.reference[:, i] / G0,
            color=REFERENCE,
            dashes=(2, 4),
            lw=0.9,
            label="wanted" if i == 2 else None,
        )
    error.plot(time, axes.tracking_error, color=colour(3))
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
