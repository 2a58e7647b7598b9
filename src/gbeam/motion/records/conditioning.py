"""Conditioning of a record's samples: dropouts, spikes and flat tops found, filter, resampling."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError, placing_within
from gbeam.guards.checks import positive
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.numerics.samples import low_pass, true_runs

FEWEST = 6  # samples of a record
UNEVEN = 0.01  # of the median interval
_WINDOW, _OUTLIER = 3, 6.0  # samples either side; deviations from the window's median
_LEAST_JUMP = 0.5  # m/s²: a smaller step is no dropout and no spike
_BESIDE = 0.25, 0.75  # of a spike's bend, the other way: the bend of its neighbours
_FLAT, _STEADY, _STEP = 4, 3, 5.0  # samples of a flat top; steps that lead there; one of so many times the resolution
_FULL = 1.1 * STANDARD_GRAVITY  # m/s²: no sensor's range ends at level flight
_NEARLY = 0.99  # of a rate: what is that near to it is not below it


def dropout(values: Floats, step: float) -> tuple[int, int] | None:
    """First and last sample of a stretch in which a channel stands still and ends, or began, with a jump.

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
        for jump, beside in (
            (change[last : last + 1], change[last + 1 : last + 4]),
            (change[max(first - 1, 0) : first], change[max(first - 4, 0) : max(first - 1, 0)]),
        ):
            if jump.size and beside.size and abs(jump[0]) > max(_LEAST_JUMP, 3 * float(np.abs(beside).max())):
                return int(first), int(last)
        if last < len(values) - 1 or (last - first) * step < 0.5 or first < 3:
            continue
        bends = np.median(np.abs(np.diff(values[:first], 2)))
        if bends > 1e-7 * np.ptp(values) and repeats - (last - first) < 0.01 * len(values):
            return int(first), int(last)
    return None


def spikes(load: Floats) -> Flags:
    """Flags (t, 3) of single samples far off, per channel, by either of two tests.

    Hampel's: off the median of the seven around them. On a flank beside a peak these deviate from their median as much
    as a spike does, so the other is: off the straight line between their neighbours, which themselves are off by half
    as much the other way. Far is six deviations of what is around, and of the whole record.
    """
    windows = _windows(load, _WINDOW, "odd")
    middle = np.median(windows, axis=-1)
    bend = np.zeros_like(load)
    bend[1:-1] = load[1:-1] - (load[:-2] + load[2:]) / 2
    least, most = (share * np.abs(bend) for share in _BESIDE)
    beside = np.stack([np.roll(bend, 1, axis=0), np.roll(bend, -1, axis=0)]) * -np.sign(bend)
    single = ((beside > least) & (beside < most)).all(axis=0)
    around = np.delete(_windows(np.abs(bend), _WINDOW + 1, "even"), [_WINDOW, _WINDOW + 1, _WINDOW + 2], axis=-1)
    return _far(load - middle, np.abs(windows - middle[..., None])) | (single & _far(bend, around))


def _windows(values: Floats, beside: int, reflected: Literal["odd", "even"]) -> Floats:
    """Samples around each, (t, 3, 2 beside + 1); beyond the ends a slope goes on (odd), or a size does (even)."""
    padded = np.pad(values, ((beside, beside), (0, 0)), mode="reflect", reflect_type=reflected)
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * beside + 1, axis=0)


def _far(off: Floats, around: Floats) -> Flags:
    """Flags of samples `off` by more than six deviations of the windows `around` them, and of the median window."""
    spread = 1.4826 * np.median(around, axis=-1)
    spread = np.maximum(spread, np.median(spread, axis=0))
    return np.asarray(np.abs(off) > np.maximum(_OUTLIER * spread, _LEAST_JUMP))


def flat_tops(values: Floats) -> Iterator[tuple[float, list[slice]]]:
    """Values at which a channel, m/s², is cut off, and where: an extreme that successive samples have exactly.

    A curve that is cut off arrives steadily, or by a step larger than the sensor's resolution; one of which a coarse
    sensor makes a level does neither. A record that begins or ends there, such as in level flight, is not cut off.
    """
    top, bottom = float(values.max()), float(values.min())
    for extreme, outwards, sign in ((top, top > _FULL, 1.0), (bottom, bottom < -_FULL, -1.0)):
        runs = [run for run in true_runs(values == extreme) if run.start > 0 and run.stop < len(values)]
        runs = [run for run in runs if run.stop - run.start >= _FLAT]
        rise, finest = sign * np.diff(values), np.diff(np.unique(values)).min(initial=np.inf)
        # Steps that lead to the extreme, from before a run and, backwards, from after it.
        ways = [way for run in runs for way in (rise[: run.start][-_STEADY:], -rise[run.stop - 1 :][:_STEADY][::-1])]
        if outwards and any(way[-1] > _STEP * finest or (len(way) == _STEADY and way.min() > 0) for way in ways):
            yield extreme, runs


def without_spikes(time: Floats, load: Floats, at: Flags) -> Floats:
    """The record with its spikes replaced by straight lines between their neighbours."""
    columns = (np.interp(time, time[~bad], values[~bad]) for values, bad in zip(load.T, at.T, strict=True))
    return np.stack(list(columns), axis=1)


def filtered(time: Floats, values: Floats, cutoff: float | None, resample: float | None) -> tuple[Floats, Floats]:
    """Times (t,), s, and values (t, n): low-pass at `cutoff`, then splined to `resample`, both Hz; None skips one."""
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
    fresh = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * rate * (1 + 1e-12))) + 1) / rate
    fresh = np.minimum(fresh, time[-1])
    return fresh, _splined(time, values, fresh)


def _splined(time: Floats, values: Floats, fresh: Floats) -> Floats:
    import scipy.interpolate  # half a second to import, which only a new rate needs

    return np.asarray(scipy.interpolate.CubicSpline(time, values, axis=0)(fresh))
