"""The load that a centrifuge is to make: a flight's, held where it cannot follow, its corners rounded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record, static
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.intervals import true_runs


@dataclass(frozen=True)
class Episode:
    """A stretch of time, s, in which the target is not the flight's load, and why."""

    start: float
    end: float
    reason: str


@record
class Target:
    """Reference load at the control point; built by :func:`gbeam.motion.build_target`.

    Parameters
    ----------
    load : Profile
        Vector, base axes, m/s²: specific force where gravity acts, else acceleration.
    flight : Profile
        What it was made from, likewise.
    corners : Profile
        The load before its corners were rounded, likewise.
    idle : float
        Least load, m/s²; zero if there is none.
    gravity : float
        γ, m/s²: 9.80665 or 0.
    times : array, shape (k,)
        Knots at which it was decided whether to hold, s.
    below_idle, out_of_reach : array, shape (k + 1,)
        Running count of the knots changed for either reason.
    half_width : float
        How far a changed knot acts beyond its neighbours: half the kernel's width, s.
    span : tuple of float
        First and last time, s.
    ready : float
        End of the spin-up, s: before, the load waits at the one that it has then. The span's start if there is none.
    rounded : bool
        The load has no corners.
    turns : bool
        Its direction, or with gravity its size, changes, so that the gimbals must move.
    """

    load: Profile
    flight: Profile
    corners: Profile
    idle: Any
    gravity: float = static()
    times: Any
    below_idle: Any
    out_of_reach: Any
    half_width: Any
    span: tuple[Any, Any]
    ready: Any
    rounded: bool = static()
    turns: bool = static()

    def not_followed(self, t: Any) -> Any:
        """Tell at which times `t` (s, any shape) the machine spins up or a changed knot has a say in the load."""
        now = as_array(t)
        xp = namespace(now, self.times)
        times, count = xp.asarray(self.times), xp.asarray(self.below_idle) + xp.asarray(self.out_of_reach)
        last = times.size - 1
        before = xp.searchsorted(times, now - self.half_width, side="right") - 1
        after = xp.searchsorted(times, now + self.half_width, side="left")
        return (now < self.ready) | (count[xp.minimum(after, last) + 1] > count[xp.clip(before, 0, last)])

    def episodes(self) -> list[Episode]:
        """Stretches within the span where the load is not the flight's, by start; two reasons may overlap."""
        reasons = (("below idle", self.below_idle), ("out of reach of the gimbals", self.out_of_reach))
        changes = ((reason, np.diff(np.asarray(count)) > 0) for reason, count in reasons)
        episodes = [Episode(*run, reason) for reason, changed in changes for run in self._stretches(changed)]
        if self.ready > self.span[0]:
            episodes.append(Episode(float(self.span[0]), float(self.ready), "spin-up"))
        return sorted(episodes, key=lambda episode: episode.start)

    def _stretches(self, changed: NDArray[np.bool_]) -> list[tuple[float, float]]:
        """Start and end of each run of changed knots, joined where they act on the same times."""
        times, half_width = np.asarray(self.times), float(self.half_width)
        first, last = float(self.ready), float(self.span[1])
        stretches: list[tuple[float, float]] = []
        for run in true_runs(changed):
            begin = max(float(times[run.start - 1]) - half_width, first) if run.start > 0 else first
            end = min(float(times[run.stop]) + half_width, last) if run.stop < times.size else last
            if stretches and begin <= stretches[-1][1]:
                stretches[-1] = (stretches[-1][0], end)
            elif begin < end:
                stretches.append((begin, end))
        return stretches
