"""Loads that no centrifuge makes: those near zero, along the beam, or across it below gravity.

All on knots, when a target is built; vectors in base axes, m/s².
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST_IDLE = 1.1  # g, with gravity
IDLE_BAND = 0.2  # of idle: how softly the hold sets in, by at most 1.5 % of idle
UNTOUCHED = 1 + IDLE_BAND / 2  # times idle: a larger load is not raised
PARTED = 0.97  # times idle: two returns above idle between which the load is smaller are two
UNDIRECTED = 0.05  # of idle: a smaller load has no direction worth following
# The beam stays horizontal, so that gravity always acts across it: no attitude gives less than one g there, and near
# one g the gimbals would have to turn infinitely fast.
MIN_TRANSVERSE_LOAD = 1.05 * STANDARD_GRAVITY  # least load across the beam that the gimbals make where gravity acts
REACH_BAND = 0.1  # of it: likewise
OPPOSED = 0.1  # two unit vectors whose chord passes this near to zero count as opposite
_NEAR_ZERO = 0.02  # of the peak load
_ALONG_BEAM = 1e-3  # of the peak load


def refuse_undirected(load: Floats, idle: float) -> None:
    """Raise InputError if no load (k, 3) is large enough to have a direction."""
    if not np.any(np.linalg.norm(load, axis=1) >= UNDIRECTED * idle):
        raise InputError(
            "tracks",
            f"stays below {UNDIRECTED * idle / STANDARD_GRAVITY:.2g} g, too little to have a direction",
            "track a motion with a load, or lower idle",
        )


def refuse_far(times: Floats, load: Floats, far: Flags) -> None:
    """Raise InputError: the load leaves the gimbals' reach, and a target that is not the flight's was not allowed."""
    if far.all():
        raise InputError(
            "tracks",
            f"never loads the beam across by {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g, and gravity alone is 1 g",
            'set idle = "1.4 g" or more, or gravity = false',
        )
    refuse_reversal(times, load[:, 1:], OPPOSED * STANDARD_GRAVITY)
    across = np.linalg.norm(load[:, 1:], axis=1) / STANDARD_GRAVITY
    worst = int(np.argmin(across))
    wrong = np.flatnonzero(far)
    raise InputError(
        "tracks",
        f"loads the beam across by {across[worst]:.3g} g only at {times[worst]:.3f} s; where gravity acts the gimbals "
        f"reach {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g or more (out of reach from {times[wrong[0]]:.3f} s, "
        f"last at {times[wrong[-1]]:.3f} s)",
        'set idle = "1.4 g", or clip = true to carry on with the nearest load in reach, '
        f"or add {missing_across(across[worst] * STANDARD_GRAVITY)} across the beam",
    )


def missing_across(load: float) -> str:
    """Least addition to a load across the beam, m/s², that brings it into reach; rounded up."""
    return f"{np.ceil(100 * (MIN_TRANSVERSE_LOAD - load) / STANDARD_GRAVITY - 1e-6) / 100:g} g"


def refuse_reversal(times: Floats, points: Floats, least: float) -> None:
    """Raise InputError if the polyline through `points` (k, n) at `times` passes within `least` of zero."""
    when, distance = nearest_to_zero(times, points)
    if distance < least:
        raise InputError(
            "tracks",
            f"reverses its load through zero at {when:.3f} s",
            "a centrifuge must carry the specimen round and cannot do so at once: "
            'set idle = "1.4 g", or track a part of the motion before or after, or add a steady load',
        )


def refuse_singular(times: Floats, load: Floats, idle: float | None) -> None:
    """Refuse a load (k, 3), without gravity, that comes so near to zero, or to the beam, that the axes would spin."""
    peak = float(np.max(np.linalg.norm(load, axis=1)))
    if idle is None:
        when, distance = nearest_to_zero(times, load)
        if distance <= _NEAR_ZERO * peak:
            raise InputError(
                "tracks",
                f"has next to no load at {when:.3f} s, where the arm's acceleration is singular",
                'set idle = "1.4 g", or what the machine idles at',
            )
    when, distance = nearest_to_zero(times, load[:, 1:])
    if distance < _ALONG_BEAM * peak and np.any(load[:, 1:]):
        raise InputError(
            "tracks",
            f"loads the beam along its axis only at {when:.3f} s, where the roll axis has no defined angle",
            "add a steady load across the beam, or leave the components across it at zero throughout",
        )


def nearest_to_zero(times: Floats, points: Floats) -> tuple[float, float]:
    """Time and distance at which the polyline through `points` (k, n) comes nearest to zero."""
    if len(points) == 1:
        return float(times[0]), float(np.linalg.norm(points[0]))
    start, along = points[:-1], np.diff(points, axis=0)
    length2 = np.sum(along**2, axis=1)
    part = np.clip(-np.sum(start * along, axis=1) / np.where(length2 > 0, length2, 1.0), 0.0, 1.0)
    distance = np.linalg.norm(start + part[:, None] * along, axis=1)
    i = int(np.argmin(distance))
    return float(times[i] + part[i] * (times[i + 1] - times[i])), float(distance[i])
