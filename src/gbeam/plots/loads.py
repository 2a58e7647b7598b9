"""What the sections of the beam carry: along the beam at rest, and at the root over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.style import colour, heading, legend, line, named, panels, show_zero, styled
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.section_forces import Loads
from gbeam.results.steady.equilibrium import Deflection

NOTHING = 1e-9  # of the largest force or moment: a component smaller than that is rounding


@styled
def plot_loads_along(deflection: Deflection, loads: Loads, title: str = "") -> Figure:
    """Plot force, moment and, where the section's outer fibres are known, stress along the beam at rest.

    Parameters
    ----------
    deflection : Deflection
    loads : Loads
        Of the deflection.
    title : str
        Of the scenario.
    """
    at = f"{deflection.model}, t = {deflection.time:.4g} s"
    subject = named(deflection.motion, f"loads along the beam at rest, section axes, {at}")
    stress = np.isfinite(loads.stress).all()
    figure, drawn = panels(heading(title, subject, []), 2 + int(stress))
    drawn[-1].set_xlabel("position from the root, m")
    _components(drawn[0], loads.stations, loads.section_force[0], ("axial", "shear y", "shear z"))
    _components(drawn[1], loads.stations, loads.section_moment[0], ("torque", "bending y", "bending z"))
    if stress:
        drawn[2].plot(loads.stations, 1e-6 * loads.stress[0], color=colour(0))
    _label(drawn, ("force, N", "moment, N m", "largest stress, MPa"))
    return figure


@styled
def plot_loads(response: Response, loads: Loads, title: str = "") -> Figure:
    """Plot over time what the base gives the beam's root, the largest stress, and the torque about a hub's axis.

    Parameters
    ----------
    response : Response
    loads : Loads
        Of the response.
    title : str
        Of the scenario.
    """
    stress, torque = np.isfinite(loads.stress).all(), loads.beam_torque
    figure, drawn = panels(
        heading(title, named(response.name, "force and moment of the base on the root, base axes"), [response]),
        2 + int(stress) + int(torque is not None),
    )
    _components(drawn[0], response.time, loads.root_force, ("x", "y", "z"))
    _components(drawn[1], response.time, loads.root_moment, ("x", "y", "z"))
    labels = ["force, N", "moment, N m"]
    if stress:
        line(drawn[2], response.time, 1e-6 * loads.stress.max(axis=1), color=colour(0))
        labels.append("largest stress, MPa")
    if torque is not None:
        line(drawn[-1], response.time, torque, color=colour(0))
        labels.append("torque for\nthe beam, N m")
    _label(drawn, labels)
    return figure


def _label(drawn: Sequence[Axes], labels: Sequence[str]) -> None:
    """Units, and a legend above the two panels that show components."""
    for panel, label in zip(drawn, labels, strict=False):
        panel.set_ylabel(label)
        show_zero(panel)
    for panel in drawn[:2]:
        legend(panel, 3)


def _components(panel: Axes, where: Floats, values: Floats, names: Sequence[str]) -> None:
    """Draw the components (k, 3) that are more than rounding; the largest where none is."""
    size = np.abs(values).max(axis=0)
    for i in range(3):
        if size[i] > NOTHING * size.max() or (size.max() == 0 and i == 0):
            line(panel, where, values[:, i], color=colour(i), label=names[i])
