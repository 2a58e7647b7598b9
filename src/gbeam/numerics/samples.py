"""Histories sampled over time: runs of samples, values between them, integrals, attitude, peaks and linear filters."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.types import Flags, Floats
from gbeam.errors import InputError


def true_runs(flags: Flags) -> list[slice]:
    """Runs of true flags (n,), ascending, each as a slice."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [slice(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def joined(runs: list[slice], time: Floats, gap: float) -> list[slice]:
    """Runs of samples at times (n,) s with those nearer than `gap` to one another made one."""
    merged: list[slice] = []
    for run in runs:
        if merged and time[run.start] - time[merged[-1].stop - 1] < gap:
            merged[-1] = slice(merged[-1].start, run.stop)
        else:
            merged.append(run)
    return merged


def thinned(x: Floats, y: Floats, columns: int) -> tuple[Floats, Floats]:
    """Samples that show in a picture of so many columns: the first, last, lowest and highest of each; all of few."""
    if len(x) <= 4 * columns:
        return x, y
    width = -(-len(x) // columns)
    index = np.minimum(np.arange(width * -(-len(x) // width)), len(x) - 1).reshape(-1, width)
    rows, shown = np.arange(len(index)), y[index]
    ends = index[:, 0], index[:, -1], index[rows, shown.argmin(axis=1)], index[rows, shown.argmax(axis=1)]
    chosen = np.unique(np.concatenate(ends))
    return x[chosen], y[chosen]


def interpolated(time: Floats, is_known: Floats, values: Floats) -> Floats:
    """Values (t, ...) at the times `is_known`, at `time` (u,): on straight lines, and constant beyond the ends."""
    columns = np.reshape(values, (len(is_known), -1)).T
    return np.stack([np.interp(time, is_known, column) for column in columns], axis=1).reshape(
        -1, *np.shape(values)[1:]
    )


def cumulative(time: Floats, value: Floats, slope: Floats) -> Floats:
    """Integral from the first time to each, (n,), by the trapezium rule with its end correction: of fourth order."""
    step = np.diff(time)
    pieces = step * (value[1:] + value[:-1]) / 2 - step**2 * np.diff(slope) / 12
    return np.append(0.0, np.cumsum(pieces))


def attitude(time: Floats, w_WB_B: Floats) -> Floats:
    """Attitudes since the first time, quaternions (t, 4) w, x, y, z, by body rates (t, 3) rad/s at `time` (t,) s."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_rotvec(0.5 * (w_WB_B[1:] + w_WB_B[:-1]) * np.diff(time)[:, None])
    turns_since = (
        Rotation.concatenate([Rotation.identity(), turns]) if len(turns) else Rotation.from_quat([[0, 0, 0, 1]])
    )
    reach = 1
    while reach < len(turns_since):  # products of 2, 4, 8, ... intervals at once
        turns_since = Rotation.concatenate([turns_since[:reach], turns_since[:-reach] * turns_since[reach:]])
        reach *= 2
    return np.roll(turns_since.as_quat(), 1, axis=1)


def separate_peaks(values: Floats, floor: float, dip: float) -> list[tuple[int, slice]]:
    """Peaks of values (n,) above a floor: index of the top, and the slice around it. Two maxima are one peak unless the
    values between them are below `dip` times the lower one.
    """
    peaks: list[tuple[int, slice]] = []
    for run in true_runs(values > floor):
        part = values[run]  # indices below are of this run
        rises = np.concatenate([[True], part[1:] > part[:-1]])
        falls = np.concatenate([part[:-1] >= part[1:], [True]])
        tops = np.flatnonzero(rises & falls)
        separate, lowest = [int(tops[0])], np.inf
        for top, before in zip(tops[1:].tolist(), np.minimum.reduceat(part, tops)[:-1].tolist(), strict=True):
            lowest = min(lowest, before)
            if lowest < dip * min(part[separate[-1]], part[top]):
                separate.append(top)
            elif part[top] > part[separate[-1]]:
                separate[-1] = top
            else:
                continue
            lowest = np.inf
        lows = [first + int(np.argmin(part[first:second])) for first, second in pairwise(separate)]
        edges = [0, *lows, len(part)]
        peaks += [
            (run.start + top, slice(run.start + begin, run.start + end))
            for top, (begin, end) in zip(separate, pairwise(edges), strict=True)
        ]
    return peaks


ORDER = 4


def low_pass(values: Floats, step: float, cutoff: float) -> Floats:
    """Butterworth low-pass of fourth order, run forwards and backwards: no phase, −6 dB at the cut-off.

    The ends are continued by their point reflection over one period of the cut-off, which the samples have to cover.
    """
    length = max(len(values) - 1, 1) * step
    if not (1 - 1e-5) / length <= cutoff < 0.5 / step:  # as the fix prints it, rounded
        problem = f"is {cutoff:g} Hz, with samples {step:g} s apart over {length:g} s"
        raise InputError("cutoff", problem, f"give {1 / length:g} Hz or more, below {0.5 / step:g} Hz")
    import scipy.signal

    sections = scipy.signal.butter(ORDER, cutoff, fs=1 / step, output="sos")
    extension = min(len(values) - 1, math.ceil(1 / (cutoff * step)))
    return np.asarray(scipy.signal.sosfiltfilt(sections, values, axis=0, padlen=extension))


def displacement(load: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """η (f, t, ...) of η̈ + 2ζω η̇ + ω² η = load (t, ...), from rest under the first load; (f,) rad/s, or one."""
    histories = [_response(load, omega, damping, step, 1.0, 0.0, 1 / omega**2) for omega in np.ravel(frequency)]
    return np.reshape(histories, (*np.shape(frequency), *np.shape(load)))


def oscillator_acceleration(base: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """Absolute accelerations (f, t, ...) of oscillators (f,) rad/s, from rest on a base with acceleration (t, ...)."""
    omegas = np.ravel(frequency)
    histories = [_response(base, omega, damping, step, omega**2, 2 * damping * omega, 1.0) for omega in omegas]
    return np.reshape(histories, (*np.shape(frequency), *np.shape(base)))


def largest_oscillator_acceleration(
    base: Floats, frequency: Floats, damping: float, step: float, covered: Flags
) -> Floats:
    """Largest :func:`oscillator_acceleration` at samples `covered` (t,): a shock response spectrum, (f, k)."""
    largest = []
    for omega in frequency:  # one by one: the histories of all need memory
        history = oscillator_acceleration(base, omega, damping, step)[covered]
        largest.append(np.abs(history).max(axis=0, initial=0.0))
    return np.stack(largest)


def _response(
    load: Floats, omega: float, damping: float, step: float, by_place: float, by_rate: float, steady: float
) -> Floats:
    """Output by_place η + by_rate η̇ (t, ...) of one oscillator, rad/s, whose output at rest is `steady` · load."""
    from scipy.signal import lfilter

    damping = damping if damping != 1 else 1 - 1e-9  # one pole for two
    # η = Im w/ω_d of ẇ = λ w + load; after a step h under a load that is straight from u to v, of z = λ h,
    # w e^z + h (φ₁ u + φ₂ (v − u)) with φ₁ = (e^z − 1)/z and φ₂ = (φ₁ − 1)/z.
    damped = omega * math.sqrt(1 - damping**2)
    pole = complex(-damping * omega, damped)
    z = pole * step
    phi1 = np.expm1(z) / z
    phi2 = (phi1 - 1) / z
    # The change is filtered: it starts at rest, without a history.
    w = lfilter([step * phi2, step * (phi1 - phi2)], [1.0, -np.exp(z)], load - load[0], axis=0)
    return np.asarray(((by_place + by_rate * pole) * w).imag / damped + steady * load[0])
