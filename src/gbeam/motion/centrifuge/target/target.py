"""The load that a centrifuge is to make: at every time the nearest to a flight's that it can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record, static
from gbeam.motion.centrifuge.target.stretches import REASONS
from gbeam.motion.profiles.profile import Profile


@dataclass(frozen=True)
class Episode:
    """A stretch of time in which the target is not the flight's load.

    Parameters
    ----------
    start, end : float
        s.
    reason : str
        ``below idle``, ``gimbals`` (above idle, out of their reach) or ``left out`` (above idle, and the inverse cannot
        follow).
    flight_peak : float
        Largest load of the flight in it, m/s².
    """

    start: float
    end: float
    reason: str
    flight_peak: float


@record
class Target:
    """Reference load at the control point; built by :func:`gbeam.motion.build_target`.

    Parameters
    ----------
    load : Profile
        Vector, base axes, m/s²: specific force where gravity acts, else acceleration. It stands still from half the
        kernel's width before the span on, and from half of it after.
    flight : Profile
        The flight's own load, likewise, with its corners.
    corners : Profile
        The flight's, standing still beyond the span: what is rounded.
    idle : float
        Least load, m/s²; zero if there is none.
    gravity : float
        γ, m/s²: 9.80665 or 0.
    half_width : float
        Half the width of the kernel that rounds corners, s.
    span : tuple of float
        The flight's first and last time, s.
    stretches : array, shape (m, 4)
        Start s, end s, place of the reason in ``REASONS`` and the flight's largest load m/s² of every stretch in which
        the target is not the flight's load; unused rows are infinite.
    edges : array, shape (2m,)
        Ascending: where the target stops being the flight's load and where it is again, s; unused ones are infinite.
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
    half_width: Any
    span: tuple[Any, Any]
    stretches: Any
    edges: Any
    rounded: bool = static()
    turns: bool = static()

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
