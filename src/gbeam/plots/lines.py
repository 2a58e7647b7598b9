"""Lines over time or speed, and stretches of time behind them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from gbeam.numerics.samples import true_runs
from gbeam.plots.style import ENVELOPE, colour, moving, subtitle
from gbeam.results.imitation.accounting import Accounting
from gbeam.results.machine import AxesResult
from gbeam.results.result import Flags, Floats

COLUMNS = 1500  # across a line: more than a panel has pixels at 150 dpi
BINS = 240  # across a line, each of four to five pixels
_FAST = 2.5  # path of a line in a bin over its range there: 1 where it rises, 2 at a peak, 2 n for n oscillations
_SEEN = 1e-3  # of the whole range: a smaller vibration is hidden by the width of the line, or is rounding
_GAP, _FEW = 2, 3  # bins: between stretches that are drawn as one, and of a stretch that stays a line
# Flight is broad and light, and below what imitates it, which is thin: where they agree both are seen.
FLIGHT: dict[str, Any] = {"color": "#56B4E9", "lw": 3.4, "zorder": 1.9, "solid_capstyle": "butt"}
# Of components drawn together: told apart in print as well.
_OVER: tuple[Any, ...] = ("-", (0, (4, 3)), (0, (1.5, 3)))
_DASHES: tuple[Any, ...] = ((0, (1.5, 1)), (0, (5, 1.5)), "-")


def machine(index: int) -> dict[str, Any]:
    """Style of the `index`-th line that is compared with flight's; from the second on dashed, on top of the first."""
    return {"color": colour(index + 1), "lw": 1.0, "zorder": 2.2 + 0.01 * index, "ls": _OVER[min(max(index, 0), 2)]}


def line(panel: Axes, x: Floats, y: Floats, **options: Any) -> None:
    """Draw a line: an envelope where it oscillates about once in the width of a line or faster, else what shows of it.

    `x`, `y` (n,).
    """
    bins = _Bins(x, y) if len(x) >= 4 * BINS else None
    runs = [] if bins is None else true_runs(bins.fast)
    if bins is None or not runs:
        panel.plot(*_reduced(x, y), **options)
        return
    (drawn,) = panel.plot(*bins.middle(x, y, runs), **options)
    named = any(each.get_label() == ENVELOPE for other in drawn.figure.axes for each in other.collections)
    at, low, high = (np.concatenate(each) for each in zip(*(bins.envelope(x, y, run) for run in runs), strict=True))
    look: dict[str, Any] = {"color": drawn.get_color(), "zorder": drawn.get_zorder()}
    panel.fill_between(at, low, high, **look, lw=0, alpha=0.35, label=None if named else ENVELOPE)
    for edge in (low, high):
        panel.plot(at, edge, **look, lw=0.6, label="_edge")


def components(panel: Axes, where: Floats, values: Floats, names: Sequence[str]) -> None:
    """Draw the components (n, 3) that are more than a hundredth of the largest, and name the others."""
    shown, sizes = moving(values), np.abs(values).max(axis=0)
    for i in shown:
        line(panel, where, values[:, i], color=colour(i), ls=_DASHES[i], label=names[i])
    left = [names[i] for i in range(3) if i not in shown and sizes[i] > 1e-9 * sizes.max()]
    if left:
        subtitle(panel, f"{' and '.join(left)}: below 1 %, not drawn")


class _Bins:
    """A line in bins of a few pixels: its range in each, and whether it oscillates there faster than can be seen."""

    def __init__(self, x: Floats, y: Floats) -> None:
        edges = np.linspace(x[0], x[-1], BINS + 1)
        self.centre = (edges[1:] + edges[:-1]) / 2
        self.starts = np.searchsorted(x, edges[:-1])
        self.low, self.high = (each.reduceat(y, self.starts) for each in (np.minimum, np.maximum))
        ranges = self.high - self.low
        path = np.add.reduceat(np.abs(np.diff(y, append=y[-1])), self.starts)
        self.fast = _closed((path > _FAST * ranges) & (ranges > _SEEN * np.nanmax(ranges, initial=0.0)))
        self._ends = np.append(self.starts, len(x) - 1)

    def middle(self, x: Floats, y: Floats, runs: list[slice]) -> tuple[Floats, Floats]:
        """The line, in the middle of its envelope where it has one."""
        parts, begin = [], 0
        for run in runs:
            parts.append(_reduced(x[begin : self._ends[run.start] + 1], y[begin : self._ends[run.start] + 1]))
            parts.append((self.centre[run], (self.low[run] + self.high[run]) / 2))
            begin = self._ends[run.stop]
        parts.append(_reduced(x[begin:], y[begin:]))
        at, values = zip(*parts, strict=True)
        return np.concatenate(at), np.concatenate(values)

    def envelope(self, x: Floats, y: Floats, run: slice) -> tuple[Floats, Floats, Floats]:
        """Where it is, its low and its high edge: it begins and ends on the line, then there is a gap."""
        first, last = self._ends[[run.start, run.stop]]
        low, high = ([y[first], *each[run], y[last], np.nan] for each in (self.low, self.high))
        return np.array([x[first], *self.centre[run], x[last], np.nan]), np.array(low), np.array(high)


def _closed(fast: Flags) -> Flags:
    """Stretches with small gaps between them joined, then short ones dropped."""
    joined = fast.copy()
    for gap in true_runs(~fast):
        if gap.start > 0 and gap.stop < len(fast) and gap.stop - gap.start <= _GAP:
            joined[gap] = True
    for run in true_runs(joined):
        if run.stop - run.start < _FEW:
            joined[run] = False
    return joined


def _reduced(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The points that show: per column of pixels the first, last, lowest and highest."""
    per_column = len(x) // COLUMNS
    if per_column <= 4:
        return x, y
    full = COLUMNS * per_column
    rows = y[:full].reshape(COLUMNS, per_column)
    start = per_column * np.arange(COLUMNS)
    lowest, highest = start + rows.argmin(axis=1), start + rows.argmax(axis=1)
    kept = np.unique(np.concatenate([start, lowest, highest, start + per_column - 1, np.arange(full, len(x))]))
    return x[kept], y[kept]


Stretch = tuple[float, float, str]  # start, end s, reason

# Colour and hatch, which tells them apart in print.
_PATTERNS = {
    "spin-up": ("#F8F8F8", "///"),
    "spin-down": ("#F8F8F8", "\\\\\\"),
    "below idle": ("#DEDEDE", None),
    "gimbals": ("#F5E3BE", "..."),
    "left out": ("#EFD3E4", "xxx"),
    "corner": ("#CFE8DE", "---"),
}
_LIMIT = ("#F7CDB8", "+++")  # of the machine, by its name
_HATCH = "#CCCCCC"
_SPAN = 1e-6  # s: shorter is rounding


def stretches(axes: AxesResult | None, time: Floats, accounting: Accounting | None = None) -> list[Stretch]:
    """Return the spin-up, what is not followed and why, and the spin-down, in order of time.

    `time` (t,) s.
    """
    if axes is None and accounting is None:
        return []
    if accounting is not None:
        held: list[Stretch] = [(each.start, each.end, each.reason) for each in accounting.not_followed]
    else:
        held = [] if axes is None else list(axes.episodes)
    first, last = (float(time[0]), float(time[-1])) if axes is None else axes.span
    ends = [(float(time[0]), first, "spin-up"), *held, (last, float(time[-1]), "spin-down")]
    return [(start, end, reason) for start, end, reason in ends if end - start > _SPAN]


def shade(panels: Sequence[Axes], marked: Iterable[Stretch], *, label: bool = True) -> None:
    """Shade stretches of time in all panels, and name their reasons in the legend of the first."""
    by_reason: dict[str, list[Stretch]] = {}
    for each in marked:
        by_reason.setdefault(_short(each[2]), []).append(each)
    for panel in panels:
        for reason, some in by_reason.items():
            face, hatch = _PATTERNS.get(reason, _LIMIT)
            corners = [[(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0)] for a, b, _ in some]
            options: dict[str, Any] = {"label": reason} if label and panel is panels[0] else {"label": f"_{reason}"}
            # Not added as data, or the panel would stretch to it.
            panel.add_collection(
                PolyCollection(
                    corners,
                    transform=panel.get_xaxis_transform(),
                    facecolor=face,
                    edgecolor=_HATCH if hatch else "none",
                    hatch=hatch,
                    lw=0,
                    zorder=0,
                    **options,
                ),
                autolim=False,
            )


def _short(reason: str) -> str:
    """A reason as a legend has it: of several limits that are used up, ``axis 2 jerk, axis 3 jerk``, the axes only."""
    limits = reason.split(", ")
    if len(limits) == 1:
        return reason
    return f"limits of {' and '.join(sorted({each.rpartition(' ')[0] for each in limits}))}"
