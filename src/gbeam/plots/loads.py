"""What the beam carries: force, moment and stress at the root over time, and along the beam at rest."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.drawing.lines import components, line
from gbeam.plots.drawing.stretches import shade, stretches
from gbeam.plots.drawing.style import colour, heading, judged, limits, named, panels, show_zero, styled
from gbeam.plots.drawing.units import unit_for
from gbeam.results.equilibrium import Deflection
from gbeam.results.parts import Loads
from gbeam.results.response import Response
from gbeam.results.result import Floats

FORCES = ("axial N", "shear V_y", "shear V_z")
MOMENTS = ("torque", "bending M_y", "bending M_z")


@styled
def plot_loads_along(deflection: Deflection, loads: Loads, title: str = "") -> Figure:
    """Plot along the beam at rest the sections' force and moment and, where known, the largest and smallest stress.

    Parameters
    ----------
    deflection : Deflection
    loads : Loads
        Of the deflection, at stations along the beam.
    title : str
        Of the scenario.
    """
    subject = f"internal loads at rest, {deflection.model}, t = {deflection.time:.4g} s"
    at, known = unit_for("length", loads.stations), bool(np.isfinite(loads.stress).all())
    errors = {"loads": deflection.errors.loads.total, "stress": deflection.errors.stress.total if known else math.nan}
    figure, drawn = panels(heading(title, judged(named(deflection.motion, subject), errors), []), 2 + known)
    drawn[-1].set_xlabel(f"position from the root, {at.name}")
    where, stress = at.factor * loads.stations, (loads.stress_tension[0], loads.stress_compression[0])
    _carried(drawn, where, loads.section_force[0], loads.section_moment[0], stress if known else None, loads)
    return figure


@styled
def plot_loads(response: Response, loads: Loads, title: str = "") -> Figure:
    """Plot over time what the root's section carries, the extreme stresses along the beam, and a hub's torque.

    Parameters
    ----------
    response : Response
    loads : Loads
        Of the response.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Force and moment are those of the section, with the signs of :func:`plot_loads_along` and
        :func:`plot_comparison`; the times that are not followed are shaded.
    """
    torque, known = loads.beam_torque, bool(np.isfinite(loads.stress).all())
    subject = named(response.name, "loads in the root's section, and stress anywhere along the beam")
    errors = {"loads": response.errors.loads.total, "stress": response.errors.stress.total if known else math.nan}
    figure, drawn = panels(heading(title, judged(subject, errors), [response]), 2 + known + (torque is not None))
    shade(drawn, stretches(response.axes, response.time))
    stress = (loads.stress_tension.max(axis=1), loads.stress_compression.min(axis=1)) if known else None
    _carried(drawn, response.time, loads.section_force[:, 0], loads.section_moment[:, 0], stress, loads)
    if torque is not None:
        unit = unit_for("moment", torque)
        line(drawn[-1], response.time, unit.factor * torque, color=colour(0))
        drawn[-1].set_ylabel(f"torque for\nthe beam, {unit.name}")
    return figure


def _carried(
    drawn: list[Axes], where: Floats, force: Floats, moment: Floats, stress: tuple[Floats, Floats] | None, loads: Loads
) -> None:
    """Draw forces and moments (k, 3) and, where they are known, the largest and the smallest stress (k,)."""
    for panel, kind, values, names in ((drawn[0], "force", force, FORCES), (drawn[1], "moment", moment, MOMENTS)):
        unit = unit_for(kind, values)
        components(panel, where, unit.factor * values, names)
        show_zero(panel)
        panel.set_ylabel(f"{kind}, {unit.name}")
    if stress is None:
        return
    panel, unit = drawn[2], unit_for("stress", *stress)
    for k, (values, name) in enumerate(zip(stress, ("largest", "smallest"), strict=True)):
        line(panel, where, unit.factor * values, color=colour(k), label=name)
    strength = math.inf if loads.yield_strength is None else loads.yield_strength
    limits(panel, unit.factor * strength, unit.factor * np.concatenate(stress), "yield strength")
    panel.set_ylabel(f"stress, {unit.name}")
