"""Largest values of sampled histories between their samples.

Near a sample i two things say how a history goes on until its neighbours: the quintic Hermite polynomials of the two
steps, where the first and second derivatives are known, or the polynomial of sixth degree through the seven nearest
samples, where they are not. Both are evaluated at a few times only, next to those samples that may win.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FEWEST = 7  # samples that the polynomial without derivatives needs
_PER_STEP = 8  # subdivisions; the vertex of a parabola through three of them is the peak
_COUNT = 128  # windows at most per history
_STRAIGHT = 1e-150  # of a second derivative: less is none
_SMOOTH = 0.25  # degree 6 may change degree 4 by this share of what that changed degree 2; corners and jumps: 0.35
_SHARES = np.arange(_PER_STEP + 1) / _PER_STEP
# Hermite's polynomials of fifth degree there: of value, first and second derivative at either end.
_QUINTIC = np.stack(
    [
        1 - _SHARES**3 * (10 - 15 * _SHARES + 6 * _SHARES**2),
        _SHARES - _SHARES**3 * (6 - 8 * _SHARES + 3 * _SHARES**2),
        _SHARES**2 * (1 - 3 * _SHARES + 3 * _SHARES**2 - _SHARES**3) / 2,
        _SHARES**3 * (10 - 15 * _SHARES + 6 * _SHARES**2),
        -(_SHARES**3) * (4 - 7 * _SHARES + 3 * _SHARES**2),
        _SHARES**3 * (1 - 2 * _SHARES + _SHARES**2) / 2,
    ],
    axis=1,
)


def near_maxima(time: Floats, values: Floats) -> Indices:
    """Samples next to which a largest value may lie: local maxima whose parabola's vertex comes near the highest.

    `time` (t,), `values` (t, k); returns (u,).
    """
    count = len(time)
    if count < 3:
        return np.empty(0, dtype=np.intp)
    values = values.reshape(-1, *values.shape[-2:])
    turning = (values[:, 1:-1] > values[:, :-2]) & (values[:, 1:-1] >= values[:, 2:])
    turning[:, [0, -1]] = True
    run, row, column = np.nonzero(turning)
    around = row + np.arange(3)[:, None]
    _, height = _vertex(time[around], values[run, around, column])
    of = run * values.shape[2] + column  # which history
    gain, highest = np.zeros(len(values) * values.shape[2]), np.full(len(values) * values.shape[2], -np.inf)
    np.maximum.at(gain, of, height - values[run, row + 1, column])
    np.maximum.at(highest, of, height)
    near = height >= highest[of] - 0.5 * gain[of]
    of, place, height = of[near], (run * count + row + 1)[near], height[near]
    if len(of) > _COUNT:  # the highest of each
        order = np.lexsort((-height, of))
        of, place = of[order], place[order]
        place = place[np.arange(len(of)) - np.searchsorted(of, np.arange(len(gain)))[of] < _COUNT]
    chosen = np.zeros(len(values) * count, dtype=bool)
    chosen[place] = True
    return np.flatnonzero(chosen)


def maxima(
    time: Floats, values: Floats, t: Floats, between: Floats, at: Indices | None = None
) -> tuple[Floats, Floats]:
    """Largest value of each history, and its time, between samples where it lies there.

    `time` (t,), `values` (t, k), `t`, `between` (u, p), `at` (u,); returns `value`, `time` (k,).
    """
    first, columns = values.argmax(axis=-2), np.arange(values.shape[-1])
    largest, when = np.take_along_axis(values, first[..., None, :], axis=-2)[..., 0, :], time[first]
    if not len(between):
        return largest, when
    starts = np.zeros(1, dtype=np.intp) if at is None else np.searchsorted(at, len(time) * np.arange(len(values)))
    best = [part.reshape(-1, len(columns)).argmax(axis=0) for part in np.split(between, starts[1:])]
    window, place = np.divmod(np.reshape(best, first.shape), between.shape[1])
    window = window + starts.reshape(-1, *[1] * (values.ndim - 2))
    around = np.clip(place, 1, between.shape[1] - 2) + np.arange(-1, 2).reshape(-1, *[1] * place.ndim)
    vertex, value = _vertex(t[window, around], between[window, around, columns])
    better = value > largest
    return np.where(better, value, largest), np.where(better, vertex, when)


def turning_points(time: Floats, values: Floats) -> Floats:
    """First value, local extremes between samples, and last value of one history (t,), in order of time, (e,)."""
    slope = np.sign(np.diff(values))
    moving = np.flatnonzero(slope)
    turns = moving[1:][slope[moving[1:]] != slope[moving[:-1]]]
    ends = values[[0, -1]]
    if len(values) < FEWEST or not turns.size:
        return np.concatenate([ends[:1], values[turns], ends[1:]])
    up = -slope[turns]  # +1 at a maximum
    t, y = seven_point(time, values[:, None], turns)
    y = y[..., 0] * up[:, None]
    rows = np.arange(len(turns))
    around = np.clip(y.argmax(axis=1), 1, y.shape[1] - 2) + np.arange(-1, 2)[:, None]
    _, value = _vertex(t[rows, around], y[rows, around])
    return np.concatenate([ends[:1], up * np.maximum(value, up * values[turns]), ends[1:]])


def quintic_hermite(time: Floats, q: Floats, qd: Floats, qdd: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Histories in the two steps about samples, from their values and first and second derivatives.

    `time` (t,), `q`, `qd`, `qdd` (t, n), `at` (u,); returns `time` (u, p), `q` (u, p, n).
    """
    count, within = int(np.prod(q.shape[:-1])), at % len(time)
    history = np.stack([q, qd, qdd], axis=-2).reshape(count, 3, q.shape[-1])

    def step(shift: int) -> Floats:
        j = within + shift
        scale = (time[j + 1] - time[j])[:, None, None] ** np.arange(3)[:, None]
        both = np.concatenate([scale * history[at + shift], scale * history[at + shift + 1]], axis=1)
        return np.asarray(_QUINTIC @ both)

    return _subdivided(time, within), np.concatenate([step(-1), step(0)[:, 1:]], axis=1)


def seven_point(time: Floats, values: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Histories in the two steps about samples, from their values alone.

    `time` (t,), `values` (t, c), `at` (u,); returns `time` (u, p).
    """
    if len(time) < FEWEST:
        at = at[:0]
    t, n = _subdivided(time, at), max(len(time), FEWEST)
    high, low, parabola = (
        _lagrange(time[k], t) @ values[k]
        for m in (7, 5, 3)
        for k in [np.clip(at - m // 2, 0, n - m)[:, None] + np.arange(m)]
    )
    sampled = values[at][:, None]
    left = np.abs(high - low).max(axis=1, keepdims=True)
    rough = left > np.maximum(_SMOOTH * np.abs(low - parabola).max(axis=1, keepdims=True), 1e-9 * np.abs(sampled))
    return t, np.where(rough, sampled, high)


def _subdivided(time: Floats, at: Indices) -> Floats:
    """Times of the two steps about samples, (u, p)."""
    before, centre, after = time[at - 1][:, None], time[at][:, None], time[at + 1][:, None]
    return np.concatenate([before + _SHARES * (centre - before), centre + _SHARES[1:] * (after - centre)], axis=1)


def _lagrange(nodes: Floats, t: Floats) -> Floats:
    """Lagrange's basis of nodes (u, m) at times (u, p), (u, p, m)."""
    m = nodes.shape[1]
    apart = nodes[:, :, None] - nodes[:, None, :] + np.eye(m) * (nodes[:, -1:] - nodes[:, :1])[..., None]
    scale = (nodes[:, -1:] - nodes[:, :1])[..., None]
    away = (t[:, :, None] - nodes[:, None, :]) / scale
    weight = 1 / np.prod(apart / scale, axis=2)
    ones = np.ones((*away.shape[:2], 1))
    left = np.concatenate([ones, np.cumprod(away[..., :-1], axis=2)], axis=2)
    right = np.concatenate([ones, np.cumprod(away[..., :0:-1], axis=2)], axis=2)[..., ::-1]
    return np.asarray(left * right * weight[:, None, :])


def _vertex(t: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Time and value of the maximum between three points (3, ...) of the parabola through them."""
    before, after = (y[1] - y[0]) / (t[1] - t[0]), (y[2] - y[1]) / (t[2] - t[1])
    bend = (after - before) / (t[2] - t[0])
    slope = before + bend * (t[1] - t[0])
    curved = bend < -_STRAIGHT
    shift = slope / np.where(curved, -2 * bend, 1.0)
    inside = curved & (shift > t[0] - t[1]) & (shift < t[2] - t[1])
    shift = np.where(inside, shift, 0.0)
    sample = np.where(y[1] >= np.maximum(y[0], y[2]), t[1], np.where(y[0] >= y[2], t[0], t[2]))
    value = y[1] + shift * (slope + bend * shift)
    return np.where(inside, t[1] + shift, sample), np.where(inside, value, y.max(axis=0))
