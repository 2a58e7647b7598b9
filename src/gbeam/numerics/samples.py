"""Histories sampled over time: runs of samples, values between them, integrals, attitude and peaks."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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


def thinned(x: Floats, y: Floats, columns: int) -> tuple[Floats, Floats]:
    """The samples that show: of each of so many columns the first, last, lowest and highest; few stay as they are."""
    if len(x) <= 4 * columns:
        return x, y
    width = -(-len(x) // columns)
    index = np.minimum(np.arange(width * -(-len(x) // width)), len(x) - 1).reshape(-1, width)
    rows, shown = np.arange(len(index)), y[index]
    ends = index[:, 0], index[:, -1], index[rows, shown.argmin(axis=1)], index[rows, shown.argmax(axis=1)]
    kept = np.unique(np.concatenate(ends))
    return x[kept], y[kept]


def interpolated(time: Floats, known: Floats, values: Floats) -> Floats:
    """Values (t, ...) at the times `known`, at `time` (u,): on straight lines, and constant beyond the ends."""
    columns = np.reshape(values, (len(known), -1)).T
    return np.stack([np.interp(time, known, each) for each in columns], axis=1).reshape(-1, *np.shape(values)[1:])


def cumulative(time: Floats, value: Floats, slope: Floats) -> Floats:
    """Integral from the first time to each, by the trapezium rule with its end correction: of fourth order.

    `time`, `value`, `slope` (n,).
    """
    step = np.diff(time)
    pieces = step * (value[1:] + value[:-1]) / 2 - step**2 * np.diff(slope) / 12
    return np.append(0.0, np.cumsum(pieces))


def attitude(time: Floats, w_WB_B: Floats) -> Floats:
    """Attitudes since the first time, quaternions (t, 4) w, x, y, z, by body rates (t, 3) rad/s at `time` (t,) s."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_rotvec(0.5 * (w_WB_B[1:] + w_WB_B[:-1]) * np.diff(time)[:, None])
    since = Rotation.concatenate([Rotation.identity(), turns]) if len(turns) else Rotation.from_quat([[0, 0, 0, 1]])
    reach = 1
    while reach < len(since):  # products of 2, 4, 8, ... intervals at once
        since = Rotation.concatenate([since[:reach], since[:-reach] * since[reach:]])
        reach *= 2
    return np.roll(since.as_quat(), 1, axis=1)


def separate_peaks(values: NDArray[np.float64], floor: float, dip: float) -> list[tuple[int, slice]]:
    """Local maxima above a floor, those that no dip separates being one.

    `values` (n,); returns (int, slice).
    """
    peaks: list[tuple[int, slice]] = []
    for run in true_runs(values > floor):
        part = values[run]
        rises = np.concatenate([[True], part[1:] > part[:-1]])
        falls = np.concatenate([part[:-1] >= part[1:], [True]])
        tops = np.flatnonzero(rises & falls)
        kept, lowest = [int(tops[0])], np.inf
        for top, before in zip(tops[1:].tolist(), np.minimum.reduceat(part, tops)[:-1].tolist(), strict=True):
            lowest = min(lowest, before)
            if lowest < dip * min(part[kept[-1]], part[top]):
                kept.append(top)
            elif part[top] > part[kept[-1]]:
                kept[-1] = top
            else:
                continue
            lowest = np.inf
        lows = [first + int(np.argmin(part[first:second])) for first, second in pairwise(kept)]
        edges = [0, *lows, len(part)]
        peaks += [
            (run.start + top, slice(run.start + begin, run.start + end))
            for top, (begin, end) in zip(kept, pairwise(edges), strict=True)
        ]
    return peaks
