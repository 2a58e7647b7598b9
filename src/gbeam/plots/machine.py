"""Figures of a machine and of the motion of any base."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.lines import FLIGHT, components, line, machine, shade, stretches
from gbeam.plots.style import (
    REFERENCE,
    colour,
    heading,
    limits,
    moving,
    named,
    panels,
    scale_to,
    show_zero,
    styled,
    subtitle,
)
from gbeam.plots.units import largest, unit_for
from gbeam.results.machine import AxesResult
from gbeam.results.response import HubResult, PlotHeading, Response
from gbeam.results.result import Floats

AXES = ("axis 1, the arm", "axis 2, yaw", "axis 3, roll")
_UNITS = {"rate": "rad/s", "acceleration": "rad/s²", "jerk": "rad/s³"}


@styled
def plot_axes(response: PlotHeading, axes: AxesResult, quantity: str, title: str = "") -> Figure:
    """Plot one quantity of a centrifuge's axes, a panel for each axis, with its limits."""
    history: Floats | None = getattr(axes, quantity)
    if history is None:
        raise ValueError(f"this result has no {quantity}")
    figure, drawn = panels(heading(title, named(response.name, f"{quantity} of the machine's axes"), [response]), 3)
    allowed = {use.axis: use.allowed for use in axes.limits if use.quantity == quantity}
    for i, panel in enumerate(drawn):
        limit = allowed.get(f"axis {i + 1}", math.inf)
        line(panel, response.time, history[:, i], color=machine(0)["color"], lw=1.0)
        show_zero(panel)
        beyond = math.isfinite(limit) and not limits(panel, limit, history[:, i])
        used = _used(history[:, i], limit, _UNITS[quantity])
        subtitle(panel, f"{AXES[i]}: {used}{', beyond the panel' if beyond else ''}")
        panel.set_ylabel(f"{quantity}, {_UNITS[quantity]}")
    if quantity == "acceleration":
        _power(drawn[0], response.time, axes)
    shade(drawn, stretches(axes, response.time))
    return figure


def _power(panel: Axes, time: Floats, axes: AxesResult) -> None:
    """Draw the arm's acceleration that a limit on its power leaves at its rate."""
    rate = np.abs(axes.rate[:, 0])
    largest_product = float((rate * np.abs(axes.acceleration[:, 0])).max())
    for use in axes.limits:
        if use.quantity == "power" and math.isfinite(use.allowed) and use.used > 0:
            bottom, top = panel.get_ylim()
            left = np.minimum(largest_product / use.share / np.maximum(rate, 1e-12), 10 * max(top, -bottom))
            for side, label in ((1.0, "limit of the power"), (-1.0, None)):
                panel.plot(time, side * left, color=REFERENCE, lw=0.9, ls=":", zorder=2.4, label=label)
            panel.set_ylim(bottom, top)


def _used(history: Floats, limit: float, unit: str) -> str:
    """How much of a limit is used, in words."""
    used = float(np.nanmax(np.abs(history)))
    return f"{_plain(used)} of {_plain(limit)} {unit}" if math.isfinite(limit) else f"up to {_plain(used)} {unit}"


def _plain(value: float) -> str:
    """Three digits, below a million without an exponent."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 1000 <= rounded < 1e6 else f"{rounded:g}"


@styled
def plot_tracking(response: PlotHeading, axes: AxesResult, title: str = "", flight: Response | None = None) -> Figure:
    """Plot the load that a centrifuge makes at the control point beside the one that it should make."""
    subject = "load at the control point: flight's, the target and the machine's"
    shown = moving(axes.actual, axes.reference)
    count = len(shown) + 2
    figure, drawn = panels(
        heading(title, named(response.name, subject), [response]), count, heights=[1.0, *[0.8] * (count - 1)]
    )
    unit = unit_for("acceleration", axes.reference)
    time, size, error = response.time, drawn[0], drawn[-1]
    loads = [(axes.reference, time, "target", {"color": REFERENCE, "lw": 1.1, "ls": (0, (4, 3)), "zorder": 2.1})]
    loads.append((axes.actual, time, "machine", machine(0)))
    if flight is not None:
        loads.insert(0, (flight.base.a_WO_B, flight.time, "flight", FLIGHT))
    for load, at, name, style in loads:
        line(size, at, unit.factor * np.linalg.norm(load, axis=1), label=name, **style)
        for panel, i in zip(drawn[1:-1], shown, strict=True):
            line(panel, at, unit.factor * load[:, i], **style)
    size.set_ylabel(f"size, {unit.name}")
    show_zero(size)
    if axes.idle > 0:
        size.axhline(unit.factor * axes.idle, color=REFERENCE, lw=0.9, ls=":", zorder=2.4, label="idle")
    for panel, i in zip(drawn[1:-1], shown, strict=True):
        panel.set_ylabel(f"{'xyz'[i]}, {unit.name}")
    off, followed = axes.tracking_error, ~axes.not_followed
    unit = unit_for("acceleration", off[followed])
    line(error, time, unit.factor * off, color=machine(0)["color"], lw=1.0)
    error.set_ylabel(f"tracking error,\n{unit.name}")
    scaled = scale_to(error, followed, unit.factor * off)
    subtitle(error, f"size of machine − target{', scaled to the times that are followed' if scaled else ''}")
    # Below a millionth of the load it is rounding, and shown as none.
    error.set_ylim(0, max(error.get_ylim()[1], 1e-6 * unit.factor * largest(axes.reference)) or 1.0)
    shade(drawn, stretches(axes, time))
    return figure


@styled
def plot_base(response: Response, title: str = "") -> Figure:
    """Plot the motion of the root."""
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
    """Plot the turning of a hub about z."""
    shown: list[tuple[Floats, str]] = [(hub.angle, "angle, rad"), (hub.rate, "rate, rad/s")]
    if hub.drive_torque is not None:
        unit = unit_for("moment", hub.drive_torque)
        shown.append((unit.factor * hub.drive_torque, f"drive torque, {unit.name}"))
    figure, axes = panels(heading(title, named(response.name, "the hub, about z"), [response]), len(shown))
    for panel, (values, label) in zip(axes, shown, strict=True):
        line(panel, response.time, values, color=colour(0))
        panel.set_ylabel(label)
    return figure
