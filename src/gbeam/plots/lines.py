"""Lines with many points: what shows of them, and the envelopes of what vibrates faster than can be seen."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from gbeam.numerics.samples import thinned, true_runs
from gbeam.results.result import Flags, Floats

COLUMNS = 1500  # across a line: more than a panel has pixels at 150 dpi
BINS = 240  # across a line, each of four to five pixels
_FAST = 2.5  # path of a line in a bin over its range there: 1 where it rises, 2 at a peak, 2 n for n oscillations
_SEEN = 1e-3  # of the whole range: a smaller vibration is hidden by the width of the line, or is rounding
_GAP, _FEW = 2, 3  # bins: between stretches that are drawn as one, and of a stretch that stays a line
ENVELOPE = "fast vibration: envelope"  # in legends


def line(panel: Axes, x: Floats, y: Floats, **options: Any) -> None:
    """Draw a line: an envelope where it oscillates about once in the width of a line or faster, else what shows of it.

    `x`, `y` (n,).
    """
    bins = _Bins(x, y) if len(x) >= 4 * BINS else None
    runs = [] if bins is None else true_runs(bins.fast)
    if bins is None or not runs:
        panel.plot(*thinned(x, y, COLUMNS), **options)
        return
    (drawn,) = panel.plot(*bins.middle(x, y, runs), **options)
    named = any(each.get_label() == ENVELOPE for other in drawn.figure.axes for each in other.collections)
    at, low, high = (np.concatenate(each) for each in zip(*(bins.envelope(x, y, run) for run in runs), strict=True))
    look: dict[str, Any] = {"color": drawn.get_color(), "zorder": drawn.get_zorder()}
    panel.fill_between(at, low, high, **look, lw=0, alpha=0.35, label=None if named else ENVELOPE)
    for edge in (low, high):
        panel.plot(at, edge, **look, lw=0.6, label="_edge")


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
            before = slice(begin, self._ends[run.start] + 1)
            parts.append(thinned(x[before], y[before], COLUMNS))
            parts.append((self.centre[run], (self.low[run] + self.high[run]) / 2))
            begin = self._ends[run.stop]
        parts.append(thinned(x[begin:], y[begin:], COLUMNS))
        at, values = zip(*parts, strict=True)
        return np.concatenate(at), np.concatenate(values)

    def envelope(self, x: Floats, y: Floats, run: slice) -> tuple[Floats, Floats, Floats]:
        """Times of a stretch, its low and its high edge: it begins and ends on the line, then there is a gap."""
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
