"""Histories sampled over time: runs of samples, values between them, integrals, attitude, peaks and linear filters."""

from __future__ import annotations

import math
from collections.abc import Iterator
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
    kept = np.unique(np.concatenate(ends))
    return x[kept], y[kept]


def interpolated(time: Floats, known: Floats, values: Floats) -> Floats:
    """Values (t, ...) at the times `known`, at `time` (u,): on straight lines, and constant beyond the ends."""
    columns = np.reshape(values, (len(known), -1)).T
    return np.stack([np.interp(time, known, each) for each in columns], axis=1).reshape(-1, *np.shape(values)[1:])


def cumulative(time: Floats, value: Floats, slope: Floats) -> Floats:
    """Integral from the first time to each, (n,), by the trapezium rule with its end correction: of fourth order."""
    step = np.diff(time)
    pieces = step * (value[1:] + value[:-1]) / 2 - step**2 * np.diff(slope) / 12
    return np.append(0.0, np.cumsum(pieces))


def attitude(time: Floats, w_WB_B: Floats) -> Floats:
    """Attitudes since the first time, quaternions (t, 4) w, x, y, z, by body rates (t, 3) rad/s at `time` (t,) s."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_rotvec(0.5 * (w_WB_B[1:] + w_WB_B[:-1]) * np.diff(time)[:, None])
    since = Rotation.concatenate([Rotation.identity(), turns]) if len(turns) else Rotation.from_quat([[0, 0, 0, 1]])
    reach = 1
    while reach < len(since):  # products of 2, 4, 8, ... intervals at once
        since = Rotation.concatenate([since[:reach], since[:-reach] * since[reach:]])
        reach *= 2
    return np.roll(since.as_quat(), 1, axis=1)


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
        kept, lowest = [int(tops[0])], np.inf
        for top, before in zip(tops[1:].tolist(), np.minimum.reduceat(part, tops)[:-1].tolist(), strict=True):
            lowest = min(lowest, before)
            if lowest < dip * min(part[kept[-1]], part[top]):
                kept.append(top)
            elif part[top] > part[kept[-1]]:
                kept[-1] = top
            else:
                continue
            lowest = np.inf
        lows = [first + int(np.argmin(part[first:second])) for first, second in pairwise(kept)]
        edges = [0, *lows, len(part)]
        peaks += [
            (run.start + top, slice(run.start + begin, run.start + end))
            for top, (begin, end) in zip(kept, pairwise(edges), strict=True)
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
    beyond = min(len(values) - 1, math.ceil(1 / (cutoff * step)))
    rows = _rows(values)
    before, after = 2 * rows[:, :1] - rows[:, beyond:0:-1], 2 * rows[:, -1:] - rows[:, -2 : -2 - beyond : -1]
    rows = np.concatenate([before, rows, after], axis=1)
    tangent = math.tan(math.pi * cutoff * step)
    for _ in ("forwards", "backwards"):
        start = rows[:, :1]
        changes = rows - start
        for k in range(ORDER // 2):
            damping = 2 * math.sin((2 * k + 1) * math.pi / (2 * ORDER)) * tangent
            whole = 1 + damping + tangent**2
            denominator = 2 * (tangent**2 - 1) / whole, (1 - damping + tangent**2) / whole
            changes = _filtered(tangent**2 / whole * np.array([1.0, 2.0, 1.0]), denominator, changes)
        rows = (start + changes)[:, ::-1]
    return np.asarray(rows[:, beyond : len(rows[0]) - beyond].T.reshape(np.shape(values)))


def _filtered(numerator: ArrayLike, denominator: tuple[float, float], rows: Floats) -> Floats:
    """Rows (k, t) after a recursive filter of second order, from rest: b (3,), and a₁ and a₂ after a₀ = 1.

    It is a triangular system of three bands, by LAPACK: SciPy's signal processing takes a second to import.
    """
    from scipy.linalg.lapack import dtbtrs

    count = rows.shape[1]
    driven = np.zeros((len(rows), count + 2))
    for delay, weight in enumerate(np.asarray(numerator)):
        driven[:, delay : delay + count] += weight * rows
    bands = np.repeat([[1.0], *([each] for each in denominator)], count, axis=1)
    solution, _ = dtbtrs(bands, driven[:, :count].T, uplo="L")
    return np.asarray(solution.T)


def displacement(load: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """η (f, t, ...) of η̈ + 2ζω η̇ + ω² η = load (t, ...), from rest under the first load; (f,) rad/s, or one."""
    rows = _rows(load)
    histories = [_response(rows, omega, damping, step, 1.0, 0.0, 1 / omega**2).T for omega in np.ravel(frequency)]
    return np.reshape(histories, (*np.shape(frequency), *np.shape(load)))


def riding_acceleration(base: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """Absolute accelerations (f, t, ...) of oscillators (f,) rad/s, from rest on a base with acceleration (t, ...)."""
    histories = [each.T for each in _riding(base, np.ravel(frequency), damping, step)]
    return np.reshape(histories, (*np.shape(frequency), *np.shape(base)))


def largest_riding_acceleration(base: Floats, frequency: Floats, damping: float, step: float, covered: Flags) -> Floats:
    """Largest :func:`riding_acceleration` at samples `covered` (t,): a shock response spectrum, (f, k)."""
    one_by_one = _riding(base, frequency, damping, step)  # all need memory
    return np.stack([np.abs(each[:, covered]).max(axis=1, initial=0.0) for each in one_by_one])


def _riding(base: Floats, frequency: Floats, damping: float, step: float) -> Iterator[Floats]:
    """Absolute acceleration (k, t) of one oscillator after the other on a base with acceleration (t, ...)."""
    rows = _rows(base)
    return (_response(rows, omega, damping, step, omega**2, 2 * damping * omega, 1.0) for omega in frequency)


def _rows(histories: Floats) -> Floats:
    """Histories (t, ...) as rows (k, t), each in one piece of memory."""
    return np.ascontiguousarray(np.reshape(histories, (len(histories), -1)).T)


def _response(
    load: Floats, omega: float, damping: float, step: float, by_place: float, by_rate: float, steady: float
) -> Floats:
    """Output by_place η + by_rate η̇ (k, t) of one oscillator, rad/s, whose output at rest is `steady` · load."""
    damping = damping if damping != 1 else 1 - 1e-9  # one pole for two
    # η = Im w/ω_d of ẇ = λ w + load; after a step h under a load that is straight from u to v, of z = λ h,
    # w e^z + h (φ₁ u + φ₂ (v − u)) with φ₁ = (e^z − 1)/z and φ₂ = (φ₁ − 1)/z.
    damped = omega * math.sqrt(1 - damping**2)
    pole = complex(-damping * omega, damped)
    z = pole * step
    phi1 = np.expm1(z) / z
    phi2 = (phi1 - 1) / z
    read, kept = (by_place + by_rate * pole) / damped * step, np.exp(z)
    now, before = read * phi2, read * (phi1 - phi2)
    # Im of (now + before z⁻¹)/(1 − e^z z⁻¹), widened by the conjugate, has real coefficients.
    numerator = now.imag, (before - now * kept.conjugate()).imag, -(before * kept.conjugate()).imag
    first, denominator = load[:, :1], (-2 * kept.real, abs(kept) ** 2)
    # The change is filtered: it starts at rest, without a history.
    return _filtered(numerator, denominator, load - first) + steady * first
