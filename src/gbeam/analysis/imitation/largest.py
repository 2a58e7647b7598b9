"""The largest load anywhere on a specimen: that of its base, as if it were rigid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.motion.centrifuge.machine.kinematics import moved
from gbeam.results.imitation.accounting import PeakPair
from gbeam.results.result import Floats

_GRID, _MOST = 2e-3, 50_000  # s between times at which a load is looked at; most of them
_ALIKE = 1e-9  # of the load: points that differ by less feel the same

Largest = tuple[float, float, str]  # m/s², s, place; empty where every point feels the same


def times_between(first: float, last: float) -> Floats:
    """Times at which a motion is looked at where no response gives them, s."""
    return np.linspace(first, last, min(int(np.ceil((last - first) / _GRID)), _MOST) + 1)


def points_of(length: float, bodies: Floats) -> dict[str, Floats]:
    """Ends of the beam, m from the root, and bodies (b, 3), by name: the load's size, convex in the place, is largest
    at one.
    """
    ends = {"the root": np.zeros(3), "the tip": np.array([length, 0.0, 0.0])}
    off = [body for body in np.asarray(bodies) if np.any(body[1:] != 0) or not 0 <= body[0] <= length]
    return ends | {f"the body at {1e3 * body[0]:.4g} mm": body for body in off}


def largest_load(time: Floats, base: Any, points: Mapping[str, Floats], origin: float = 0.0) -> Largest:
    """Largest size of a base's load over time (t,) at points from the root, the base's point being at `origin`, m."""
    away = np.array([-origin, 0.0, 0.0])
    loads = np.array([np.linalg.norm(moved(base, place + away).a_WO_B, axis=-1) for place in points.values()])
    place, i = np.unravel_index(int(np.argmax(loads)), loads.shape)
    alike = np.ptp(loads[:, i]) <= _ALIKE * loads[place, i]
    return float(loads[place, i]), float(time[i]), "" if alike else list(points)[place]


def largest_pair(flight: Largest, machine: Largest) -> PeakPair:
    """Pair the largest loads of both."""
    return PeakPair(flight[0], machine[0], flight[1], machine[1], flight[2], machine[2])
