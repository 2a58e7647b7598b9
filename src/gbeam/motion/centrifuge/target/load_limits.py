"""Where a centrifuge cannot follow: loads below idle, and loads across the beam that gravity alone exceeds.

All on knots, when a target is built; vectors in base axes, m/s².
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.motion.bases.conditioning import STANDARD_GRAVITY
from gbeam.motion.profiles.hann import soft_floor

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

IDLE_BAND = 0.1  # of idle: how softly the hold sets in
UNTOUCHED = 1 + IDLE_BAND / 2  # times idle: a larger load is not raised
UNDIRECTED = 0.05  # of idle: a smaller load has no direction worth following
MIN_TRANSVERSE_LOAD = 1.05 * STANDARD_GRAVITY  # least load across the beam that the gimbals make where gravity acts
OPPOSED = 0.1  # two unit vectors whose chord passes this near to zero count as opposite


def hold_idle(times: Floats, load: Floats, idle: float) -> tuple[Floats, Flags]:
    """Raise loads below `idle` to it, keeping their direction.

    Parameters
    ----------
    times : array, shape (k,)
        s.
    load : array, shape (k, 3)
    idle : float
        m/s².

    Returns
    -------
    tuple of array (k, 3) and of bool (k,)
        The held load, and which knots differ from `load`.

    Raises
    ------
    InputError
        If no knot has a direction, or a load too small to have one lies between opposite ones.
    """
    size = np.linalg.norm(load, axis=1)
    directed = size >= UNDIRECTED * idle
    if not directed.any():
        raise InputError(
            "tracks",
            f"stays below {UNDIRECTED * idle / STANDARD_GRAVITY:.2g} g, too little to have a direction",
            "track a motion with a load, or lower idle",
        )
    unit = load / np.where(directed, size, 1.0)[:, None]
    filled = _between(times, unit, directed)
    refuse_reversal(times, filled, OPPOSED)
    direction = filled / np.linalg.norm(filled, axis=1)[:, None]
    held = np.asarray(soft_floor(size, idle, IDLE_BAND * idle))
    altered = (held - size > 1e-9 * idle) | ~directed
    return np.where(altered[:, None], held[:, None] * direction, load), altered


def keep_in_reach(times: Floats, load: Floats) -> tuple[Floats, Flags]:
    """Replace loads across the beam that the gimbals cannot make where gravity acts.

    The beam stays horizontal, so that gravity always acts across it: no attitude gives less than one g
    there, and near one g the gimbals would have to turn infinitely fast. Such knots get the straight line
    between the reachable ones either side, pushed out to `MIN_TRANSVERSE_LOAD` where it cuts below; the component along
    the beam is kept.

    Returns
    -------
    tuple of array (k, 3) and of bool (k,)

    Raises
    ------
    InputError
        If no knot can be reached, or the load across the beam reverses through zero.
    """
    across = load[:, 1:]
    reachable = np.linalg.norm(across, axis=1) >= MIN_TRANSVERSE_LOAD
    if not reachable.any():
        raise InputError(
            "tracks",
            f"never loads the beam across by {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g, and gravity alone is 1 g",
            'set idle = "1.4 g" or more, or gravity = false',
        )
    bridged = _between(times, across, reachable)
    refuse_reversal(times, bridged, OPPOSED * STANDARD_GRAVITY)
    size = np.linalg.norm(bridged, axis=1)
    pushed = bridged * (np.maximum(size, MIN_TRANSVERSE_LOAD) / size)[:, None]
    return np.where(reachable[:, None], load, np.column_stack([load[:, 0], pushed])), ~reachable


def refuse_far(times: Floats, load: Floats, far: Flags) -> None:
    """Raise InputError: the load leaves the gimbals' reach, and a held one was not allowed."""
    across = np.linalg.norm(load[:, 1:], axis=1) / STANDARD_GRAVITY
    worst = int(np.argmin(across))
    wrong = np.flatnonzero(far)
    raise InputError(
        "tracks",
        f"loads the beam across by {across[worst]:.3g} g only at {times[worst]:.3f} s; where gravity acts the gimbals "
        f"reach {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g or more (out of reach from {times[wrong[0]]:.3f} s, "
        f"last at {times[wrong[-1]]:.3f} s)",
        'set idle = "1.4 g", or clip = true to carry on with a held target there, '
        f"or add {missing_across(across[worst] * STANDARD_GRAVITY)} across the beam",
    )


def missing_across(load: float) -> str:
    """What a load across the beam, m/s², lacks to be in reach; rounded up, so that adding it does."""
    return f"{np.ceil(100 * (MIN_TRANSVERSE_LOAD - load) / STANDARD_GRAVITY - 1e-6) / 100:g} g"


def refuse_reversal(times: Floats, points: Floats, least: float) -> None:
    """Raise InputError if the polyline through `points` (k, n) at `times` passes within `least` of zero."""
    when, distance = nearest_to_zero(times, points)
    if distance < least:
        raise InputError(
            "tracks",
            f"reverses its load through zero at {when:.3f} s",
            "a centrifuge must carry the specimen round and cannot do so at once: "
            "track a part of the motion before or after, or add a steady load",
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


def _between(times: Floats, values: Floats, known: Flags) -> Floats:
    """Values at the known knots, straight lines between, constant before the first and after the last."""
    return np.stack([np.interp(times, times[known], column[known]) for column in values.T], axis=1)
