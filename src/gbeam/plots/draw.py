"""A described figure drawn with Matplotlib; of lines with many points what shows, and envelopes of fast vibrations."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib import figure as matplotlib_figure
from matplotlib import rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.markers import CARETUP
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from gbeam.figures.description import Bars, Figure, Line, Map, Panel, Span
from gbeam.numerics.samples import thinned, true_runs
from gbeam.printable import printable
from gbeam.results.result import Flags, Floats

COLUMNS = 1500  # across a line: more than a panel has pixels at 150 dpi
BINS = 240  # across a line, each of four to five pixels
_FAST = 2.5  # path of a line in a bin over its range there: 1 where it rises, 2 at a peak, 2 n for n oscillations
_SEEN = 1e-3  # of the whole range: a smaller vibration is hidden by the width of the line, or is rounding
_GAP, _FEW = 2, 3  # bins: between stretches that are drawn as one, and of a stretch that stays a line
ENVELOPE = "fast vibration: envelope"  # in legends


def line(panel: Axes, x: Floats, y: Floats, **options: Any) -> None:
    """Draw a line (n,): an envelope where it oscillates too fast for the width of a line, else what shows of it."""
    bins = _Bins(x, y) if len(x) >= 4 * BINS else None
    runs = [] if bins is None else true_runs(bins.fast)
    if bins is None or not runs:
        panel.plot(*thinned(x, y, COLUMNS), **options)
        return
    (curve,) = panel.plot(*bins.middle(x, y, runs), **options)
    labelled = any(collection.get_label() == ENVELOPE for axes in curve.figure.axes for collection in axes.collections)
    envelopes = [bins.envelope(x, y, run) for run in runs]
    xs, low, high = (np.concatenate(parts) for parts in zip(*envelopes, strict=True))
    look: dict[str, Any] = {"color": curve.get_color(), "zorder": curve.get_zorder()}
    panel.fill_between(xs, low, high, **look, lw=0, alpha=0.35, label=None if labelled else ENVELOPE)
    for edge in (low, high):
        panel.plot(xs, edge, **look, lw=0.6, label="_edge")


class _Bins:
    """A line in bins of a few pixels: its range in each, and whether it oscillates there faster than can be seen."""

    def __init__(self, x: Floats, y: Floats) -> None:
        edges = np.linspace(x[0], x[-1], BINS + 1)
        self.centre = (edges[1:] + edges[:-1]) / 2
        self.starts = np.searchsorted(x, edges[:-1])
        self.low = np.minimum.reduceat(y, self.starts)
        self.high = np.maximum.reduceat(y, self.starts)
        ranges = self.high - self.low
        path = np.add.reduceat(np.abs(np.diff(y, append=y[-1])), self.starts)
        self.fast = _join_runs((path > _FAST * ranges) & (ranges > _SEEN * np.nanmax(ranges, initial=0.0)))
        self._ends = np.append(self.starts, len(x) - 1)

    def middle(self, x: Floats, y: Floats, runs: list[slice]) -> tuple[Floats, Floats]:
        """The line, in the middle of its envelope where it has one."""
        parts, begin = [], 0
        for run in runs:
            stretch = slice(begin, self._ends[run.start] + 1)
            parts.append(thinned(x[stretch], y[stretch], COLUMNS))
            parts.append((self.centre[run], (self.low[run] + self.high[run]) / 2))
            begin = self._ends[run.stop]
        parts.append(thinned(x[begin:], y[begin:], COLUMNS))
        xs, values = zip(*parts, strict=True)
        return np.concatenate(xs), np.concatenate(values)

    def envelope(self, x: Floats, y: Floats, run: slice) -> tuple[Floats, Floats, Floats]:
        """Times of a stretch, its low and its high edge: it begins and ends on the line, then there is a gap."""
        first, last = self._ends[[run.start, run.stop]]
        times = [x[first], *self.centre[run], x[last], np.nan]
        low = [y[first], *self.low[run], y[last], np.nan]
        high = [y[first], *self.high[run], y[last], np.nan]
        return np.array(times), np.array(low), np.array(high)


def _join_runs(fast: Flags) -> Flags:
    """Join stretches of bins that small gaps separate, then drop short ones."""
    joined = fast.copy()
    for gap in true_runs(~fast):
        if gap.start > 0 and gap.stop < len(fast) and gap.stop - gap.start <= _GAP:
            joined[gap] = True
    for run in true_runs(joined):
        if run.stop - run.start < _FEW:
            joined[run] = False
    return joined


WIDTH = 8.0  # inches
PANEL = 2.1  # inches of height per panel
# Okabe and Ito (2008): distinct with any colour vision. Black is left for what the others are compared with.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "black", "0.6")
BROAD = 3.4  # points: of flight, light and below what imitates it
_DASHES: dict[str, Any] = {"solid": "-", "dashed": (0, (4, 3)), "dotted": (0, (1.5, 1.5))}
_MARKS: dict[str, dict[str, Any]] = {
    "": {},
    "joined": {"marker": "o", "ms": 3.5},
    "dots": {"marker": ".", "ms": 3.5, "ls": ""},
    "supports": {"marker": CARETUP, "ms": 9, "ls": "", "clip_on": False, "zorder": 3},
    "rings": {"marker": "o", "ms": 4, "mfc": "none", "mec": "black", "mew": 0.8, "ls": ""},
}
_SCREEN = 100  # dots per inch
_HEAD = 88  # characters of a heading on a line
_ROW = 110  # letters in a row of a legend
_LABEL = 15  # letters of a label in an inch of a panel's height
# Colour and hatch of what is shaded, which tells them apart in print; of a machine's limit by its name.
_PATTERNS = {
    "spin-up": ("#F8F8F8", "///"),
    "spin-down": ("#F8F8F8", "\\\\\\"),
    "below idle": ("#DEDEDE", None),
    "gimbals": ("#F5E3BE", "..."),
    "left out": ("#EFD3E4", "xxx"),
    "corner": ("#CFE8DE", "---"),
    "designed for": ("#EDEDED", None),
    "estimated error": ("#EDEDED", None),
    "flown": ("#DCEAF5", None),
    "at rest": ("#DEDEDE", "..."),
    "level": ("#CFE8DE", "---"),
}
_LIMIT = ("#F7CDB8", "+++")
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.xmargin": 0.01,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.grid": True,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # or matplotlib measures all ticks to place it
    "figure.constrained_layout.h_pad": 0.03,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.6,
    "xtick.bottom": False,  # the grid shows where
    "ytick.left": False,
    "text.hinting": "none",
    "text.parse_math": False,  # a dollar sign in a title is one
    "lines.linewidth": 1.1,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "hatch.color": "#CCCCCC",
    "svg.fonttype": "path",  # the same letters on every computer
    "path.simplify_threshold": 0.3,
}


class Shown(matplotlib_figure.Figure):
    """A figure that a notebook shows, which it does of pyplot's own only."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=_SCREEN)
        return picture.getvalue()


@contextmanager
def style() -> Iterator[None]:
    """Set gbeam's style, and leave matplotlib's settings as they were. Within itself it does nothing, in no time."""
    if all(rcParams[name] == value for name, value in STYLE.items()):
        yield
        return
    with rc_context(STYLE):
        yield


def draw(described: Figure) -> Shown:
    """Draw a described figure, and return it."""
    with style():
        heights = [panel.height for panel in described.panels]
        title = "\n".join(textwrap.fill(line, _HEAD) for line in printable(described.heading).split("\n"))
        size = WIDTH, PANEL * sum(heights) + 0.15 * len(heights) + 0.4 + 0.18 * title.count("\n")
        figure = Shown(figsize=size, layout="constrained")
        FigureCanvasAgg(figure)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
        linked = len({panel.x for panel in described.panels}) == 1
        all_axes: list[Axes] = list(
            figure.subplots(len(heights), squeeze=False, sharex=linked, height_ratios=heights)[:, 0]
        )
        for k, (axes, panel) in enumerate(zip(all_axes, described.panels, strict=True)):
            _fill(axes, panel, first=k == 0)
            if not linked or k == len(all_axes) - 1:
                axes.set_xlabel(panel.x)
    return figure


def _fill(axes: Axes, panel: Panel, *, first: bool) -> None:
    """Draw all parts of a panel. The `first` panel of a figure names what is shaded in its legend."""
    if panel.logarithmic:
        axes.set_xscale("log")
        axes.set_yscale("log")
        for scale in (axes.xaxis, axes.yaxis):
            scale.set_major_locator(LogLocator(subs=(1, 2, 5)))
            scale.set_minor_locator(NullLocator())
            scale.set_major_formatter("{x:g}")
    for area in panel.areas:
        look: dict[str, Any] = {"color": PALETTE[area.colour], "alpha": 0.25, "lw": 0, "label": area.label}
        axes.fill_between(area.x, area.low, area.high, **look)
    for curve in panel.lines:
        _line(axes, curve, named=panel.named)
    if panel.lines and not any(np.isfinite(curve.y).any() for curve in panel.lines):
        x_all = np.concatenate([curve.x for curve in panel.lines])  # no limits follow from points without a height
        margin = 0.05 * (np.ptp(x_all) or abs(x_all[0]) or 1.0)
        axes.set_xlim(x_all.min() - margin, x_all.max() + margin)
    last_label = ""
    for level in panel.levels:
        label = level.label if level.label != last_label else None  # both sides of a limit have one name
        axes.axhline(level.value, color="black", lw=0.9, ls=_DASHES[level.dash], zorder=2.4, label=label)
        last_label = level.label
    for mark in panel.marks:
        axes.axvline(mark.value, color="black", lw=0.9, ls=_DASHES["dashed"], label=mark.label if panel.named else None)
    if panel.bars is not None:
        _bars(axes, panel.bars)
    if panel.map is not None:
        _map(axes, panel.map)
    for x, y, words in panel.texts:
        white = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
        axes.text(x, y, words, ha="center", va="center", color="0.35", fontsize=8, zorder=1.2, bbox=white)
    counted = all(curve.marks == "joined" and not np.any(curve.x % 1) for curve in panel.lines)
    if panel.lines and counted:  # as tries are
        axes.xaxis.set_major_locator(MaxNLocator("auto", integer=True))
    if panel.ticks:
        axes.set_xticks(range(len(panel.ticks)), panel.ticks)
    axes.set_ylabel(textwrap.fill(panel.y, max(12, round(_LABEL * PANEL * panel.height))))
    if panel.limits is not None:
        axes.set_ylim(*panel.limits)
    else:
        _include(axes, panel)
    _shade(axes, panel.spans, named=first)
    axes.set_title(panel.title)
    axes.yaxis.get_offset_text().set_x(-0.07)  # a power of ten, beside the title
    _legend(axes)


def _line(axes: Axes, curve: Line, *, named: bool) -> None:
    look = {"color": PALETTE[curve.colour], "ls": _DASHES[curve.dash], "label": curve.label if named else ""}
    look |= _MARKS[curve.marks]
    if curve.broad:
        look |= {"lw": BROAD, "zorder": 1.9, "solid_capstyle": "butt"}
    line(axes, curve.x, curve.y, **look)


def _bars(axes: Axes, bars: Bars) -> None:
    """Draw groups of bars beside each other, the first name on top."""
    base = -np.arange(len(bars.names), dtype=float)
    width = 0.8 / len(bars.values)
    for k, (label, values) in enumerate(bars.values.items()):
        place = base + width * ((len(bars.values) - 1) / 2 - k)
        axes.barh(place, values, height=0.9 * width, color=PALETTE[k % len(PALETTE)], label=label)
        if bars.low:
            ends = [values - bars.low[label], bars.high[label] - values]
            axes.errorbar(values, place, xerr=ends, fmt="none", ecolor="black", elinewidth=0.9, capsize=2.5)
    axes.axvline(0, color="black", lw=0.8)
    axes.set_yticks(base, bars.names)
    axes.grid(axis="y", visible=False)


def _map(axes: Axes, cells: Map) -> None:
    axes.grid(visible=False)
    mesh = axes.pcolormesh(cells.x, cells.y, cells.values.T, cmap="cividis", shading="nearest")
    axes.figure.colorbar(mesh, ax=axes, ticks=MaxNLocator(5))


def _include(axes: Axes, panel: Panel) -> None:
    """Stretch a panel to its levels and, where it is asked, to zero: a constant is seen at its size."""
    low, high = axes.get_ylim()
    ends = [0.0] if panel.zero else []
    ends += [1.08 * level.value for level in panel.levels]
    wide_low, wide_high = min([low, *ends]), max([high, *ends])
    margin = 0.05 * (wide_high - wide_low) if panel.zero and (low > 0 or high < 0) else 0.0
    if (wide_low, wide_high) != (low, high):
        axes.set_ylim(wide_low - margin, wide_high + margin)


def _shade(axes: Axes, spans: Sequence[Span], *, named: bool) -> None:
    """Shade stretches in a panel, with their reasons in the legend of the first."""
    reasons = [reason for *_, reason in spans]
    ordered = sorted(spans, key=lambda span: reasons.index(span[2]))
    for reason, group in groupby(ordered, key=lambda span: span[2]):
        face, hatch = _PATTERNS.get(reason, _LIMIT)
        corners = [[(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0)] for a, b, _ in group]
        shaded = PolyCollection(
            corners,
            transform=axes.get_xaxis_transform(),
            facecolor=face,
            edgecolor=rcParams["hatch.color"] if hatch else "none",
            hatch=hatch,
            lw=0,
            zorder=0,
            label=reason if named else f"_{reason}",
        )
        axes.add_collection(shaded, autolim=False)  # not as data, or the panel would stretch to it


def _legend(axes: Axes) -> None:
    """Put the legend of what has a label above a panel, lines, then what is shaded."""
    entries = list(zip(*axes.get_legend_handles_labels(), strict=True))
    if not entries:
        return
    entries.sort(key=lambda entry: (not isinstance(entry[0], Line2D), entry[1] != ENVELOPE))
    handles, labels = zip(*entries, strict=True)
    # Columns are as wide as their longest label; a handle takes about five letters.
    room = _ROW - len(axes.get_title(loc="left"))
    columns = min(max(1, room // (max(map(len, labels)) + 5)), len(labels))
    look: dict[str, Any] = {"borderaxespad": 0.2, "handlelength": 1.6, "columnspacing": 1.4, "ncols": columns}
    axes.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 1.0), **look)
