"""Where the panels of a figure lie: margins of known size, so that nothing is drawn only to be measured.

matplotlib's constrained layout draws a figure once more to learn how wide its labels are: two seconds for the figures
of a run, as long as drawing them. The panels here stand one above the other, and little can stand beside them: tick
labels and a label of a few lines on the left, a legend or a title above, tick labels and a label below the last.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

WIDTH = 8.0  # inches
PANEL = 2.1  # inches of height per panel
_RIGHT, _EDGE = 0.15, 0.08  # inches: right of the panels, left of the labels
_LABEL_LINE, _LABEL_GAP = 0.16, 0.15  # inches: a line of a label, and between it and the tick labels
_DIGIT = 0.08  # inches: mean width of a number's letters
_BOTTOM = 0.45  # inches: tick labels, and the label of the axis
_LINE, _TITLE = 0.185, 0.06  # inches: a line of the figure's title, and the space above it
_GAP, _HEADED = 0.16, 0.34  # inches above a panel: where nothing is, and under a title or a legend


def arrange(figure: Figure, rows: Sequence[int]) -> None:
    """Set the size of a figure that `panels` made, and the places of its panels, legends of so many rows, and title."""
    axes = figure.axes
    shares = np.array([panel.get_position().height for panel in axes])
    heights = [float(each) - _GAP for each in figure.get_size_inches()[1] * shares / shares.sum()]
    ticks = max(_tick_width(panel) for panel in axes) + _LABEL_GAP
    above = [_above(*each) for each in zip(axes, rows, strict=True)]
    title = figure.get_suptitle()
    head = _TITLE + _LINE * (title.count("\n") + 1) if title else 0.0
    total = head + sum(above) + sum(heights) + _BOTTOM
    figure.set_size_inches(WIDTH, total)
    left = _EDGE + ticks + _LABEL_LINE * max(panel.get_ylabel().count("\n") + 1 for panel in axes)
    top = total - head
    for panel, gap, height in zip(axes, above, heights, strict=True):
        top -= gap + height
        panel.set_position((left / WIDTH, top / total, (WIDTH - left - _RIGHT) / WIDTH, height / total))
        if _lifted(panel):
            panel.set_title(panel.get_title(loc="left"), loc="left", fontsize=9, y=1 + _LINE / height)
        panel.yaxis.set_label_coords(-ticks / (WIDTH - left - _RIGHT), 0.5)
    for text in figure.texts:
        text.set_position((_EDGE / WIDTH, 1 - _TITLE / total))


def _above(panel: Axes, rows: int) -> float:
    """Height above a panel with a legend of so many rows, inches, once its ticks are known."""
    legend: Any = panel.get_legend()
    height = _HEADED if rows or panel.get_title(loc="left") else _GAP
    if _lifted(panel):
        height += _LINE
    if rows <= 1:
        return height
    return max(height, float(legend.get_window_extent().height) / legend.figure.dpi + _GAP)


def _lifted(panel: Axes) -> bool:
    """Whether a title stands above a power of ten of the axis."""
    return bool(panel.get_title(loc="left") and panel.yaxis.get_major_formatter().get_offset())


def _tick_width(panel: Axes) -> float:
    """Width of the widest tick label, inches, from the number of its letters."""
    axis = panel.yaxis
    low, high = sorted(axis.get_view_interval())
    at = [tick for tick in axis.get_majorticklocs() if low <= tick <= high]
    return max((len(label) for label in axis.get_major_formatter().format_ticks(at)), default=0) * _DIGIT
