"""Style of all figures: colours, sizes, axes and their layout."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from typing import Any, ParamSpec

import numpy as np
from matplotlib import rc_context, rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path

from gbeam.printable import printable
from gbeam.results.response import PlotHeading
from gbeam.results.result import Flags, Floats

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


P = ParamSpec("P")

# Okabe and Ito (2008): distinct with any colour vision. Black is left for what the others are compared with.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
REFERENCE = "black"
ENVELOPE = "fast vibration: envelope"  # in legends
SMALL = 0.01  # of the largest: a smaller component is named and not drawn
NEAR = 5.0  # times what is used: a limit beyond would press the lines to the ground, and is named only
_SCREEN = 100  # dots per inch
_ROW = 110  # letters in a row of a legend
_MOVE_LINE = [int(Path.MOVETO), int(Path.LINETO)]
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.xmargin": 0.01,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "xtick.bottom": False,  # the grid shows where
    "ytick.left": False,
    "text.hinting": "none",
    "text.parse_math": False,  # a dollar sign in a title is one
    "lines.linewidth": 1.1,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "svg.fonttype": "path",  # the same letters on every computer
    "path.simplify_threshold": 0.3,
}


class Shown(Figure):
    """A figure that a notebook shows, which it does of pyplot's own only."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=_SCREEN)
        return picture.getvalue()


@contextmanager
def style() -> Iterator[None]:
    """Set gbeam's style, and leave matplotlib's settings as they were; within itself it does nothing, in no time."""
    if all(rcParams[name] == value for name, value in STYLE.items()):
        yield
        return
    with rc_context(STYLE):
        yield


def styled(plot: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a plot in gbeam's style, with legends, and lay it out."""

    @wraps(plot)
    def drawn(*args: P.args, **options: P.kwargs) -> Figure:
        with style():
            figure = plot(*args, **options)
            arrange(figure, [legend(panel) for panel in figure.axes])
            return figure

    return drawn


def colour(index: int) -> str:
    """Return the colour of the `index`-th line."""
    return PALETTE[index % len(PALETTE)]


def panels(title: str, count: int, *, heights: Iterable[float] | None = None) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels one above the other on a common time axis."""
    ratios = [1.0] * count if heights is None else list(heights)
    figure = Shown(figsize=(WIDTH, PANEL * sum(ratios)))
    FigureCanvasAgg(figure)
    grid, axes = figure.add_gridspec(count, 1, height_ratios=ratios), list[Axes]()
    for row in range(count):
        # matplotlib's own sharing makes ticks only to hide their labels.
        axes.append(figure.add_subplot(grid[row], sharex=axes[0] if axes else None))
    figure.suptitle(printable(title), ha="left", va="top", fontsize=10.5, fontweight="bold")
    axes[-1].set_xlabel("time, s")
    for panel in axes:
        panel.add_artist(Grid(axes[-1].xaxis, panel, across=True))
        panel.add_artist(Grid(panel.yaxis, panel, across=False))
        panel.xaxis.set_visible(panel is axes[-1])
    return figure, axes


class Grid(Artist):
    """Grid lines of one axis at its ticks, as one path: a line per tick takes longer than all the data.

    Parameters
    ----------
    axis : matplotlib axis
        Whose ticks they are; the lowest panel's where the panels share it.
    panel : Axes
    across : bool
        Whether the axis is horizontal.
    """

    def __init__(self, axis: Axis, panel: Axes, *, across: bool) -> None:
        super().__init__()
        self.set_zorder(0.5)
        self._ticks, self._across = axis, across
        self._place = panel.get_xaxis_transform() if across else panel.get_yaxis_transform()

    def draw(self, renderer: RendererBase) -> None:
        """Draw the lines where the ticks are now."""
        low, high = sorted(self._ticks.get_view_interval())
        at = np.asarray(self._ticks.get_majorticklocs())
        at = at[(at >= low) & (at <= high)]
        ends, along = np.tile([0.0, 1.0], len(at)), np.repeat(at, 2)
        corners = np.stack([along, ends] if self._across else [ends, along], axis=1)
        path = self._place.transform_path_non_affine(Path(corners, _MOVE_LINE * len(at)))
        gc = renderer.new_gc()
        gc.set_foreground("#E4E4E4")
        gc.set_linewidth(0.6)
        renderer.draw_path(gc, path, self._place.get_affine())
        gc.restore()


def named(name: str, subject: str) -> str:
    """What is shown, after the motion's name if it has one."""
    return f"{name}: {subject}" if name else subject


def heading(title: str, subject: str, responses: Iterable[PlotHeading]) -> str:
    """Title of a plot: the scenario's, what is shown, and in capitals what must not be overlooked."""
    parts = [part for part in (title, subject) if part]
    failed = sorted({response.outcome.upper() for response in responses if response.outcome != "done"})
    return "\n".join([" – ".join(failed + parts[:1]), *parts[1:]])


def judged(subject: str, errors: Mapping[str, float]) -> str:
    """What is shown, and on a line of its own the estimated errors, as fractions by name, of those that are known."""
    known = [f"{name} {100 * error:.2g} %".strip() for name, error in errors.items() if math.isfinite(error)]
    return f"{subject}\nestimated error: {', '.join(known)}" if known else subject


def legend(panel: Axes) -> int:
    """Put the legend of what has a label above a panel, lines, then what is shaded; return how many rows it has."""
    entries = [each for each in zip(*panel.get_legend_handles_labels(), strict=True) if not each[1].startswith("_")]
    if not entries:
        return 0
    entries.sort(key=lambda each: (not isinstance(each[0], Line2D), each[1] != ENVELOPE))
    handles, labels = zip(*entries, strict=True)
    # Columns are as wide as their longest label; a handle takes about five letters.
    room = _ROW - len(panel.get_title(loc="left"))
    columns = min(max(1, room // (max(map(len, labels)) + 5)), len(labels))
    panel.legend(
        handles,
        labels,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        handlelength=1.6,
        columnspacing=1.4,
    )
    return math.ceil(len(labels) / columns)


def subtitle(panel: Axes, text: str) -> None:
    """Say above a panel, on the left, what it shows."""
    panel.set_title(text, loc="left", fontsize=9, y=1.0)  # or matplotlib measures all ticks to place it


def moving(*values: Floats) -> list[int]:
    """Components (of the last axis) that are more than a hundredth of the largest; the largest where none is."""
    finite = [np.nan_to_num(each, nan=0.0, posinf=0.0, neginf=0.0) for each in values]
    size = np.max([np.abs(each).reshape(-1, each.shape[-1]).max(axis=0) for each in finite], axis=0)
    return [i for i in range(len(size)) if size[i] > SMALL * size.max()] or [int(size.argmax())]


def limits(panel: Axes, allowed: float, values: Floats, label: str = "limit") -> bool:
    """Draw a limit on the size of some values as lines, on the sides to which they go; False where it is far beyond."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    used = max(-low, high)
    if not allowed <= NEAR * used:
        return False
    named: str | None = label
    bottom, top = panel.get_ylim()
    for side, reached in ((1.0, high), (-1.0, -low)):
        if reached > SMALL * used:
            panel.axhline(side * allowed, color=REFERENCE, lw=0.9, ls=(0, (6, 2)), zorder=2.4, label=named)
            named = None
            bottom, top = min(bottom, -1.08 * allowed if side < 0 else 0.0), max(top, 1.08 * allowed * side)
    panel.set_ylim(bottom, top)
    return True


def scale_to(panel: Axes, covered: Flags, *values: Floats) -> bool:
    """Scale a panel to zero and what happens while the target is not held; False where it never or always is."""
    if covered.all() or not covered.any():
        return False
    low = min(0.0, *(float(each[covered].min()) for each in values))
    high = max(0.0, *(float(each[covered].max()) for each in values))
    margin = 0.05 * (high - low) or 1.0
    panel.set_ylim(low - margin, high + margin)
    return True


def show_zero(panel: Axes) -> None:
    """Stretch a panel to zero, so that a constant is seen at its size and rounding at its own."""
    low, high = panel.get_ylim()
    if low > 0 or high < 0:
        low, high = min(low, 0.0), max(high, 0.0)
        panel.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
