"""One steady state: where the beam rests, the shapes of its modes, the Campbell diagram, critical speeds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import REFERENCE, colour, heading, legend, named, panels, show_zero, styled
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.modal import Campbell, Modes
from gbeam.results.steady.stability import CriticalMap

_LINES = {"x": ":", "y": "-", "z": "--"}
FAR = 2.0  # times the highest multiple of the speed: a mode above would press the others to the ground
FEW = 2  # modes drawn in any case
SHOWN = 6  # shapes drawn


@styled
def plot_static(deflections: Sequence[Deflection], title: str = "") -> Figure:
    """Plot where the beam rests, one panel for each direction in which it moves.

    Parameters
    ----------
    deflections : sequence of Deflection
        With stations along the beam.
    title : str
        Of the scenario.
    """
    size = np.max([np.abs(each.displacement).max(axis=0) for each in deflections], axis=0)
    axes = [i for i in range(3) if size[i] > 1e-9 * size.max()] or [2]
    subject = f"displacement at rest relative to the base, {deflections[0].model}, t = {deflections[0].time:.4g} s"
    figure, drawn = panels(heading(title, subject, []), len(axes))
    drawn[-1].set_xlabel("position from the root, m")
    for panel, i in zip(drawn, axes, strict=True):
        for k, each in enumerate(deflections):
            dot = "o" if len(each.stations) < 3 else ""  # too few for a line
            panel.plot(each.stations, 1e3 * each.displacement[:, i], color=colour(k), label=each.motion, marker=dot)
        panel.set_ylabel(f"{'xyz'[i]}, mm")
        show_zero(panel)
    if len(deflections) > 1:
        legend(drawn[0])
    return figure


@styled
def plot_modes(modes: Modes, title: str = "") -> Figure:
    """Plot the lowest modes, each in the direction in which it moves most.

    Parameters
    ----------
    modes : Modes
        With stations along the beam.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Real and, where Coriolis coupling turns the phase, imaginary part (dotted).
    """
    subject = named(modes.motion, f"modes about the equilibrium at {modes.time:.4g} s, {modes.model}")
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    panel.set_xlabel("position from the root, m")
    panel.set_ylabel("displacement,\nlargest 1")
    dot = "o" if len(modes.stations) < 3 else ""  # too few for a line
    for k in range(min(SHOWN, len(modes.frequency))):
        shape = modes.shape[k, :, "xyz".index(modes.direction[k])]
        label = f"{modes.frequency[k]:.4g} Hz, {modes.direction[k]}"
        panel.plot(modes.stations, shape.real, color=colour(k), label=label, marker=dot)
        if np.abs(shape.imag).max() > 1e-6:
            panel.plot(modes.stations, shape.imag, ":", color=colour(k))
    legend(panel, columns=3)
    return figure


@styled
def plot_campbell(diagram: Campbell, title: str = "") -> Figure:
    """Plot a Campbell diagram.

    Parameters
    ----------
    diagram : Campbell
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        One line per mode, dashed where it moves the beam along z, dotted along x; grey lines are multiples of the
        speed, circles the crossings, a vertical line the critical speed. Modes far above all multiples are left out.
    """
    highest = max(diagram.orders, default=0) * diagram.speed[-1] / (2 * np.pi)
    far = FAR * highest if diagram.orders else np.inf
    shown = [k for k, low in enumerate(np.nanmin(diagram.frequency, axis=0)) if low <= far or k < FEW]
    left = len(diagram.direction) - len(shown)
    subject = named(diagram.motion, f"frequencies about the equilibrium, {diagram.model}")
    if left:
        subject += f"; {left} higher mode{'s' if left > 1 else ''} not drawn"
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.4])
    panel.set_xlabel("hub rate, rad/s")
    panel.set_ylabel("frequency, Hz")
    for k in shown:
        direction = diagram.direction[k]
        label = f"mode {k + 1}, {direction}"
        panel.plot(diagram.speed, diagram.frequency[:, k], _LINES[direction], color=colour(k), label=label)
    top = 1.05 * np.nanmax(diagram.frequency[:, shown])
    for order in diagram.orders:
        multiple = order * diagram.speed / (2 * np.pi)
        panel.plot(diagram.speed, multiple, color="0.6", lw=0.7, zorder=1)
        inside = np.flatnonzero(multiple <= top)
        if inside.size:
            panel.annotate(f"{order}×", (diagram.speed[inside[-1]], multiple[inside[-1]]), color="0.4", fontsize=8)
    for crossing in diagram.crossings:
        panel.plot(crossing.speed, crossing.frequency, "o", mfc="none", mec=REFERENCE, ms=4, mew=0.8)
    if diagram.critical is not None and diagram.critical.value is not None:
        panel.axvline(diagram.critical.value, color=REFERENCE, lw=0.9, ls="-.", label=diagram.critical.kind)
    panel.set_ylim(0, top)
    legend(panel)
    return figure


@styled
def plot_critical_map(critical: CriticalMap, title: str = "") -> Figure:
    """Plot a map of critical speeds, one line per mass (2009 Fig. 9 shows the stiffness at one speed instead).

    Parameters
    ----------
    critical : CriticalMap
    title : str
        Of the scenario.
    """
    subject = named(critical.motion, f"critical hub rate with one more mass, {critical.model}")
    figure, (panel,) = panels(heading(title, subject, []), 1, heights=[2.0])
    panel.set_xlabel("position of the mass from the root, m")
    panel.set_ylabel("hub rate, rad/s")
    for k, (mass, speed) in enumerate(zip(critical.mass, critical.speed, strict=True)):
        panel.plot(critical.position, speed, "o-", ms=3, color=colour(k), label=f"{mass:g} kg")
    if np.isnan(critical.speed).all():
        panel.set_ylim(0, critical.searched_to)
        none = f"no loss of equilibrium up to {critical.searched_to:.4g} rad/s"
        panel.text(0.5, 0.5, none, transform=panel.transAxes, ha="center")
    else:
        legend(panel)
        show_zero(panel)
    return figure
