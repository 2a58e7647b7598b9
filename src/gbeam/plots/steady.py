"""One steady state: where the beam rests, the shapes of its modes, the Campbell diagram, critical speeds."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.lines import FLIGHT, machine
from gbeam.plots.style import REFERENCE, colour, heading, judged, moving, named, panels, show_zero, styled
from gbeam.plots.units import Unit, not_drawn, unit_for
from gbeam.results.equilibrium import CriticalMap, Deflection
from gbeam.results.modal import Campbell, Modes, near_multiples
from gbeam.results.result import Floats

_LINES = {"x": ":", "y": "-", "z": "--"}
SHOWN = 6  # shapes drawn
RATE = (1.0, "rad/s")


def _position(panel: Axes, *stations: Floats, label: str = "position from the root") -> Unit:
    """Label the lowest panel with the position along the beam, and return its unit."""
    unit = unit_for("length", *stations)
    panel.set_xlabel(f"{label}, {unit.name}")
    return unit


@styled
def plot_static(deflections: Sequence[Deflection], title: str = "") -> Figure:
    """Plot where the beam rests, one panel for each direction in which it moves."""
    moved = [each.displacement for each in deflections]
    axes = moving(*moved)
    subject = f"displacement at rest relative to the base, {deflections[0].model}, t = {deflections[0].time:.4g} s"
    subject += not_drawn(axes, *moved)
    totals = [each.errors.displacement.total for each in deflections]
    subject = judged(subject, {"": max((each for each in totals if math.isfinite(each)), default=math.nan)})
    figure, drawn = panels(heading(title, subject, []), len(axes))
    at = _position(drawn[-1], *(each.stations for each in deflections))
    for panel, i in zip(drawn, axes, strict=True):
        unit = unit_for("length", *(each[:, i] for each in moved))
        for k, each in enumerate(deflections):
            dot = "o" if len(each.stations) < 3 else ""  # too few for a line
            name = each.motion if len(deflections) > 1 and i == axes[0] else None
            style = machine(k - 1) if k or len(deflections) == 1 else FLIGHT  # the first is seen below the others
            panel.plot(
                at.factor * each.stations, unit.factor * each.displacement[:, i], label=name, marker=dot, **style
            )
        panel.set_ylabel(f"{'xyz'[i]}, {unit.name}")
        show_zero(panel)
    return figure


@styled
def plot_modes(modes: Modes, title: str = "") -> Figure:
    """Plot the lowest modes, each in the direction in which it moves most."""
    subject = named(modes.motion, f"modes about the equilibrium at {modes.time:.4g} s, {modes.model}")
    subject = judged(subject, {"": math.nan if modes.errors is None else modes.errors.largest})
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    at = _position(panel, modes.stations)
    panel.set_ylabel("displacement,\nlargest 1")
    dot = "o" if len(modes.stations) < 3 else ""  # too few for a line
    for k in range(min(SHOWN, len(modes.frequency))):
        shape = modes.shape[k, :, "xyz".index(modes.direction[k])]
        label = f"{modes.frequency[k]:.4g} Hz, {modes.direction[k]}"
        panel.plot(at.factor * modes.stations, shape.real, color=colour(k), label=label, marker=dot)
        if np.abs(shape.imag).max() > 1e-6:
            panel.plot(at.factor * modes.stations, shape.imag, ":", color=colour(k))
    return figure


@styled
def plot_campbell(diagram: Campbell, title: str = "", unit: tuple[float, str] = RATE) -> Figure:
    """Plot a Campbell diagram."""
    shown = near_multiples(diagram.frequency.T, diagram.speed, diagram.orders)
    left = len(diagram.direction) - len(shown)
    subject = named(diagram.motion, f"frequencies about the equilibrium, {diagram.model}")
    if left:
        subject += f"; {left} higher mode{'s' if left > 1 else ''} not drawn"
    subject = judged(subject, {"": math.nan if diagram.errors is None else diagram.errors.largest})
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.4])
    factor, name = unit
    panel.set_xlabel(f"hub rate, {name}")
    panel.set_ylabel("frequency, Hz")
    speed = factor * diagram.speed
    for k in shown:
        direction = diagram.direction[k]
        label = f"mode {k + 1}, {direction}"
        panel.plot(speed, diagram.frequency[:, k], _LINES[direction], color=colour(k), label=label)
    top = 1.05 * np.nanmax(diagram.frequency[:, shown])
    for order in diagram.orders:
        multiple = order * diagram.speed / (2 * np.pi)
        panel.plot(speed, multiple, color="0.6", lw=0.7, zorder=1)
        # Where the line leaves the panel, and a little before.
        end = min(1.0, top / multiple[-1]) * 0.96 if multiple[-1] > 0 else 0.0
        if end * diagram.speed[-1] > diagram.speed[0]:
            white = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
            place = (end * speed[-1], end * multiple[-1])
            panel.text(*place, f"{order}P", ha="center", va="center", color="0.35", fontsize=8, zorder=1.2, bbox=white)
    for crossing in diagram.crossings:
        at = factor * crossing.speed
        panel.plot(at, crossing.frequency, "o", mfc="none", mec=REFERENCE, ms=4, mew=0.8)
    if diagram.critical is not None and diagram.critical.value is not None:
        critical = factor * diagram.critical.value
        panel.axvline(critical, color=REFERENCE, lw=0.9, ls="-.", label=diagram.critical.kind)
    panel.set_ylim(0, top)
    return figure


@styled
def plot_critical_map(critical: CriticalMap, title: str = "") -> Figure:
    """Plot a map of critical speeds, one line per mass (2009 Fig. 9 shows the stiffness at one speed instead)."""
    subject = named(critical.motion, f"critical hub rate with one more mass, {critical.model}")
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    at = _position(panel, critical.position, label="position of the mass from the root")
    panel.set_ylabel("hub rate, rad/s")
    for k, (mass, speed) in enumerate(zip(critical.mass, critical.speed, strict=True)):
        panel.plot(at.factor * critical.position, speed, "o-", ms=3, color=colour(k), label=f"{mass:g} kg")
    if np.isnan(critical.speed).all():
        panel.set_ylim(0, critical.searched_to)
        none = f"no loss of equilibrium up to {critical.searched_to:.4g} rad/s"
        panel.text(0.5, 0.5, none, transform=panel.transAxes, ha="center")
    else:
        show_zero(panel)
    return figure
