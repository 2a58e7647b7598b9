"""A gentle path for the times at which a target is held anyway: what the arm could follow, not every flick."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gbeam.motion.centrifuge.target.load_limits import OPPOSED, nearest_to_zero
from gbeam.motion.profiles.hann import soft_floor
from gbeam.numerics.intervals import true_runs
from gbeam.numerics.solvers.banded import solve_banded

BAND = 0.1  # of a floor: how softly it sets in

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def without_gaps(times: Floats, held: Flags, shortest: float) -> Flags:
    """Join held runs of knots that less than `shortest` seconds part: so short a visit to the flight's load is none."""
    filled = held.copy()
    runs = true_runs(held)
    for run, following in pairwise(runs):
        if times[following.start] - times[run.stop] < shortest:
            filled[run.stop : following.start] = True
    return filled


def smooth_hold(times: Floats, load: Floats, held: Flags, period: float, idle: float, floor: float) -> Floats:
    """Replace held knots by a path whose direction and size change no faster than the arm can follow.

    Direction and size z each minimise ∫ |z − load's|² + (P/2π)⁶ |z'''|² dt with the knots that are not held fixed:
    changes that take less than the period P are left out, and the path leaves and meets the flight's load without a
    corner. The size stays above `idle`, and the load across the beam above `floor`.

    Parameters
    ----------
    times : array, shape (k,)
        s.
    load : array, shape (k, 3)
        Already held, m/s².
    held : array of bool, shape (k,)
    period : float
        P, s.
    idle, floor : float
        m/s².
    """
    if held.all() or times.size < 5:
        return load
    size = np.linalg.norm(load, axis=1)
    path = _smooth(times, np.column_stack([load / size[:, None], size]), held, period)
    direction = path[:, :3] / np.linalg.norm(path[:, :3], axis=1)[:, None]
    gentle = direction * soft_floor(path[:, 3], idle, BAND * idle)[:, None]
    if floor > 0:
        across = np.linalg.norm(gentle[:, 1:], axis=1)
        gentle[:, 1:] *= (soft_floor(across, floor, BAND * floor) / np.maximum(across, 1e-9))[:, None]
    smooth = np.where(held[:, None], gentle, load)
    # Between steep slopes so smooth a path may overshoot through zero, where the load itself does not go.
    part, least = (slice(1, 3), 2 * OPPOSED * floor) if floor > 0 else (slice(0, 3), 2 * OPPOSED * idle)
    for run in true_runs(held):
        around = slice(max(run.start - 1, 0), run.stop + 1)
        if nearest_to_zero(times[around], smooth[around, part])[1] < least:
            smooth[run] = load[run]
    return smooth


def _smooth(times: Floats, values: Floats, free: Flags, period: float) -> Floats:
    """Minimise the penalised distance over the free knots, columns at once."""
    # Third divided differences on four knots each: 6 f[t0, t1, t2, t3] is the third derivative.
    rows = times.size - 3
    node = np.stack([times[i : rows + i] for i in range(4)], axis=1)
    factors = np.stack(
        [6 / np.prod([node[:, i] - node[:, j] for j in range(4) if j != i], axis=0) for i in range(4)], axis=1
    )
    penalty = (period / (2 * np.pi)) ** 6 * (node[:, 2] - node[:, 1])
    band, width = np.zeros((4, times.size)), np.gradient(times)
    band[0] = width
    for d in range(4):
        for i in range(4 - d):
            band[d, i : i + rows] += penalty * factors[:, i] * factors[:, i + d]
    # The other knots keep their values: their rows become those of the unit matrix.
    right = np.where(free[:, None], width[:, None] * values, values)
    for d in range(1, 4):
        above, below = slice(0, times.size - d), slice(d, times.size)
        coupling = band[d, above]
        right[below] -= np.where(free[below] & ~free[above], coupling, 0.0)[:, None] * values[above]
        right[above] -= np.where(free[above] & ~free[below], coupling, 0.0)[:, None] * values[below]
        band[d, above] = np.where(free[above] & free[below], coupling, 0.0)
    band[0, ~free] = 1.0
    return solve_banded(band, right)
