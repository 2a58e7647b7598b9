"""Conditioning of a record's samples: dropouts, spikes and flat tops found, filter, resampling."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError, placing_within
from gbeam.guards.checks import positive
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.numerics.samples import low_pass, true_runs

FEWEST = 6  # samples of a record
UNEVEN = 0.01  # of the median interval
_LONGEST_RUN, _SIDE, _NEARBY = 5, 3, 8  # samples of a spike, beside it, and runs on either side that it is judged by
_OUTLIER, _SPREAD = 6.0, 1.4826  # deviations of normal noise; one of them over the median of the sizes
LEAST_JUMP, LEAST_TURN = 0.5, 0.05  # m/s², rad/s: a smaller step is no dropout and no spike
_BESIDE = 0.3  # of a spike: its neighbours are less off; those on a corner are off by half as much
_FLAT, _STEADY, _STEP = 4, 3, 5.0  # samples of a flat top; steps that lead there; one of so many times the resolution
_FULL = 1.1 * STANDARD_GRAVITY  # m/s²: no sensor's range ends at level flight
_NEARLY = 0.99  # of a rate: what is that near to it is not below it


def _jumps(change: Floats, neighbours: Floats) -> bool:
    """True if a change (1,) is much larger than those beside it; false if there are none."""
    if not (change.size and neighbours.size):
        return False
    return bool(abs(change[0]) > max(LEAST_JUMP, 3 * float(np.abs(neighbours).max())))


def dropout(values: Floats, step: float) -> tuple[int, int] | None:
    """First and last sample of a stretch without change that begins or ends with a jump, or None if there is none.

    A true plateau is entered and left by a corner: the first change beside it is like the next. After a dropout the
    channel has gone on in the meantime, and jumps by much more than in the samples beside the jump. A channel that is
    rough everywhere else and then the same number to its end has died.
    """
    change = np.diff(values)
    runs = np.array([(run.start, run.stop) for run in true_runs(change == 0)], dtype=int).reshape(-1, 2)
    repeats = int(np.sum(runs[:, 1] - runs[:, 0]))
    # Samples first … last are equal. The shortest runs first: beside a gap the plateau jumps too.
    for first, last in runs[np.argsort(runs[:, 1] - runs[:, 0], kind="stable")]:
        fewest = 3 if values[first] == 0 else 5
        if last - first + 1 < fewest:
            continue
        jumps_after = _jumps(change[last : last + 1], change[last + 1 : last + 4])
        if jumps_after or _jumps(change[max(first - 1, 0) : first], change[max(first - 4, 0) : max(first - 1, 0)]):
            return int(first), int(last)
        if last < len(values) - 1 or (last - first) * step < 0.5 or first < 3:
            continue
        bends = np.median(np.abs(np.diff(values[:first], 2)))
        if bends > 1e-7 * np.ptp(values) and repeats - (last - first) < 0.01 * len(values):
            return int(first), int(last)
    return None


def spikes(load: Floats, least_jump: float = LEAST_JUMP) -> Flags:
    """Flags (t, n) of spikes, per channel: runs of up to five samples between two jumps, far off their surroundings.

    The deviation is measured from the straight line between the medians of the three samples before a run and after it,
    which follows a flank, too. All of a run deviates, its neighbours do not. Far means six times the usual deviation of
    runs of its length, both nearby and in the whole record. If bad samples alternate with good ones, the shorter and
    outer runs are taken for the bad ones.
    """
    flags = np.zeros(load.shape, dtype=bool)
    padded = np.pad(load, ((_SIDE, _SIDE), (0, 0)), mode="reflect", reflect_type="odd")  # a slope goes on
    middle = _median_of_three(padded[:-2], padded[1:-1], padded[2:])
    for length in range(1, min(_LONGEST_RUN, len(load) // 2) + 1):
        count = len(load) - length + 1  # of runs, by their first sample
        left_values, right_values = middle[:count], middle[length + _SIDE : length + _SIDE + count]
        lines = (left_values + (right_values - left_values) * (k + 2) / (length + 3) for k in range(-1, length + 1))
        deviation = [np.abs(padded[k + _SIDE :][:count] - line) for k, line in enumerate(lines, start=-1)]
        smallest, mean = np.minimum.reduce(deviation[1:-1]), np.mean(deviation[1:-1], axis=0)
        limit = np.maximum(_OUTLIER * _SPREAD * np.median(mean, axis=0), least_jump)
        neighbour_deviation = np.maximum(deviation[0], deviation[-1])
        is_spike = (smallest > limit) & (neighbour_deviation < _BESIDE * smallest)
        is_spike &= ~np.logical_or.reduce([flags[k:][:count] for k in range(length)])
        first, channel = np.nonzero(is_spike)
        distances = length + _SIDE + np.arange(_NEARBY)
        nearby = np.clip(first + np.concatenate([-distances, distances])[:, None], 0, count - 1)
        limit = np.maximum(_OUTLIER * _SPREAD * np.median(mean[nearby, channel], axis=0), limit[channel])
        is_spike[first, channel] = (smallest[first, channel] > limit) & (neighbour_deviation[first, channel] < limit)
        is_spike[length:-length] &= ~(is_spike[: -2 * length] & is_spike[2 * length :])
        for k in range(length):
            flags[k:][:count] |= is_spike
    return flags


def _median_of_three(a: Floats, b: Floats, c: Floats) -> Floats:
    return np.asarray(np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c)))


def flat_tops(values: Floats) -> Iterator[tuple[float, list[slice]]]:
    """Values, m/s², at which a channel is cut off, and where: an extreme that successive samples have exactly.

    A curve that is cut off arrives there steadily, or by a step larger than the sensor's resolution. A level of a
    coarse sensor does neither. A record that begins or ends there, such as in level flight, is not cut off.
    """
    top, bottom = float(values.max()), float(values.min())
    for extreme, is_large, sign in ((top, top > _FULL, 1.0), (bottom, bottom < -_FULL, -1.0)):
        runs = [run for run in true_runs(values == extreme) if run.start > 0 and run.stop < len(values)]
        runs = [run for run in runs if run.stop - run.start >= _FLAT]
        changes, finest = sign * np.diff(values), np.diff(np.unique(values)).min(initial=np.inf)
        # Steps that lead to the extreme, from before a run and, backwards, from after it.
        approaches = []
        for run in runs:
            approaches += [changes[: run.start][-_STEADY:], -changes[run.stop - 1 :][:_STEADY][::-1]]
        is_cut = [steps[-1] > _STEP * finest or (len(steps) == _STEADY and steps.min() > 0) for steps in approaches]
        if is_large and any(is_cut):
            yield extreme, runs


def without_spikes(time: Floats, load: Floats, is_spike: Flags) -> Floats:
    """The record with its spikes replaced by straight lines between their neighbours."""
    columns = (np.interp(time, time[~bad], values[~bad]) for values, bad in zip(load.T, is_spike.T, strict=True))
    return np.stack(list(columns), axis=1)


def filtered(time: Floats, values: Floats, cutoff: float | None, resample: float | None) -> tuple[Floats, Floats]:
    """Times (t,), s, and values (t, n) after a low-pass at `cutoff` and a spline to `resample`, Hz, if not None."""
    step = float(time[-1] - time[0]) / (len(time) - 1)
    if cutoff is not None:
        if np.abs(np.diff(time) - step).max() > UNEVEN * step:
            even = np.linspace(time[0], time[-1], len(time))
            time, values = even, _splined(time, values, even)
        with placing_within("record"):
            values = low_pass(values, step, positive("cutoff", cutoff, "Hz"))
    if resample is None:
        return time, values
    rate = positive("record.resample", resample, "Hz")
    if rate * step < _NEARLY and (cutoff is None or cutoff > 0.4 * rate):
        raise InputError(
            "record.resample",
            f"is {rate:g} Hz, below the record's {1 / step:g} Hz, with "
            + ("no cut-off" if cutoff is None else f"a cut-off of {cutoff:g} Hz"),
            f'add cutoff = "{0.4 * rate:g} Hz" or less: what is faster would come back as slow vibration',
        )
    length = float(time[-1] - time[0])
    if length * rate < FEWEST - 1:
        problem = f"is {rate:g} Hz, which leaves fewer than {FEWEST} samples of {length:g} s"
        raise InputError("record.resample", problem, f"give {(FEWEST - 1) / length:.3g} Hz or more")
    per_sample = 24.0 * values[0].size  # bytes, with the spline
    fix = f"give {SAMPLES / length:.3g} Hz or less"
    refuse_more("record.resample", "samples", length * rate, SAMPLES, per_sample, fix)
    new_times = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * rate * (1 + 1e-12))) + 1) / rate
    new_times = np.minimum(new_times, time[-1])
    return new_times, _splined(time, values, new_times)


def _splined(time: Floats, values: Floats, fresh: Floats) -> Floats:
    import scipy.interpolate  # half a second to import, which only a new rate needs

    return np.asarray(scipy.interpolate.CubicSpline(time, values, axis=0)(fresh))
