"""Largest values of histories between their samples.

Between a sample and its neighbours a history is interpolated: by quintic Hermite polynomials where first and second
derivatives are known, otherwise by the polynomial of sixth degree through the seven nearest samples. Both are evaluated
next to those samples only that may be the largest. A coordinate that vibrates within its steps is interpolated
linearly: its derivatives say nothing of the values between samples.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices

FEWEST = 7  # samples that the polynomial without derivatives needs
_PER_STEP = 8  # subdivisions; the vertex of a parabola through three of them is the peak
_COUNT = 128  # windows at most per history
_STRAIGHT = 1e-150  # of a second derivative: less is none
_SMOOTH = 0.25  # degree 6 may change degree 4 by this share of what that changed degree 2; corners and jumps: 0.35
_RESOLVED = 0.5  # share of the squared changes that their difference may have; reached at 2.6 steps a period
WIDE = 6  # columns of a history
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
    """Indices (u,) of samples beside which the largest value of a history (t, k) may lie, at local maxima; of runs
    (b, t, k) they count through all runs. A maximum is left out if its parabola stays well below the highest.
    """
    count = len(time)
    if count < 3:
        return np.empty(0, dtype=np.intp)
    values = values.reshape(-1, *values.shape[-2:])
    peaked = (values[:, 1:-1] > values[:, :-2]) & (values[:, 1:-1] >= values[:, 2:])
    peaked[:, [0, -1]] = True
    run, row, column = np.nonzero(peaked)
    neighbours = row + np.arange(3)[:, None]
    _, height = _vertex(time[neighbours], values[run, neighbours, column])
    history = run * values.shape[2] + column
    gain, highest = np.zeros(len(values) * values.shape[2]), np.full(len(values) * values.shape[2], -np.inf)
    np.maximum.at(gain, history, height - values[run, row + 1, column])
    np.maximum.at(highest, history, height)
    is_near = height >= highest[history] - 0.5 * gain[history]
    history, place, height = history[is_near], (run * count + row + 1)[is_near], height[is_near]
    if len(history) > _COUNT:  # keep the highest of each history
        order = np.lexsort((-height, history))
        history, place = history[order], place[order]
        place = place[np.arange(len(history)) - np.searchsorted(history, np.arange(len(gain)))[history] < _COUNT]
    chosen = np.zeros(len(values) * count, dtype=bool)
    chosen[place] = True
    return np.flatnonzero(chosen)


def maxima(
    time: Floats, values: Floats, t: Floats, refined: Floats, samples: Indices | None = None
) -> tuple[Floats, Floats]:
    """Largest value of each history (t, k), or (b, t, k) of runs, and its time.

    The `refined` values are those at times t (u, p) beside `samples` (u,). These belong to all histories, or to those
    of a run.
    """
    first, columns = values.argmax(axis=-2), np.arange(values.shape[-1])
    largest, peak_time = np.take_along_axis(values, first[..., None, :], axis=-2)[..., 0, :], time[first]
    if not len(refined):
        return largest, peak_time
    starts = (
        np.zeros(1, dtype=np.intp) if samples is None else np.searchsorted(samples, len(time) * np.arange(len(values)))
    )
    best_place = [of_run.reshape(-1, len(columns)).argmax(axis=0) for of_run in np.split(refined, starts[1:])]
    window, place = np.divmod(np.reshape(best_place, first.shape), refined.shape[1])
    window = window + starts.reshape(-1, *[1] * (values.ndim - 2))
    neighbours = np.clip(place, 1, refined.shape[1] - 2) + np.arange(-1, 2).reshape(-1, *[1] * place.ndim)
    vertex, value = _vertex(t[window, neighbours], refined[window, neighbours, columns])
    is_larger = value > largest
    return np.where(is_larger, value, largest), np.where(is_larger, vertex, peak_time)


def turning_points(time: Floats, values: Floats) -> Floats:
    """First value, local extremes between samples and last value (e,) of one history (t,), in order of time."""
    slope = np.sign(np.diff(values))
    changes = np.flatnonzero(slope)
    turns = changes[1:][slope[changes[1:]] != slope[changes[:-1]]]
    ends = values[[0, -1]]
    if len(values) < FEWEST or not turns.size:
        return np.concatenate([ends[:1], values[turns], ends[1:]])
    sign = -slope[turns]  # +1 at a maximum
    t, y = seven_point(time, values[:, None], turns)
    y = y[..., 0] * sign[:, None]
    rows = np.arange(len(turns))
    neighbours = np.clip(y.argmax(axis=1), 1, y.shape[1] - 2) + np.arange(-1, 2)[:, None]
    _, value = _vertex(t[rows, neighbours], y[rows, neighbours])
    return np.concatenate([ends[:1], sign * np.maximum(value, sign * values[turns]), ends[1:]])


def quintic_hermite(time: Floats, q: Floats, qd: Floats, qdd: Floats, samples: Indices) -> tuple[Floats, Floats]:
    """Times (u, p) and q (u, p, n) in the two steps beside each of the `samples` (u,).

    They follow from values and derivatives (t, n) or, of runs, (b, t, n).
    """
    count, sample = int(np.prod(q.shape[:-1])), samples % len(time)
    history = np.stack([q, qd, qdd], axis=-2).reshape(count, 3, q.shape[-1])
    resolved = np.reshape(_resolved(time, q, qd), (count // len(time), 1, q.shape[-1]))[samples // len(time)]

    def step(shift: int) -> Floats:
        j = sample + shift
        scale = (time[j + 1] - time[j])[:, None, None] ** np.arange(3)[:, None]
        before, after = history[samples + shift], history[samples + shift + 1]
        straight = before[:, :1] + _SHARES[:, None] * (after - before)[:, :1]
        return np.where(resolved, _QUINTIC @ np.concatenate([scale * before, scale * after], axis=1), straight)

    return _subdivided(time, sample), np.concatenate([step(-1), step(0)[:, 1:]], axis=1)


def _resolved(time: Floats, q: Floats, qd: Floats) -> Any:
    """Flags (..., n) of coordinates (..., t, n) that the steps resolve: their displacements over two steps change about
    as their velocities predict.
    """
    change = np.diff(q[..., 2:, :] - q[..., :-2, :], axis=-2)
    predicted = np.diff((time[2:] - time[:-2])[:, None] * qd[..., 1:-1, :], axis=-2)
    squares = np.einsum("...tn,...tn->...n", change, change) + np.einsum("...tn,...tn->...n", predicted, predicted)
    # Σ(c − p)² <= r (Σc² + Σp²), with the square multiplied out.
    return (1 - _RESOLVED) * squares <= 2 * np.einsum("...tn,...tn->...n", change, predicted)


def seven_point(time: Floats, values: Floats, samples: Indices) -> tuple[Floats, Floats]:
    """Times (u, p) and values (u, p, c) in the two steps beside each of the `samples` (u,).

    They follow from values (t, c) alone, or (b, t, c) of runs, through all of which samples count. Where the polynomial
    of sixth degree does not converge, as at a jump, the sample stands for all.
    """
    if len(time) < FEWEST:
        samples = samples[:0]
    run, sample = np.divmod(samples, len(time))
    sample, window = np.unique(sample, return_inverse=True)  # runs that peak at one time share its polynomials
    t, n, values = _subdivided(time, sample), max(len(time), FEWEST), values.reshape(-1, values.shape[-1])

    def polynomial(m: int) -> Floats:
        """Values (u, p, c) of the polynomials through the m nearest samples."""
        nearest = np.clip(sample - m // 2, 0, n - m)[:, None] + np.arange(m)
        return _lagrange(time[nearest], t)[window] @ values[run[:, None] * len(time) + nearest[window]]

    high, low, parabola = polynomial(7), polynomial(5), polynomial(3)
    sampled = values[samples][:, None]
    change = np.abs(high - low).max(axis=1, keepdims=True)
    rough = change > np.maximum(_SMOOTH * np.abs(low - parabola).max(axis=1, keepdims=True), 1e-9 * np.abs(sampled))
    return t[window], np.where(rough, sampled, high)


def _subdivided(time: Floats, samples: Indices) -> Floats:
    """Evenly spaced times (u, p) in the two steps beside each of the `samples` (u,)."""
    before, centre, after = time[samples - 1][:, None], time[samples][:, None], time[samples + 1][:, None]
    return np.concatenate([before + _SHARES * (centre - before), centre + _SHARES[1:] * (after - centre)], axis=1)


def _lagrange(nodes: Floats, t: Floats) -> Floats:
    """Values (u, p, m) at times (u, p) of Lagrange's basis polynomials of nodes (u, m)."""
    m = nodes.shape[1]
    scale = (nodes[:, -1:] - nodes[:, :1])[..., None]
    apart = nodes[:, :, None] - nodes[:, None, :] + np.eye(m) * scale  # a factor of 1 on the diagonal
    away = (t[:, :, None] - nodes[:, None, :]) / scale
    weight = 1 / np.prod(apart / scale, axis=2)
    ones = np.ones((*away.shape[:2], 1))
    # Products of the factors before each node, and of those after it.
    left = np.concatenate([ones, np.cumprod(away[..., :-1], axis=2)], axis=2)
    right = np.concatenate([ones, np.cumprod(away[..., :0:-1], axis=2)], axis=2)[..., ::-1]
    return np.asarray(left * right * weight[:, None, :])


def _vertex(t: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Time and value of the vertex of the parabola through three points (3, ...), or of their largest if the vertex is
    no maximum between them.
    """
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


def vector_peaks(time: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Largest sizes of components and length of vectors (..., t, 3), (..., 4), and their times, between samples."""
    return _measured(time, vectors, lambda vectors: sizes(vectors[..., None, :]))


def length_peaks(time: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Largest lengths (...) of vectors (..., t, 3), and their times, between samples."""
    value, peak_time = _measured(time, vectors, lambda vectors: np.sqrt((vectors**2).sum(axis=-1, keepdims=True)))
    return value[..., 0], peak_time[..., 0]


def _measured(time: Floats, histories: Floats, measure: Callable[[Floats], Floats]) -> tuple[Floats, Floats]:
    """Largest values (..., m) of m measures of histories (..., t, c), and their times, between samples."""
    runs = histories.reshape(-1, *histories.shape[-2:])
    values = measure(runs)
    samples = near_maxima(time, values)
    t, refined = seven_point(time, runs, samples)
    value, peak_time = maxima(time, values, t, measure(refined), samples)
    shape = *histories.shape[:-2], values.shape[-1]
    return value.reshape(shape), peak_time.reshape(shape)


def sizes(vectors: Floats) -> Floats:
    """Sizes (..., 4 g) of the three components and the length of each of g vectors (..., g, 3)."""
    length = np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    columns = np.concatenate([np.abs(vectors), length], axis=-1)
    return columns.reshape(*columns.shape[:-2], 4 * vectors.shape[-2])


def column_peaks(time: Floats, columns: Floats) -> tuple[Floats, Floats]:
    """Largest values (k,) of histories (t, k), each looked at by itself, and their times, between samples."""
    value, peak_time = _measured(time, np.ascontiguousarray(columns.T)[..., None], lambda values: values)
    return value[:, 0], peak_time[:, 0]


def extremes(time: Floats, values: Floats) -> Floats:
    """Highest values (k,) between the samples of a history (t,); or the highest and lowest of columns (t, c), and the
    largest length of a row.
    """
    return _window_extremes(time, values[None])


def signed_columns(values: Floats) -> Floats:
    """Columns (..., t, 2 c + 1) of values (..., t, c): with both signs, and the lengths of rows."""
    return np.concatenate([values, -values, np.sqrt((values**2).sum(axis=-1, keepdims=True))], axis=-1)


def _window_extremes(time: Floats, values: Floats) -> Floats:
    """Highest values (k,), as of :func:`extremes`, of a history in windows (w, t, ...) that have their times alike."""
    columns = values[..., None] if values.ndim == 2 else signed_columns(values)
    columns = columns.reshape(*columns.shape[:2], -1)  # of vectors at several places
    value, _ = _measured(time, np.moveaxis(columns, 2, 0)[..., None], lambda values: values)
    return np.asarray(value[..., 0].max(axis=1))


def peak_difference(time: Floats, values: Floats, other_values: Floats) -> float:
    """Largest difference of the highest and lowest values of two histories (t,) or (t, c), whenever each is reached.

    Of histories with more columns than vectors have, only columns that reach half of the largest value count.
    """
    return largest_peak_difference(time, values[None], other_values[None])


def largest_peak_difference(time: Floats, values: Floats, other_values: Floats) -> float:
    """Largest :func:`peak_difference` of histories in windows (w, t, ...) that have their times alike."""
    if values.ndim == 3 and values.shape[2] > WIDE:
        largest = np.abs(values).max(axis=(0, 1))
        large = largest >= largest.max() / 2
        values, other_values = values[..., large], other_values[..., large]
    return float(np.abs(_window_extremes(time, values) - _window_extremes(time, other_values)).max())
