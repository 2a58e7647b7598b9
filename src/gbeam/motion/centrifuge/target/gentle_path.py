"""The direction of a load while it is not the flight's: near the flight's, and gentle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.numerics.samples import true_runs

_DIRECTED = 0.2  # of what counts as a whole load: below, the angle about the beam is not looked at
_POLE = 0.05  # rad from the beam: nearer to it the angle about it would run away
_LEAST_WEIGHT = 1e-3  # of values without a direction: what keeps the path in one piece between them
_CARRIED = 0.2  # rad: how far a slope beside the path may carry it away
_WIDENING = 0.3  # s per s: how its time scale grows from there

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def unwrapped(times: Floats, y: Floats, x: Floats, whole: float) -> tuple[Floats, Floats]:
    """Angle atan2(y, x) of a load over time, and how much it counts.

    `times` (k,) s, `y`, `x` (k,) m/s²; returns (k,).
    """
    size = np.hypot(y, x)
    directed = size >= _DIRECTED * whole
    if not directed.any():
        return np.full(times.size, np.pi / 2), np.zeros(times.size)
    angle = np.unwrap(np.arctan2(y[directed], x[directed]))
    return np.interp(times, times[directed], angle), np.where(directed, np.minimum(size / whole, 1.0), 0.0)


def off_axis(angle: Floats) -> Floats:
    """Angles from the beam, rad, kept away from its axis."""
    return np.clip(angle, _POLE, np.pi - _POLE)


def gentle(times: Floats, values: Floats, weight: Floats, fixed: Flags, time_scale: float) -> Floats:
    """Replace the values that are not fixed by a path near them.

    It minimises ∫ w (z − values)² + T⁴ z''² dt with the fixed values kept, so that it leaves and meets them without a
    corner; changes quicker than a period of 2πT are left out. T is `time_scale`, less beside fixed values that change
    so quickly that the path would be carried far away before it turns.

    `times` (k,), `values`, `weight` (k,), `fixed` (k,).
    """
    if fixed.all() or times.size < 4:
        return values
    from scipy.linalg import solveh_banded  # imported when a path is sought

    left, right = np.diff(times)[:-1], np.diff(times)[1:]
    penalty = _time_scales(times, values, fixed, time_scale)[1:-1] ** 4 * (left + right) / 2
    second = 2 * np.stack([1 / (left * (left + right)), -1 / (left * right), 1 / (right * (left + right))])
    rows = times.size - 2
    bend = penalty * sum(second[i] * values[i : i + rows] for i in range(3))
    band, side = np.zeros((3, times.size)), np.zeros(times.size)
    band[0] = np.gradient(times) * np.maximum(weight, _LEAST_WEIGHT)
    for i in range(3):
        side[i : i + rows] -= second[i] * bend
        for d in range(3 - i):
            band[d, i : i + rows] += penalty * second[i] * second[i + d]
    # What is solved for is the distance from the values: where it is none, its rows are those of the unit matrix.
    for d in (1, 2):
        band[d, : times.size - d] *= ~(fixed[: times.size - d] | fixed[d:])
    band[0, fixed], side[fixed] = 1.0, 0.0
    return np.asarray(values + solveh_banded(band, side, lower=True))


def _time_scales(times: Floats, values: Floats, fixed: Flags, longest: float) -> Floats:
    """T at every knot: from a slope v beside it a path goes on by about v T."""
    scale = np.full(times.size, longest)
    for run in true_runs(~fixed):
        for edge, inward in ((run.start - 1, -1), (run.stop, 1)):
            beyond = edge + inward
            if min(edge, beyond) < 0 or max(edge, beyond) >= times.size:
                continue
            slope = abs((values[beyond] - values[edge]) / (times[beyond] - times[edge]))
            nearest = _CARRIED / max(slope, _CARRIED / longest) + _WIDENING * np.abs(times[run] - times[edge])
            scale[run] = np.minimum(scale[run], nearest)
    return scale
