"""What all plots share: colours, panels one above the other, lines, shading.

Figures are made without pyplot, which keeps every figure of a process in one global list, and are laid out by
`gbeam.plots.layout` instead of matplotlib's solver.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.path import Path

from gbeam.plots.layout import PANEL, WIDTH, arrange
from gbeam.results.response import PlotHeading
from gbeam.results.result import Flags, Floats

P = ParamSpec("P")

# Okabe and Ito (2008): distinct with any colour vision. Black is left for what the others are compared with.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
REFERENCE = "black"
HELD = "#BBBBBB"
COLUMNS = 1500  # across a line: more than a panel has pixels at 150 dpi
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
    "lines.linewidth": 1.1,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "svg.fonttype": "path",  # the same letters on every computer
    "path.simplify_threshold": 0.3,
}


def styled(plot: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a plot in gbeam's style, lay it out, and leave matplotlib's settings as they were."""

    @wraps(plot)
    def drawn(*args: P.args, **options: P.kwargs) -> Figure:
        with rc_context(STYLE):
            figure = plot(*args, **options)
            arrange(figure)
            return figure

    return drawn


def colour(index: int) -> str:
    """Return the colour of the `index`-th line."""
    return PALETTE[index % len(PALETTE)]


def panels(title: str, count: int, *, heights: Iterable[float] | None = None) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels one above the other on a common time axis.

    Parameters
    ----------
    title : str
    count : int
    heights : iterable of float, optional
        Relative to the usual height.
    """
    ratios = [1.0] * count if heights is None else list(heights)
    figure = Figure(figsize=(WIDTH, PANEL * sum(ratios)))
    FigureCanvasAgg(figure)
    grid = figure.subplots(count, 1, sharex=True, squeeze=False, height_ratios=ratios)
    axes: list[Axes] = list(grid[:, 0])
    figure.suptitle(title, ha="left", va="top", fontsize=10.5, fontweight="bold")
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


def line(panel: Axes, x: Floats, y: Floats, *style: str, **options: Any) -> None:
    """Draw a line; of many points only those that show: per column of pixels the first, last, lowest and highest."""
    per_column = len(x) // COLUMNS
    if per_column > 4:
        full = COLUMNS * per_column
        rows = y[:full].reshape(COLUMNS, per_column)
        start = per_column * np.arange(COLUMNS)
        lowest, highest = start + rows.argmin(axis=1), start + rows.argmax(axis=1)
        kept = np.unique(np.concatenate([start, lowest, highest, start + per_column - 1, np.arange(full, len(x))]))
        x, y = x[kept], y[kept]
    panel.plot(x, y, *style, **options)


def named(name: str, subject: str) -> str:
    """What is shown, after the motion's name if it has one."""
    return f"{name}: {subject}" if name else subject


def heading(title: str, subject: str, responses: Iterable[PlotHeading]) -> str:
    """Title of a plot: the scenario's, what is shown, and in capitals what must not be overlooked."""
    parts = [part for part in (title, subject) if part]
    failed = sorted({response.outcome.upper() for response in responses if response.outcome != "done"})
    return "\n".join([" – ".join(failed + parts[:1]), *parts[1:]])


def legend(panel: Axes, columns: int = 4) -> None:
    """Put the legend above a panel, outside the data."""
    panel.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        handlelength=1.6,
        columnspacing=1.4,
    )


def shade(panel: Axes, time: Floats, flags: Flags) -> None:
    """Shade the stretches of time in which the target is held."""
    if flags.any():
        edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
        last = len(time) - 1
        label: str | None = "target held"
        for first, end in zip(edges[::2], edges[1::2], strict=True):
            panel.axvspan(time[first], time[min(end, last)], color=HELD, alpha=0.4, lw=0, zorder=0, label=label)
            label = None


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
