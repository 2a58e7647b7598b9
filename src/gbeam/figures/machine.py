"""The machine that moves a specimen: how its load follows the target, and what its axes do."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    REFERENCE,
    Figure,
    Level,
    Line,
    Panel,
    ends_of,
    imitation_look,
    largest_size,
    limit_levels,
    moving_axes,
    of_motion,
    scale_of,
    stretches,
    words_and_unit,
)
from gbeam.printable import raised
from gbeam.results.machine import AxesResult
from gbeam.results.response import PlotHeading
from gbeam.results.result import Floats

AXES = ("axis 1, the arm", "axis 2, yaw", "axis 3, roll")


def axes_of(response: PlotHeading, axes: AxesResult, quantity: str, title: str = "") -> Figure:
    """Describe one quantity of a centrifuge's axes, with its limits, in a panel for each axis."""
    history: Floats = getattr(axes, quantity)
    unit = raised(words_and_unit(AxesResult, quantity)[1])
    allowed = {use.axis: use.allowed for use in axes.limits if use.quantity == quantity}
    spans, panels = stretches(axes, response.time), []
    for i in range(3):
        limit = allowed.get(f"axis {i + 1}", math.inf)
        levels = limit_levels(limit, history[:, i])
        remark = ", beyond the panel" if math.isfinite(limit) and not levels else ""
        title_of = f"{AXES[i]}: {_use_words(history[:, i], limit, unit)}{remark}"
        lines = (Line(response.time, history[:, i], **imitation_look(0)),)
        panels.append(Panel(f"{quantity}, {unit}", lines, title_of, levels=levels, spans=spans, zero=True))
    if quantity == "acceleration":
        panels[0] = _with_power(panels[0], axes)
    subject = of_motion(response.name, f"{quantity} of the machine's axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def _with_power(panel: Panel, axes: AxesResult) -> Panel:
    """Add to the panel of the arm's acceleration the acceleration that a limit of its power allows at its rate."""
    (line,) = panel.lines
    rate, size = np.abs(axes.rate[:, 0]), np.abs(line.y)
    largest_shown = max([float(size.max()), *(abs(level.value) for level in panel.levels)])
    for use in axes.limits:
        if use.quantity == "power" and math.isfinite(use.allowed) and use.used > 0:
            # The power P allows |rate · acceleration| of at most P/J: the largest product over the share that it uses.
            available = float((rate * size).max()) / use.share / np.maximum(rate, 1e-12)
            bound = np.where(available < 1.3 * largest_shown, available, np.nan)
            power = Line(line.x, bound, "limit of the power", colour=REFERENCE, dash="dotted")
            panel = replace(panel, lines=(*panel.lines, power, replace(power, y=-bound, label=f"_{power.label}")))
    return panel


def _use_words(history: Floats, limit: float, unit: str) -> str:
    """Use of a limit, in words."""
    used = float(np.nanmax(np.abs(history)))
    return (
        f"{_three_digits(used)} of {_three_digits(limit)} {unit}"
        if math.isfinite(limit)
        else f"up to {_three_digits(used)} {unit}"
    )


def _three_digits(value: float) -> str:
    """Three digits, below a million without an exponent."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 1000 <= rounded < 1e6 else f"{rounded:g}"


def tracking(response: PlotHeading, axes: AxesResult, title: str = "") -> Figure:
    """Describe the load at the control point over time, size and components: of target, machine and flight."""
    components = moving_axes(axes.actual, axes.reference)  # those that are not negligible
    time = response.time
    scale, unit = scale_of("m/s^2", axes.reference)
    loads: list[tuple[Floats, Floats, str, dict[str, Any]]] = [
        (time, axes.reference, "target", {"colour": REFERENCE, "dash": "dashed"}),
        (time, axes.actual, "machine", imitation_look(0)),
    ]
    if axes.flight is not None:
        slack = 1e-9 * (time[-1] - time[0])
        flown = (time >= axes.span[0] - slack) & (time <= axes.span[1] + slack)
        loads.insert(0, (time[flown], axes.flight[flown], "flight", FLIGHT))
    size = tuple(Line(times, scale * np.linalg.norm(load, axis=1), name, **look) for times, load, name, look in loads)
    idle = (Level(scale * axes.idle, "idle", "dotted"),) if axes.idle > 0 else ()
    panels = [Panel(f"size, {unit}", size, levels=idle, zero=True)]
    for i in components:
        lines = tuple(Line(times, scale * load[:, i], name, **look) for times, load, name, look in loads)
        panels.append(Panel(f"{'xyz'[i]}, {unit}", lines, named=False, height=0.8))
    panels.append(_error(time, axes, scale, unit))
    spans = stretches(axes, time)
    subject = of_motion(response.name, "load at the control point: flight's, the target and the machine's")
    shaded = tuple(replace(panel, spans=spans) for panel in panels)
    return Figure(title, subject, shaded, outcomes=(response.outcome,))


def _error(time: Floats, axes: AxesResult, scale: float, unit: str) -> Panel:
    """Panel of the tracking error in the unit of the loads, scaled to the times that are followed."""
    error, followed = axes.tracking_error, ~axes.not_followed
    ends = ends_of(followed, scale * error)
    # An axis of at least a millionth of the load shows rounding errors as a line at zero.
    top = (
        max(ends[1] if ends else 1.05 * scale * float(error.max()), 1e-6 * scale * largest_size(axes.reference)) or 1.0
    )
    title = f"size of machine − target{', scaled to the times that are followed' if ends else ''}"
    line = Line(time, scale * error, "machine − target", **imitation_look(0))
    return Panel(f"tracking error, {unit}", (line,), title, limits=(0.0, top), named=False, height=0.8)
