"""Peaks of a response between its steps: of the displacement, and of what the sections carry."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.numerics.peaks import FEWEST, Floats, Indices, maxima, near_maxima, quintic_hermite, seven_point
from gbeam.results.parts import Extremes, LoadPeaks, Loads, Peaks, VectorPeaks


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
        return [_samples(time, each[:, -1], start if late else None) for each in moved]
    q, qd, qdd = (np.stack([getattr(each, name)[:, first:] for each in trajectories]) for name in ("q", "qd", "qdd"))

    def largest(begin: int, measure: Callable[[Floats], Floats]) -> tuple[Floats, Floats]:
        values = measure(moved[:, begin:])
        chosen = near_maxima(time[begin:], values)
        t, y = quintic_hermite(time[begin:], q[:, begin:], qd[:, begin:], qdd[:, begin:], chosen)
        return maxima(time[begin:], values, t, measure(np.asarray(structure.displacement(y))), chosen)

    stations, residual = moved.shape[2], np.full((len(trajectories), 3), np.nan)
    if late:
        highest, _ = largest(start, lambda u: np.concatenate([u[..., -1, :], -u[..., -1, :]], axis=-1))
        residual = (highest[:, :3] + highest[:, 3:]) / 2
    every = [_vectors(*each, stations) for each in zip(*largest(0, _sizes), strict=True)]
    return [_of_stations(*each) for each in zip(every, residual, strict=True)]


def _of_stations(every: VectorPeaks, residual: Floats) -> Peaks:
    tip = every[-1]
    return Peaks(
        max_abs=tip.components.value,
        time_of_max=tip.components.time,
        residual_amplitude=residual,
        max_size=float(tip.size.value),
        time_of_max_size=float(tip.size.time),
        displacement=every,
    )


def _samples(time: Floats, tip: Any, start: int | None) -> Peaks:
    """Largest samples of the tip's displacement (t, 3)."""
    xp = namespace(tip)
    sizes, times = xp.abs(tip), xp.asarray(time)
    length = xp.sqrt((tip**2).sum(axis=1).max())
    residual = np.full(3, np.nan) if start is None else (tip[start:].max(axis=0) - tip[start:].min(axis=0)) / 2
    when = times[(tip**2).sum(axis=1).argmax()]
    return Peaks(sizes.max(axis=0), times[sizes.argmax(axis=0)], residual, length, when)


def load_peaks(loads: Loads, loads_at: Callable[[Indices], Loads | None], time: Floats, stride: int) -> LoadPeaks:
    """Peaks of the loads, known at every `stride`-th step: near one, the polynomial of sixth degree through seven
    steps.
    """
    s = loads.section_force.shape[1]
    table, steps = _table(loads), np.arange(0, len(time), stride)

    def measure(table: Floats) -> Floats:
        vectors = table[..., : 6 * s].reshape(*table.shape[:-1], 2 * s, 3)
        return np.concatenate([_sizes(vectors), table[..., 6 * s : 8 * s], np.abs(table[..., 8 * s :])], axis=-1)

    chosen = near_maxima(time[steps], measure(table))
    if stride > 1 and chosen.size:
        # Near the steps kept that may win, the loads are computed at every step.
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
    """Largest sizes of components and length of a vector (t, 3), (4,), and their times, by polynomials through seven
    samples.
    """
    sizes = _sizes(vectors[:, None])
    t, between = seven_point(time, vectors, near_maxima(time, sizes))
    return maxima(time, sizes, t, _sizes(between[:, :, None]))


def half_ranges(time: Floats, values: Any, start: float) -> Any:
    """Half of peak to peak of every history (t, k) from a time on, (k,); NaN where there are not two samples."""
    after = time >= start
    if after.sum() < 2:
        return np.full(values.shape[1], np.nan)
    time, values = time[after], values[after]
    if is_jax(values):
        return (values.max(axis=0) - values.min(axis=0)) / 2
    both = np.concatenate([values, -values], axis=1)
    t, between = seven_point(time, values, near_maxima(time, both))
    value, _ = maxima(time, both, t, np.concatenate([between, -between], axis=2))
    return value.reshape(2, -1).sum(axis=0) / 2


def peaks_of_coordinates(trajectory: Trajectory, vectors: Floats, of: Callable[[Floats], Floats]) -> Floats:
    """Largest sizes (4,) of components and length of a vector of q, also at Hermite polynomials between steps."""
    time, sizes = trajectory.time, _sizes(vectors[:, None])
    t, q = quintic_hermite(time, trajectory.q, trajectory.qd, trajectory.qdd, near_maxima(time, sizes))
    value, _ = maxima(time, sizes, t, _sizes(of(q)[:, :, None]))
    return value


def _table(loads: Loads) -> Floats:
    """Loads with peaks, (t, c): forces, moments, tension, compression (zero if unknown), von Mises' stress if known,
    and the torque for the beam on a hub.
    """
    torque = [] if loads.beam_torque is None else [loads.beam_torque[:, None]]
    vectors = (x.reshape(len(x), -1) for x in (loads.section_force, loads.section_moment))
    stresses = (np.nan_to_num(x) for x in (loads.stress_tension, -loads.stress_compression))
    sheared = [np.asarray(loads.von_mises)] if _sheared(loads) else []
    return np.concatenate([*vectors, *stresses, *sheared, *torque], axis=1)


def _sheared(loads: Loads) -> bool:
    """Whether von Mises' stress is known."""
    return loads.von_mises is not None and bool(np.isfinite(loads.von_mises).all())


def _sizes(vectors: Floats) -> Floats:
    """Sizes of the components and the lengths of vectors (..., g, 3), (..., 4 g)."""
    length = np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    sizes = np.concatenate([np.abs(vectors), length], axis=-1)
    return sizes.reshape(*sizes.shape[:-2], 4 * vectors.shape[-2])


def _vectors(value: Floats, when: Floats, count: int) -> VectorPeaks:
    """Peaks of as many vectors from those of their sizes, (4 count,) and what follows."""
    v, t = (x[: 4 * count].reshape(count, 4) for x in (value, when))
    return VectorPeaks(Extremes(v[:, :3], t[:, :3]), Extremes(v[:, 3], t[:, 3]))
