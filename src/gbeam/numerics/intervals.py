"""Stretches of true flags along an axis of samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def true_runs(flags: NDArray[np.bool_]) -> list[slice]:
    """Runs of true flags, ascending, each as a slice.

    `flags` (n,).
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [slice(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def joined(runs: list[slice], time: NDArray[np.float64], gap: float) -> list[slice]:
    """Runs of samples with those nearer than `gap` to one another made one.

    `time` (n,) s.
    """
    merged: list[slice] = []
    for run in runs:
        if merged and time[run.start] - time[merged[-1].stop - 1] < gap:
            merged[-1] = slice(merged[-1].start, run.stop)
        else:
            merged.append(run)
    return merged
