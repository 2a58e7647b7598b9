"""Numbers and names of a figure's axes, as matplotlib draws them, without an object for every tick.

A tick of matplotlib is three lines and two texts, of which a figure here shows one text: to make and to place them
takes a quarter of the time in which a figure is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rcParams
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray

_USUAL = {"bottom": False, "left": False, "top": False, "right": False, "gridOn": False}
_USUAL |= {"labelbottom": True, "labelleft": True, "labeltop": False, "labelright": False}
_NEAR = 1e-10  # of the axis: a tick at its end is on it


class Scale(NamedTuple):
    """An axis, and where its numbers stand (n,)."""

    axis: Axis
    at: NDArray[np.float64]
    numbers: list[str]


@contextmanager
def without_scales(figure: Figure) -> Iterator[list[Scale]]:
    """Let a figure be drawn without those of its axes that :func:`draw_scale` can draw, which it yields."""
    every = [axis for panel in figure.axes for axis in (panel.xaxis, panel.yaxis)]
    scales = [scale for axis in every if axis.get_visible() and (scale := _scale(axis))]
    try:
        for scale in scales:
            scale.axis.set_visible(False)
        yield scales
    finally:
        for scale in scales:
            scale.axis.set_visible(True)


def _scale(axis: Axis) -> Scale | None:
    """The axis with its ticks; None unless it has numbers and a name only, at their usual places and sizes."""
    usual = all(_USUAL.get(name) == value for name, value in axis.get_tick_params().items())
    if not usual or len(axis.get_minorticklocs()):
        return None
    low, high = sorted(axis.get_view_interval())
    every, near = np.asarray(axis.get_majorticklocs()), _NEAR * (high - low)
    shown = (every >= low - near) & (every <= high + near)
    formatter = axis.get_major_formatter()
    numbers = formatter.format_ticks(every.tolist())
    if formatter.get_offset():
        return None
    return Scale(axis, every[shown], [number for number, there in zip(numbers, shown, strict=True) if there])


def draw_scale(scale: Scale, renderer: RendererBase) -> None:
    """Draw the numbers at the ticks of an axis, and its name."""
    settings: Any = rcParams
    axis, panel = scale.axis, scale.axis.axes
    across = axis is panel.xaxis
    name = "x" if across else "y"
    place = panel.get_xaxis_text1_transform if across else panel.get_yaxis_text1_transform
    transform, va, ha = place(settings[f"{name}tick.major.size"] + settings[f"{name}tick.major.pad"])
    size, colour = settings[f"{name}tick.labelsize"], settings[f"{name}tick.color"]
    text = Text(0, 0, fontsize=size, color=colour, va=va, ha=ha, transform=transform, figure=panel.figure)
    for at, number in zip(scale.at, scale.numbers, strict=True):
        text.set_position((at, 0) if across else (0, at))
        text.set_text(number)
        text.draw(renderer)
    if across and text.get_text():
        axis.label.set_y(text.get_window_extent(renderer).y0 - renderer.points_to_pixels(axis.labelpad))
    axis.label.draw(renderer)
