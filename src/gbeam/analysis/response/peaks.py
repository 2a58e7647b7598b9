"""Peaks between the steps of a history: of any samples, and of a response's displacement and section loads.

Between a sample and its neighbours a history is interpolated: by quintic Hermite polynomials where first and second
derivatives are known, otherwise by the polynomial of sixth degree through the seven nearest samples. Both are evaluated
next to those samples only that may be the largest. A coordinate that vibrates within its steps is interpolated
linearly: its derivatives say nothing of the values between samples.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.types import Floats, Indices
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.results.parts import Extremes, LoadPeaks, Loads, Peaks, VectorPeaks
from gbeam.results.system import SystemPeaks

FEWEST = 7  # samples that the polynomial without derivatives needs
_PER_STEP = 8  # subdivisions; the vertex of a parabola through three of them is the peak
_COUNT = 128  # windows at most per history
_STRAIGHT = 1e-150  # of a second derivative: less is none
_SMOOTH = 0.25  # degree 6 may change degree 4 by this share of what that changed degree 2; corners and jumps: 0.35
_RESOLVED = 0.5  # share of the squared changes that their difference may have; reached at 2.6 steps a period
_ROUNDING = 1e-16  # of the places: a displacement that is less is none
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
    around = row + np.arange(3)[:, None]
    _, height = _vertex(time[around], values[run, around, column])
    history = run * values.shape[2] + column
    gain, highest = np.zeros(len(values) * values.shape[2]), np.full(len(values) * values.shape[2], -np.inf)
    np.maximum.at(gain, history, height - values[run, row + 1, column])
    np.maximum.at(highest, history, height)
    near = height >= highest[history] - 0.5 * gain[history]
    history, place, height = history[near], (run * count + row + 1)[near], height[near]
    if len(history) > _COUNT:  # keep the highest of each history
        order = np.lexsort((-height, history))
        history, place = history[order], place[order]
        place = place[np.arange(len(history)) - np.searchsorted(history, np.arange(len(gain)))[history] < _COUNT]
    chosen = np.zeros(len(values) * count, dtype=bool)
    chosen[place] = True
    return np.flatnonzero(chosen)


def maxima(
    time: Floats, values: Floats, t: Floats, between: Floats, at: Indices | None = None
) -> tuple[Floats, Floats]:
    """Largest value of each history (t, k), or (b, t, k) of runs, and its time. `between` are values at times t (u, p)
    beside the samples `at` (u,), which belong to all histories, or to those of a run.
    """
    first, columns = values.argmax(axis=-2), np.arange(values.shape[-1])
    largest, when = np.take_along_axis(values, first[..., None, :], axis=-2)[..., 0, :], time[first]
    if not len(between):
        return largest, when
    starts = np.zeros(1, dtype=np.intp) if at is None else np.searchsorted(at, len(time) * np.arange(len(values)))
    best = [of_run.reshape(-1, len(columns)).argmax(axis=0) for of_run in np.split(between, starts[1:])]
    window, place = np.divmod(np.reshape(best, first.shape), between.shape[1])
    window = window + starts.reshape(-1, *[1] * (values.ndim - 2))
    around = np.clip(place, 1, between.shape[1] - 2) + np.arange(-1, 2).reshape(-1, *[1] * place.ndim)
    vertex, value = _vertex(t[window, around], between[window, around, columns])
    better = value > largest
    return np.where(better, value, largest), np.where(better, vertex, when)


def turning_points(time: Floats, values: Floats) -> Floats:
    """First value, local extremes between samples and last value (e,) of one history (t,), in order of time."""
    slope = np.sign(np.diff(values))
    moving = np.flatnonzero(slope)
    turns = moving[1:][slope[moving[1:]] != slope[moving[:-1]]]
    ends = values[[0, -1]]
    if len(values) < FEWEST or not turns.size:
        return np.concatenate([ends[:1], values[turns], ends[1:]])
    sign = -slope[turns]  # +1 at a maximum
    t, y = seven_point(time, values[:, None], turns)
    y = y[..., 0] * sign[:, None]
    rows = np.arange(len(turns))
    around = np.clip(y.argmax(axis=1), 1, y.shape[1] - 2) + np.arange(-1, 2)[:, None]
    _, value = _vertex(t[rows, around], y[rows, around])
    return np.concatenate([ends[:1], sign * np.maximum(value, sign * values[turns]), ends[1:]])


def quintic_hermite(time: Floats, q: Floats, qd: Floats, qdd: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Times (u, p) and q (u, p, n) in the two steps beside samples `at` (u,), by values and derivatives (t, n) or, of
    runs, (b, t, n).
    """
    count, sample = int(np.prod(q.shape[:-1])), at % len(time)
    history = np.stack([q, qd, qdd], axis=-2).reshape(count, 3, q.shape[-1])
    resolved = np.reshape(_resolved(time, q, qd), (count // len(time), 1, q.shape[-1]))[at // len(time)]

    def step(shift: int) -> Floats:
        j = sample + shift
        scale = (time[j + 1] - time[j])[:, None, None] ** np.arange(3)[:, None]
        before, after = history[at + shift], history[at + shift + 1]
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


def seven_point(time: Floats, values: Floats, at: Indices) -> tuple[Floats, Floats]:
    """Times (u, p) and values (u, p, c) in the two steps beside samples `at` (u,), from values (t, c) alone. Where the
    polynomial of sixth degree does not converge, as at a jump, the sample stands for all.
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
    change = np.abs(high - low).max(axis=1, keepdims=True)
    rough = change > np.maximum(_SMOOTH * np.abs(low - parabola).max(axis=1, keepdims=True), 1e-9 * np.abs(sampled))
    return t, np.where(rough, sampled, high)


def _subdivided(time: Floats, at: Indices) -> Floats:
    """Evenly spaced times (u, p) in the two steps beside samples `at` (u,)."""
    before, centre, after = time[at - 1][:, None], time[at][:, None], time[at + 1][:, None]
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


def displacement_peaks(
    structure: Structure, trajectories: Sequence[Trajectory], first: int, moved: Any, residual_from: float | None
) -> list[Peaks]:
    """Peaks of the displacement in each trajectory, from samples `moved` (b, t, s, 3) m and, between steps, the model
    at quintic Hermite polynomials of q; where JAX traces it, the tip's largest samples.
    """
    time = trajectories[0].time
    start = 0 if residual_from is None else int(np.searchsorted(time, residual_from))
    late = residual_from is not None and start < len(time) - 1
    if is_jax(moved):
        return [_samples(time, run[:, -1], start if late else None) for run in moved]
    q, qd = (np.stack([getattr(run, name) for run in trajectories]) for name in ("q", "qd"))

    def largest(begin: int, measure: Callable[[Floats], Floats]) -> tuple[Floats, Floats]:
        """Peaks from a step on, and their times, of a measure of displacements (..., s, 3)."""
        values = measure(moved[:, begin:])
        chosen = near_maxima(time[begin:], values)
        run, sample = np.divmod(chosen, len(time) - begin)
        qdd = np.stack([_beside(each, begin + sample[run == k]) for k, each in enumerate(trajectories)])
        part = np.s_[:, begin:, first:]
        t, y = quintic_hermite(time[begin:], q[part], qd[part], qdd[part], chosen)
        return maxima(time[begin:], values, t, measure(np.asarray(structure.displacement(y))), chosen)

    stations, residual = moved.shape[2], np.full((len(trajectories), 3), np.nan)
    if late:
        highest, _ = largest(start, lambda u: np.concatenate([u[..., -1, :], -u[..., -1, :]], axis=-1))
        residual = (highest[:, :3] + highest[:, 3:]) / 2
    vectors = [_vectors(value, when, stations) for value, when in zip(*largest(0, _sizes), strict=True)]
    return [_of_stations(*run) for run in zip(vectors, residual, strict=True)]


def _beside(trajectory: Trajectory, samples: Indices) -> Floats:
    """Accelerations (t, n) at samples (u,) and their neighbours; NaN elsewhere."""
    qdd, near = np.full(trajectory.q.shape, np.nan), np.unique(samples[:, None] + np.arange(-1, 2))
    qdd[near] = trajectory.at(near).qdd
    return qdd


def _of_stations(stations: VectorPeaks, residual: Floats) -> Peaks:
    """Peaks of a response by those of the displacement at every station, the last of which is the tip."""
    tip = stations[-1]
    return Peaks(
        max_abs=tip.components.value,
        time_of_max=tip.components.time,
        residual_amplitude=residual,
        max_size=float(tip.size.value),
        time_of_max_size=float(tip.size.time),
        displacement=stations,
    )


def _samples(time: Floats, tip: Any, start: int | None) -> Peaks:
    """Peaks of the tip's displacement (t, 3) at samples alone; residual vibration from index `start` on, if any."""
    xp = namespace(tip)
    sizes, times = xp.abs(tip), xp.asarray(time)
    length = xp.sqrt((tip**2).sum(axis=1).max())
    residual = np.full(3, np.nan) if start is None else (tip[start:].max(axis=0) - tip[start:].min(axis=0)) / 2
    when = times[(tip**2).sum(axis=1).argmax()]
    return Peaks(sizes.max(axis=0), times[sizes.argmax(axis=0)], residual, length, when)


def load_peaks(
    loads: Loads, time: Floats, loads_at: Callable[[Indices], Loads | None] | None = None, stride: int = 1
) -> LoadPeaks:
    """Peaks of loads known at every `stride`-th of the times; `loads_at` computes them at others, near peaks."""
    s = loads.section_force.shape[1]
    table, steps = _table(loads), np.arange(0, len(time), stride)

    def measure(table: Floats) -> Floats:
        """Sizes whose maxima are the peaks: of components and lengths of vectors, of stresses and of torque."""
        vectors = table[..., : 6 * s].reshape(*table.shape[:-1], 2 * s, 3)
        return np.concatenate([_sizes(vectors), table[..., 6 * s : 8 * s], np.abs(table[..., 8 * s :])], axis=-1)

    chosen = near_maxima(time[steps], measure(table))
    if loads_at is not None and stride > 1 and chosen.size:
        # Beside the samples that may be the largest, the loads are computed at every step.
        near = steps[chosen][:, None] + np.arange(-stride - FEWEST // 2, stride + FEWEST // 2 + 1)
        new = np.setdiff1d(np.clip(near, 0, len(time) - 1), steps)
        more = loads_at(new)
        assert more is not None
        table, steps = np.concatenate([table, _table(more)]), np.concatenate([steps, new])
        order = np.argsort(steps)
        table, steps = table[order], steps[order]
        chosen = near_maxima(time[steps], measure(table))
        chosen = chosen[steps[chosen + 1] - steps[chosen - 1] == 2]
    t, between = seven_point(time[steps], table, chosen)
    value, when = maxima(time[steps], measure(table), t, measure(between))
    if not np.isfinite(loads.stress_tension).all():
        value[8 * s : 10 * s] = when[8 * s : 10 * s] = np.nan
    vectors, v, w = _vectors(value, when, 2 * s), value[8 * s :], when[8 * s :]
    return LoadPeaks(
        force=vectors[:s],
        moment=vectors[s:],
        tension=Extremes(v[:s], w[:s]),
        compression=Extremes(-v[s : 2 * s], w[s : 2 * s]),
        von_mises=Extremes(v[2 * s : 3 * s], w[2 * s : 3 * s]) if _sheared(loads) else None,
        beam_torque=None if loads.beam_torque is None else Extremes(v[-1], w[-1]),
        stations=loads.stations,
        yield_strength=loads.yield_strength,
    )


def vector_peaks(time: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Largest sizes of components and length of a vector (t, 3), (4,), and their times, between samples."""
    sizes = _sizes(vectors[:, None])
    t, between = seven_point(time, vectors, near_maxima(time, sizes))
    return maxima(time, sizes, t, _sizes(between[:, :, None]))


def system_peaks(system: System, time: Floats, over_time: Mapping[str, Floats]) -> SystemPeaks:
    """Peaks of a system between steps, by the histories of its points, coordinates, efforts and the ground's loads."""

    def of_points(vectors: Floats) -> tuple[Floats, Floats]:
        """Largest lengths (p,) of vectors (t, p, 3), and their times."""
        peaks = np.reshape([vector_peaks(time, each) for each in np.moveaxis(vectors, 1, 0)], (-1, 2, 4))
        return peaks[:, 0, 3], peaks[:, 1, 3]

    def of_columns(values: Floats) -> tuple[Floats, Floats]:
        """Largest values (n,) of histories (t, n), and their times."""
        each = (column[:, None] for column in values.T)
        largest = [maxima(time, one, *seven_point(time, one, near_maxima(time, one))) for one in each]
        value, when = np.reshape(largest, (-1, 2)).T
        return value, when

    def of_ground(key: str) -> VectorPeaks:
        value, when = vector_peaks(time, over_time[key])
        return VectorPeaks(Extremes(value[:3], when[:3]), Extremes(value[3], when[3]))

    place, q = over_time["place"], over_time["q"]
    distance, when = of_points(place - place[0])
    lowest, lowest_time = of_columns(-q)
    return SystemPeaks(
        system.points,
        system.coordinates,
        np.where(distance <= _ROUNDING * np.abs(place).max(initial=0.0), 0.0, distance),
        when,
        *of_points(over_time["velocity"]),
        *of_points(over_time["acceleration"]),
        -lowest,
        lowest_time,
        *of_columns(q),
        *of_columns(np.abs(over_time["qd"])),
        *of_columns(np.abs(over_time["effort"])),
        of_ground("ground_force"),
        of_ground("ground_moment"),
    )


def half_ranges(time: Floats, values: Any, start: float) -> Any:
    """Half of the range (k,) of each history (t, k) from a time on; NaN where there are not two samples."""
    after = time >= start
    if after.sum() < 2:
        return np.full(values.shape[1], np.nan)
    time, values = time[after], values[after]
    if is_jax(values):
        return (values.max(axis=0) - values.min(axis=0)) / 2
    signed = np.concatenate([values, -values], axis=1)
    t, between = seven_point(time, values, near_maxima(time, signed))
    value, _ = maxima(time, signed, t, np.concatenate([between, -between], axis=2))
    return value.reshape(2, -1).sum(axis=0) / 2


def peaks_of_coordinates(trajectory: Trajectory, vectors: Floats, of: Callable[[Floats], Floats]) -> Floats:
    """Largest sizes (4,) of components and length of a vector `of` q, of which the samples are `vectors` (t, 3)."""
    time, sizes = trajectory.time, _sizes(vectors[:, None])
    near = near_maxima(time, sizes)
    t, q = quintic_hermite(time, trajectory.q, trajectory.qd, _beside(trajectory, near), near)
    value, _ = maxima(time, sizes, t, _sizes(of(q)[:, :, None]))
    return value


def _table(loads: Loads) -> Floats:
    """Columns (t, c) of loads: forces, moments, tension, compression, von Mises stress and torque on a hub if known."""
    torque = [] if loads.beam_torque is None else [loads.beam_torque[:, None]]
    vectors = (x.reshape(len(x), -1) for x in (loads.section_force, loads.section_moment))
    stresses = (np.nan_to_num(x) for x in (loads.stress_tension, -loads.stress_compression))
    sheared = [np.asarray(loads.von_mises)] if _sheared(loads) else []
    return np.concatenate([*vectors, *stresses, *sheared, *torque], axis=1)


def _sheared(loads: Loads) -> bool:
    """True if von Mises' stress is known."""
    return loads.von_mises is not None and bool(np.isfinite(loads.von_mises).all())


def _sizes(vectors: Floats) -> Floats:
    """Sizes (..., 4 g) of the three components and the length of each of g vectors (..., g, 3)."""
    length = np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    sizes = np.concatenate([np.abs(vectors), length], axis=-1)
    return sizes.reshape(*sizes.shape[:-2], 4 * vectors.shape[-2])


def _vectors(value: Floats, when: Floats, count: int) -> VectorPeaks:
    """Peaks of `count` vectors from values and times (4 count, ...), in the order of `_sizes`; more is left out."""
    v, t = (x[: 4 * count].reshape(count, 4) for x in (value, when))
    return VectorPeaks(Extremes(v[:, :3], t[:, :3]), Extremes(v[:, 3], t[:, 3]))
