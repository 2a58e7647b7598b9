"""The load that a machine follows, and the stretches in which it is not the flight's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record, static
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.samples import true_runs

REASONS = ("below idle", "gimbals", "left out")
BELOW_IDLE, GIMBALS, LEFT_OUT = range(len(REASONS))

_TOUCH = 1e-9  # s

Floats = NDArray[np.float64]
Row = tuple[float, float, float, float]  # start s, end s, number of the reason, the flight's largest load m/s²


def stretches(times: Floats, reasons: NDArray[np.int64], size: Floats, reach: Floats, flight: Profile) -> list[Row]:
    """Rows of the runs of knots at times (k,) s with one reason, by start."""

    def edge(outside: int, inside: int) -> float:
        """Time at which a reason ends and another, or none, begins: between two neighbouring knots, or at the last."""
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


@dataclass(frozen=True)
class Episode:
    """A stretch of time in which the target is not the flight's load."""

    start: float  # s
    end: float
    reason: str  # below idle; above it, gimbals (out of their reach) or left out (the inverse cannot follow)
    flight_peak: float  # largest load of the flight in it, m/s²


@record
class Target:
    """Reference load at the control point; built by :func:`gbeam.motion.build_target`."""

    # Vector, base axes, m/s²: specific force where gravity acts, else acceleration. It stands still from half the
    # kernel's width before the span on, and from half of it after.
    load: Profile
    flight: Profile  # the flight's own load, likewise, with its corners
    corners: Profile  # the flight's, standing still beyond the span: what is rounded
    idle: Any  # least load, m/s²; zero if there is none
    gravity: float = static()  # γ, m/s²: 9.80665 or 0
    half_width: Any  # of the kernel that rounds corners, s
    span: tuple[Any, Any]  # the flight's first and last time, s
    # (m, 4): start s, end s, place of the reason in `REASONS` and the flight's largest load m/s² of every stretch in
    # which the target is not the flight's load; unused rows are infinite.
    stretches: Any
    edges: Any  # (2 m,) ascending: where it stops being the flight's load, or is it again, s; unused ones infinite
    rounded: bool = static()  # whether the load has no corners
    turns: bool = static()  # whether its direction, or with gravity its size, changes: the gimbals must move

    def not_followed(self, t: Any) -> Any:
        """Tell at which times `t` (s, any shape) the target is not the flight's load."""
        now = as_array(t)
        xp = namespace(now, self.edges)
        return xp.searchsorted(xp.asarray(self.edges), now, side="right") % 2 == 1

    def episodes(self) -> list[Episode]:
        """Stretches within the span where the load is not the flight's, by start."""
        rows = np.asarray(self.stretches)
        return [
            Episode(float(start), float(end), REASONS[int(code)], float(peak))
            for start, end, code, peak in rows[np.isfinite(rows[:, 0])]
        ]
