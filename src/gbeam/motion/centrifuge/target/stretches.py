"""Stretches of time in which a target is not the flight's load, as rows of numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.samples import true_runs

REASONS = ("below idle", "gimbals", "left out")
BELOW_IDLE, GIMBALS, LEFT_OUT = range(len(REASONS))

_TOUCH = 1e-9  # s

Floats = NDArray[np.float64]
Row = tuple[float, float, float, float]  # start s, end s, number of the reason, the flight's largest load m/s²


def stretches(times: Floats, reasons: NDArray[np.int64], size: Floats, reach: Floats, flight: Profile) -> list[Row]:
    """Rows of the runs of knots with one reason, by start.

    `times` (k,) s, `reasons` (k,), `size`, `reach` (k,).
    """

    def edge(outside: int, inside: int) -> float:
        """Where one reason ends and another, or none, begins: between two neighbouring knots, or at the last one."""
        if outside < 0 or outside == times.size:
            return float(times[inside])
        pair = reasons[outside], reasons[inside]
        values = reach if GIMBALS in pair and BELOW_IDLE not in pair else size
        rise = values[outside] - values[inside]
        part = np.clip(-values[inside] / rise, 0.0, 1.0) if rise != 0 else 1.0
        return float(times[inside] + part * (times[outside] - times[inside]))

    rows: list[Row] = []
    for number in range(len(REASONS)):
        for run in true_runs(reasons == number):
            start, end = edge(run.start - 1, run.start), edge(run.stop, run.stop - 1)
            if end > start:
                loads = flight(np.concatenate([[start], times[run], [end]]))
                rows.append((start, end, float(number), float(np.linalg.norm(loads, axis=1).max())))
    return sorted(rows)


def padded_rows(rows: list[Row]) -> Floats:
    """By start, up to a multiple of eight, so that targets share their programs; unused rows are infinite."""
    padded = np.full((8 * (len(rows) // 8 + 1), 4), np.inf)
    padded[: len(rows)] = np.reshape(rows, (-1, 4))
    return padded


def merged_edges(rows: list[Row], last: float) -> Floats:
    """Starts and ends, those of stretches that touch left out; up to a multiple of 16, unused ones infinite.

    A stretch that lasts until `last`, the end of the span, goes on beyond.
    """
    edges: list[float] = []
    for start, end, *_ in rows:
        if edges and start <= edges[-1] + _TOUCH:
            edges[-1] = max(edges[-1], end)
        else:
            edges += [start, end]
    if edges and edges[-1] >= last:
        edges[-1] = np.inf
    return np.append(edges, np.full(16 * (len(edges) // 16 + 1) - len(edges), np.inf))
