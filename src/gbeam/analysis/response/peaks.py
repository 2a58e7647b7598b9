"""Peaks of responses between steps: of displacement, section loads and what a system has."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.types import Floats, Indices
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.numerics.peaks import (
    FEWEST,
    column_peaks,
    length_peaks,
    maxima,
    near_maxima,
    quintic_hermite,
    seven_point,
    sizes,
    vector_peaks,
)
from gbeam.results.parts import Extremes, LoadPeaks, Loads, Peaks, VectorPeaks
from gbeam.results.system import Maxima

_ROUNDING = 1e-16  # of the places: a displacement that is less is none


def displacement_peaks(
    structure: Structure, trajectories: Sequence[Trajectory], columns: slice, moved: Any, residual_from: float | None
) -> list[Peaks]:
    """Peaks of the displacement in each trajectory.

    They follow from samples `moved` (b, t, s, 3) m and, between steps, from the model at quintic Hermite polynomials of
    q. Where JAX traces it, they are the tip's largest samples.
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
        samples = [begin + sample[run == k] for k in range(len(trajectories))]
        qdd = np.stack([_nearby_accelerations(*pair) for pair in zip(trajectories, samples, strict=True)])
        part = np.s_[:, begin:, columns]
        t, y = quintic_hermite(time[begin:], q[part], qd[part], qdd[part], chosen)
        return maxima(time[begin:], values, t, measure(np.asarray(structure.displacement(y))), chosen)

    stations, residual = moved.shape[2], np.full((len(trajectories), 3), np.nan)
    if late:
        highest, _ = largest(start, lambda u: np.concatenate([u[..., -1, :], -u[..., -1, :]], axis=-1))
        residual = (highest[:, :3] + highest[:, 3:]) / 2
    vectors = [_vectors(value, instant, stations) for value, instant in zip(*largest(0, sizes), strict=True)]
    return [_station_peaks(*run) for run in zip(vectors, residual, strict=True)]


def _nearby_accelerations(trajectory: Trajectory, samples: Indices) -> Floats:
    """Accelerations (t, n) at samples (u,) and their neighbours, or NaN elsewhere."""
    qdd, neighbours = np.full(trajectory.q.shape, np.nan), np.unique(samples[:, None] + np.arange(-1, 2))
    qdd[neighbours] = trajectory.select(neighbours).qdd
    return qdd


def _station_peaks(stations: VectorPeaks, residual: Floats) -> Peaks:
    """Peaks of a response from those of the displacement at every station, the last of which is the tip."""
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
    size, times = xp.abs(tip), xp.asarray(time)
    length = xp.sqrt((tip**2).sum(axis=1).max())
    residual = np.full(3, np.nan) if start is None else (tip[start:].max(axis=0) - tip[start:].min(axis=0)) / 2
    peak_time = times[(tip**2).sum(axis=1).argmax()]
    return Peaks(size.max(axis=0), times[size.argmax(axis=0)], residual, length, peak_time)


def load_peaks(
    loads: Loads, time: Floats, loads_at: Callable[[Indices], Loads | None] | None = None, stride: int = 1
) -> LoadPeaks:
    """Peaks of loads known at every `stride`-th of the times.

    `loads_at` computes the loads at other times, near peaks.
    """
    s, supports = loads.section_force.shape[1], 0 if loads.supports is None else len(loads.supports)
    count = 2 * (s + supports)  # of vectors
    table, steps = _table(loads), np.arange(0, len(time), stride)

    def measure(table: Floats) -> Floats:
        """Sizes whose maxima are the peaks: of components and lengths of vectors, of stresses and of torque."""
        vectors = table[..., : 3 * count].reshape(*table.shape[:-1], count, 3)
        stresses = table[..., 3 * count : 3 * count + 2 * s]
        return np.concatenate([sizes(vectors), stresses, np.abs(table[..., 3 * count + 2 * s :])], axis=-1)

    chosen = near_maxima(time[steps], measure(table))
    if loads_at is not None and stride > 1 and chosen.size:
        # Beside the samples that may be the largest, the loads are computed at every step.
        neighbours = steps[chosen][:, None] + np.arange(-stride - FEWEST // 2, stride + FEWEST // 2 + 1)
        added = np.setdiff1d(np.clip(neighbours, 0, len(time) - 1), steps)
        added_loads = loads_at(added)
        assert added_loads is not None
        table, steps = np.concatenate([table, _table(added_loads)]), np.concatenate([steps, added])
        order = np.argsort(steps)
        table, steps = table[order], steps[order]
        chosen = near_maxima(time[steps], measure(table))
        chosen = chosen[steps[chosen + 1] - steps[chosen - 1] == 2]
    t, refined = seven_point(time[steps], table, chosen)
    value, peak_time = maxima(time[steps], measure(table), t, measure(refined))
    if not np.isfinite(loads.stress_tension).all():
        value[4 * count : 4 * count + 2 * s] = peak_time[4 * count : 4 * count + 2 * s] = np.nan
    vectors, v, w = _vectors(value, peak_time, count), value[4 * count :], peak_time[4 * count :]
    on_supports = vectors[2 * s :]
    return LoadPeaks(
        force=vectors[:s],
        moment=vectors[s : 2 * s],
        tension=Extremes(v[:s], w[:s]),
        compression=Extremes(-v[s : 2 * s], w[s : 2 * s]),
        von_mises=Extremes(v[2 * s : 3 * s], w[2 * s : 3 * s]) if _sheared(loads) else None,
        beam_torque=None if loads.beam_torque is None else Extremes(v[-1], w[-1]),
        supports=loads.supports,
        support_names=loads.support_names,
        support_force=on_supports[:supports] if supports else None,
        support_moment=on_supports[supports:] if supports else None,
        stations=loads.stations,
        yield_strength=loads.yield_strength,
    )


def maxima_of(system: System, time: Floats, over_time: Mapping[str, Floats]) -> Maxima:
    """Peaks of a system between steps, by the histories of its points, coordinates, efforts and the ground's loads."""

    place, q = over_time["place"], over_time["q"]
    vectors = np.stack([place - place[0], over_time["velocity"], over_time["acceleration"]])
    length, when_longest = length_peaks(time, np.moveaxis(vectors, 2, 1))
    distance = np.where(length[0] <= _ROUNDING * np.abs(place).max(initial=0.0), 0.0, length[0])
    columns = -q, q, np.abs(over_time["qd"]), np.abs(over_time["effort"])
    highest, when_highest = (values.reshape(4, -1) for values in column_peaks(time, np.concatenate(columns, axis=1)))
    on_ground = vector_peaks(time, np.stack([over_time["ground_force"], over_time["ground_moment"]]))
    force, moment = (
        VectorPeaks(Extremes(value[:3], peak_time[:3]), Extremes(value[3], peak_time[3]))
        for value, peak_time in zip(*on_ground, strict=True)
    )
    return Maxima(
        points=system.points,
        coordinates=system.coordinates,
        displacement=distance,
        displacement_time=when_longest[0],
        velocity=length[1],
        velocity_time=when_longest[1],
        acceleration=length[2],
        acceleration_time=when_longest[2],
        lowest=-highest[0],
        lowest_time=when_highest[0],
        highest=highest[1],
        highest_time=when_highest[1],
        rate=highest[2],
        rate_time=when_highest[2],
        effort=highest[3],
        effort_time=when_highest[3],
        ground_force=force,
        ground_moment=moment,
    )


def half_ranges(time: Floats, values: Any, start: float) -> Any:
    """Half of the range (k,) of each history (t, k) from a time on, or NaN where there are not two samples."""
    is_residual = time >= start
    if is_residual.sum() < 2:
        return np.full(values.shape[1], np.nan)
    time, values = time[is_residual], values[is_residual]
    if is_jax(values):
        return (values.max(axis=0) - values.min(axis=0)) / 2
    signed = np.concatenate([values, -values], axis=1)
    t, refined = seven_point(time, values, near_maxima(time, signed))
    value, _ = maxima(time, signed, t, np.concatenate([refined, -refined], axis=2))
    return value.reshape(2, -1).sum(axis=0) / 2


def peaks_of_coordinates(trajectory: Trajectory, vectors: Floats, vector: Callable[[Floats], Floats]) -> Floats:
    """Largest sizes (4,) of components and length of a `vector` of q, which has the values `vectors` (t, 3)."""
    time, measured = trajectory.time, sizes(vectors[:, None])
    maxima_indices = near_maxima(time, measured)
    t, q = quintic_hermite(
        time, trajectory.q, trajectory.qd, _nearby_accelerations(trajectory, maxima_indices), maxima_indices
    )
    value, _ = maxima(time, measured, t, sizes(vector(q)[:, :, None]))
    return value


def _table(loads: Loads) -> Floats:
    """Columns (t, c) of loads: forces and moments of sections and of supports, tension, compression, von Mises stress
    and torque on a hub if known.
    """
    torque = [] if loads.beam_torque is None else [loads.beam_torque[:, None]]
    of_supports = () if loads.support_force is None else (loads.support_force, loads.support_moment)
    histories = loads.section_force, loads.section_moment, *of_supports
    vectors = [np.asarray(vector).reshape(len(vector), -1) for vector in histories]
    stresses = (np.nan_to_num(x) for x in (loads.stress_tension, -loads.stress_compression))
    sheared = [np.asarray(loads.von_mises)] if _sheared(loads) else []
    return np.concatenate([*vectors, *stresses, *sheared, *torque], axis=1)


def _sheared(loads: Loads) -> bool:
    """True if von Mises' stress is known."""
    return loads.von_mises is not None and bool(np.isfinite(loads.von_mises).all())


def _vectors(value: Floats, times: Floats, count: int) -> VectorPeaks:
    """Peaks of `count` vectors from values and times (4 count, ...), in the order of `sizes`. Further values are left
    out.
    """
    v, t = (x[: 4 * count].reshape(count, 4) for x in (value, times))
    return VectorPeaks(Extremes(v[:, :3], t[:, :3]), Extremes(v[:, 3], t[:, 3]))
