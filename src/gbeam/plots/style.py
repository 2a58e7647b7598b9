"""What all plots share: colours, figures, shading, files.

Figures are made without pyplot, which keeps every figure of a process in one global list.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from gbeam.results.response import Floats, PlotHeading

P = ParamSpec("P")

# Okabe and Ito (2008): told apart with any colour vision. Black is left for what the others are compared with.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
REFERENCE = "black"
HELD = "#BBBBBB"
WIDTH = 8.0  # inches
PANEL = 2.1  # inches of height per panel
_STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.xmargin": 0.01,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "svg.fonttype": "path",  # the same letters on every computer
    "path.simplify_threshold": 0.3,
}


def styled(plot: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a plot in gbeam's style, and leave matplotlib's settings as they were."""

    @wraps(plot)
    def drawn(*args: P.args, **options: P.kwargs) -> Figure:
        with rc_context(_STYLE):
            return plot(*args, **options)

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
    figure = Figure(figsize=(WIDTH, 0.7 + PANEL * sum(ratios)), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(count, 1, sharex=True, squeeze=False, height_ratios=ratios)
    axes: list[Axes] = list(grid[:, 0])
    figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
    axes[-1].set_xlabel("time, s")
    figure.align_ylabels(axes)
    return figure, axes


def heading(title: str, subject: str, responses: Iterable[PlotHeading]) -> str:
    """Title of a plot: the scenario's, what is shown, and in capitals what must not be overlooked."""
    parts = [part for part in (title, subject) if part]
    failed = sorted({it.outcome.upper() for it in responses if it.outcome != "done"})
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


def shade(panel: Axes, time: Floats, flags: NDArray[np.bool_]) -> None:
    """Shade the stretches of time in which the target is held."""
    if flags.any():
        edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
        last = len(time) - 1
        label: str | None = "target held"
        for first, end in zip(edges[::2], edges[1::2], strict=True):
            panel.axvspan(time[first], time[min(end, last)], color=HELD, alpha=0.4, lw=0, zorder=0, label=label)
            label = None


def scale_to(panel: Axes, covered: NDArray[np.bool_], *values: Floats) -> bool:
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


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write a figure as PNG (150 dpi) and SVG; return the files."""
    files = [folder / f"{name}.{kind}" for kind in ("png", "svg")]
    # Some settings are read only when a figure is written.
    with rc_context(_STYLE):
        for file in files:
            figure.savefig(file, dpi=150)
            figure.set_layout_engine("none")  # laid out once for both
    return files
