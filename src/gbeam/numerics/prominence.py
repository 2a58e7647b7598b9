"""Local maxima that stand out from what is around them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gbeam.numerics.intervals import true_runs


def separate_peaks(values: NDArray[np.float64], floor: float, dip: float) -> list[tuple[int, slice]]:
    """Local maxima above a floor, those that no dip separates being one.

    `values` (n,); returns (int, slice).
    """
    found: list[tuple[int, slice]] = []
    for run in true_runs(values > floor):
        own = values[run]
        rises = np.concatenate([[True], own[1:] > own[:-1]])
        falls = np.concatenate([own[:-1] >= own[1:], [True]])
        tops = np.flatnonzero(rises & falls)
        kept, lowest = [int(tops[0])], np.inf
        for top, before in zip(tops[1:].tolist(), np.minimum.reduceat(own, tops)[:-1].tolist(), strict=True):
            lowest = min(lowest, before)
            if lowest < dip * min(own[kept[-1]], own[top]):
                kept.append(top)
            elif own[top] > own[kept[-1]]:
                kept[-1] = top
            else:
                continue
            lowest = np.inf
        lows = [first + int(np.argmin(own[first:second])) for first, second in pairwise(kept)]
        edges = [0, *lows, len(own)]
        found += [
            (run.start + top, slice(run.start + begin, run.start + end))
            for top, (begin, end) in zip(kept, pairwise(edges), strict=True)
        ]
    return found
