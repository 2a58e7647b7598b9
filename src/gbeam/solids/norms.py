"""Largest Euclidean norms of linear maps of coordinates over time, without the norms that cannot be the largest."""

from __future__ import annotations

import numpy as np

from gbeam.results.result import Floats
from gbeam.solids.shape_functions import Indices

STRAIGHT = 0.01  # of the largest norm: by so much coordinates depart from chords between times of all norms
FEW = 8  # times that are computed together
SOME = 4  # one of so many times tells maps whose norms are the largest
BLOCK = 2**22  # numbers handled together
SETTLED = 1e-9  # by which a norm between others may be larger without being computed
ROUNDING = 1e-12  # by which norms that are equal differ


class LargestNorms:
    """Largest norms of maps (m, p, n) of coordinates q (t, n): of each map over time, `size` (p,), the first time at
    which, `when` (p,), and over all maps at each time, `over` (t,).

    A norm is convex: between two times it is at most what is interpolated between its values there and the norm of
    what the coordinates depart from their chord, at most the sum of the norms of the columns times that of each. Only
    maps that could exceed what is known by then are computed between, at the middle and in both halves again.
    """

    def __init__(self, maps: Floats, q: Floats) -> None:
        self.maps, self.q = maps, q
        self.columns = np.sqrt(np.square(maps).sum(axis=0))
        count = maps.shape[1]
        self.size, self.when, self.over = np.full(count, -1.0), np.zeros(count, dtype=int), np.zeros(len(q))
        every, times = np.arange(count), np.arange(len(q))
        scaled = q * self.columns.mean(axis=0)
        ends = np.array([0, *_ends(scaled, STRAIGHT * np.abs(scaled).sum(axis=1).max(), 0, len(q) - 1)])
        spans = self._chunks(ends, every)
        foremost = np.concatenate([self._at(ends[span][::SOME], every).argmax(axis=1) for span in spans])
        self._throughout(times, np.unique(foremost))
        last, at_last = 0, np.empty(0)
        for span in spans:
            for end, at_end in zip(ends[span], self._at(ends[span], every), strict=True):
                self._between(last, end, every, at_last, at_end)
                last, at_last = end, at_end

    def _chunks(self, times: Indices, some: Indices) -> list[slice]:
        """Spans of times at which the norms of some maps are handled together."""
        step = max(1, BLOCK // (len(some) * len(self.maps)))
        return [slice(start, start + step) for start in range(0, len(times), step)]

    def _throughout(self, times: Indices, some: Indices) -> None:
        """Hold the norms of some maps at all of the times against the largest."""
        for span in self._chunks(times, some):
            self._at(times[span], some)

    def _at(self, times: Indices, some: Indices) -> Floats:
        """Norms (t, s) of some maps at times in order, held against the largest."""
        maps = self.maps if len(some) == len(self.size) else self.maps[:, some]
        mapped = self.q[times] @ maps.swapaxes(1, 2)
        norms = np.sqrt(np.square(mapped).sum(axis=0))
        self.over[times] = np.maximum(self.over[times], norms.max(axis=1))
        size = norms.max(axis=0)
        when = times[(norms >= (1 - ROUNDING) * size).argmax(axis=0)]
        before, until = self.size[some], self.when[some]
        more = (size > (1 + ROUNDING) * before) | ((size >= (1 - ROUNDING) * before) & (when < until))
        self.size[some], self.when[some] = np.maximum(size, before), np.where(more, when, until)
        return np.asarray(norms)

    def _between(self, first: int, last: int, some: Indices, at_first: Floats, at_last: Floats) -> None:
        """Hold the norms between two times, at which those of some maps are known, against the largest."""
        inside = np.arange(first + 1, last)
        if len(inside) == 0:
            return
        share = (inside - first) / (last - first)
        more = self.columns[some] @ _departure(self.q, first, last)
        below = ((1 - share) * self.over[first] + share * self.over[last] - self.over[inside]).max()
        largest_of_map = np.maximum(at_first, at_last) + more > (1 + SETTLED) * self.size[some]
        largest_of_all = np.maximum(at_first - self.over[first], at_last - self.over[last]) + more + max(below, 0.0) > 0
        kept = largest_of_map | largest_of_all
        some, at_first, at_last = some[kept], at_first[kept], at_last[kept]
        if len(some) == 0:
            return
        if len(inside) <= FEW:
            self._throughout(inside, some)
            return
        middle = (first + last) // 2
        at_middle = self._at(np.array([middle]), some)[0]
        self._between(first, middle, some, at_first, at_middle)
        self._between(middle, last, some, at_middle, at_last)


def _departure(q: Floats, first: int, last: int) -> Floats:
    """Largest departures (n,) of coordinates from their chord between two times."""
    share = (np.arange(first + 1, last)[:, None] - first) / (last - first)
    return np.asarray(np.abs(q[first + 1 : last] - (1 - share) * q[first] - share * q[last]).max(axis=0))


def _ends(q: Floats, most: float, first: int, last: int) -> list[int]:
    """Times after the first, up to the last, between which coordinates depart from chords by `most` in sum."""
    if last - first < FEW or _departure(q, first, last).sum() <= most:
        return [last]
    middle = (first + last) // 2
    return [*_ends(q, most, first, middle), *_ends(q, most, middle, last)]
