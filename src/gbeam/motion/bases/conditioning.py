"""What a record's samples go through: dropouts and spikes found, filter, resampling."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.numerics.filters.low_pass import low_pass
from gbeam.numerics.intervals import true_runs

Floats = NDArray[np.float64]

FEWEST = 6  # samples of a record
_WINDOW, _OUTLIER = 3, 6.0  # samples either side; deviations from the window's median
_LEAST_JUMP = 0.5  # m/s²: a smaller step is no dropout and no spike


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


def spikes(load: Floats) -> NDArray[np.bool_]:
    """Single samples far off the median of their seven neighbours, per channel, (t, 3): Hampel's test."""
    padded = np.pad(load, ((_WINDOW, _WINDOW), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _WINDOW + 1, axis=0)
    middle = np.median(windows, axis=-1)
    spread = 1.4826 * np.median(np.abs(windows - middle[..., None]), axis=-1)
    return np.asarray(np.abs(load - middle) > np.maximum(_OUTLIER * spread, _LEAST_JUMP))


def without_spikes(time: Floats, load: Floats, at: NDArray[np.bool_]) -> Floats:
    """The record with its spikes replaced by straight lines between their neighbours."""
    columns = (np.interp(time, time[~bad], values[~bad]) for values, bad in zip(load.T, at.T, strict=True))
    return np.stack(list(columns), axis=1)


def filtered(time: Floats, values: Floats, cutoff: float | None, resample: float | None) -> tuple[Floats, Floats]:
    """Times and values after the low-pass and at the new rate.

    Parameters
    ----------
    time : (t,) s, even
    values : (t, ...)
    cutoff : float or None
        Hz, −6 dB; see :func:`gbeam.numerics.filters.low_pass.low_pass`.
    resample : float or None
        New sampling rate, Hz; between samples by a cubic spline.

    Raises
    ------
    InputError
        If the cut-off is at or above half of either sampling rate, or a lower rate is given without a cut-off, or the
        rate leaves too few samples or makes too many.
    """
    step = float(time[-1] - time[0]) / (len(time) - 1)
    if cutoff is not None:
        try:
            values = low_pass(values, step, positive("cutoff", cutoff, "Hz"))
        except InputError as error:
            raise error.within("record") from None
    if resample is None:
        return time, values
    rate = positive("record.resample", resample, "Hz")
    if rate * step < 1 - 1e-9 and (cutoff is None or cutoff > 0.4 * rate):
        raise InputError(
            "record.resample",
            f"is {rate:g} Hz, below the record's {1 / step:g} Hz, with "
            + ("no cut-off" if cutoff is None else f"a cut-off of {cutoff:g} Hz"),
            f'add cutoff = "{0.4 * rate:g} Hz" or less: what is faster would come back as slow vibration',
        )
    import scipy.interpolate  # half a second to import, which only a new rate needs

    length = float(time[-1] - time[0])
    if length * rate < FEWEST - 1:
        problem = f"is {rate:g} Hz, which leaves fewer than {FEWEST} samples of {length:g} s"
        raise InputError("record.resample", problem, f"give {(FEWEST - 1) / length:.3g} Hz or more")
    each = 24.0 * values[0].size  # a sample and the spline through it
    refuse_more("record.resample", "samples", length * rate, SAMPLES, each, f"give {SAMPLES / length:.3g} Hz or less")
    fresh = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * rate * (1 + 1e-12))) + 1) / rate
    fresh = np.minimum(fresh, time[-1])
    return fresh, np.asarray(scipy.interpolate.CubicSpline(time, values, axis=0)(fresh))
