"""Times at which richer systems are read: near peaks of what is computed, where departures are largest, and between."""

from __future__ import annotations

import math
from typing import NamedTuple, Self

import numpy as np

from gbeam.analysis.accuracy.correction import MOVED, Reading
from gbeam.arrays.types import Floats, Indices
from gbeam.numerics.peaks import FEWEST, WIDE, largest_peak_difference, signed_columns

FEW = 300  # times: of fewer, all are read
PEAKS = 8  # highest local maxima, of each history computed, beside which all times are read
SINGLE = 4  # highest local maxima, of each size of a departure, which are read
EVENLY_SPREAD = 64  # times that are read wherever the peaks are
NOTABLE = 0.1  # of a quantity's largest component: peaks of smaller ones are not looked for
HALF = 0.5  # likewise of quantities with many components, as stress of a mesh


class Looks(NamedTuple):
    """Indices `at` (k,) of the times that are read. `windows` (w, m) are indices of neighbours among these, `interval`
    s apart, within which peaks are looked for.
    """

    at: Indices
    windows: Indices
    interval: float

    @classmethod
    def all_times(cls, time: Floats) -> Self:
        """Look at all times."""
        every = np.arange(len(time))
        return cls(every, every[None], float(time[-1] - time[0]) / max(len(time) - 1, 1))

    @classmethod
    def chosen(cls, time: Floats, near: Floats, spacing: float, sizes: Floats) -> Self:
        """Look at times (t,) beside the first and those in `near`, which were found `spacing` s apart, where `sizes`
        (t, k) of departures are largest, and at some between.
        """
        every, count = cls.all_times(time), len(time)
        if count <= FEW:
            return every
        half = FEWEST // 2 + math.ceil(spacing / every.interval - 1e-6)
        centres = np.unique(np.clip(np.searchsorted(time, np.append(near, time[0])), half, count - 1 - half))
        windows = centres[:, None] + np.arange(-half, half + 1)
        between = np.linspace(0, count - 1, EVENLY_SPREAD).astype(int)
        at = np.unique(np.concatenate([windows.ravel(), highest(sizes, SINGLE), between]))
        return cls(at, np.searchsorted(at, windows), every.interval)

    def peak_difference(self, values: Floats, other_values: Floats) -> float:
        """Largest difference of the peaks of two histories at the times that are read."""
        time = self.interval * np.arange(self.windows.shape[1], dtype=np.float64)
        return largest_peak_difference(time, values[self.windows], other_values[self.windows])


def times_of_peaks(time: Floats, computed: Reading) -> Floats:
    """Times, s, of the highest local maxima of loads and stress."""
    chosen = [np.zeros(0, dtype=np.intp)]
    for key, values in computed.items():
        if key[1] not in MOVED:
            columns = values[:, None] if values.ndim == 1 else signed_columns(values)
            columns = columns.reshape(len(values), -1)  # of vectors at several places
            largest = np.abs(columns).max(axis=0)
            share = HALF if values.ndim == 2 and values.shape[1] > WIDE else NOTABLE
            chosen.append(highest(columns[:, largest >= share * largest.max()], PEAKS))
    return time[np.unique(np.concatenate(chosen))]


def highest(columns: Floats, count: int) -> Indices:
    """Indices of the `count` highest local maxima of each column (t, k), in order and without repetition."""
    padded = np.pad(columns, ((1, 1), (0, 0)), constant_values=-np.inf)
    peaked = (columns > padded[:-2]) & (columns >= padded[2:])
    heights = np.where(peaked, columns, -np.inf)
    first = np.argpartition(-heights, min(count, len(columns) - 1), axis=0)[:count]
    return np.unique(first[np.take_along_axis(peaked, first, axis=0)])
