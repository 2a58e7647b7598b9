"""Linear filters: a low-pass without phase, and oscillators under a load known at even times."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gbeam.errors import InputError

Floats = NDArray[np.float64]

ORDER = 4


def low_pass(values: Floats, step: float, cutoff: float) -> Floats:
    """Butterworth low-pass of fourth order, run forwards and backwards: no phase, −6 dB at the cut-off.

    The ends are continued by their point reflection over one period of the cut-off, as far as the samples reach.

    `values` (t, ...).
    """
    if not 0 < cutoff < 0.5 / step:
        raise InputError(
            "cutoff", f"is {cutoff:g} Hz, with samples {step:g} s apart", f"give more than 0, below {0.5 / step:g} Hz"
        )
    import scipy.signal

    sections = scipy.signal.butter(ORDER, cutoff, fs=1 / step, output="sos")
    beyond = min(len(values) - 1, math.ceil(1 / (cutoff * step)))
    return np.asarray(scipy.signal.sosfiltfilt(sections, values, axis=0, padlen=beyond))


_BLOCK = 32  # samples: longer blocks multiply more, shorter ones turn the loop more often
_WIDTH = 128  # columns of one product
_TOGETHER = 12  # filters whose outputs fit a processor's cache


class Filters(NamedTuple):
    """x[n+1] = A x[n] + B u[n], y[n] = C x[n] + D u[n]: A (f, 2, 2), B and C (f, 2), D (f,), one for each filter."""

    a: Floats
    b: Floats
    c: Floats
    d: Floats


def run(filters: Filters, values: Floats) -> Floats:
    """Return every filter's output for every column, from rest.

    `values` (t, k); returns (f, t, k).
    """
    y = _in_blocks(filters, values)
    return y.swapaxes(2, 3).reshape(len(y), -1, values.shape[1])[:, : len(values)]


def largest(filters: Filters, values: Floats, offset: Floats, covered: NDArray[np.bool_]) -> Floats:
    """Return the largest size of every filter's output, from rest, plus an offset.

    `values` (t, k), `offset` (k,), `covered` (t,); returns (f, k).
    """
    sizes = []
    for i in range(0, len(filters.d), _TOGETHER):
        y = _in_blocks(Filters(*(each[i : i + _TOGETHER] for each in filters)), values)
        y += offset
        side = y.shape[3]
        y *= _arranged(covered[:, None], side)
        # First over what keeps the rows long: a reduction over short ones takes ten times as long.
        rows = y.reshape(len(y), -1, side * values.shape[1])
        size = np.maximum(rows.max(axis=1), -rows.min(axis=1))
        sizes.append(size.reshape(len(y), side, -1).max(axis=1))
    return np.concatenate(sizes)


def _arranged(values: Floats | NDArray[np.bool_], side: int) -> Floats:
    """Samples (t, k) as (segments, block, blocks of a segment, k), zeros at the end; `side` blocks to a segment."""
    samples, columns = values.shape
    segments = -(-samples // (side * _BLOCK))
    padded = np.zeros((segments * side * _BLOCK, columns))
    padded[:samples] = values
    return np.ascontiguousarray(padded.reshape(segments, side, _BLOCK, columns).swapaxes(1, 2))


def _in_blocks(filters: Filters, values: Floats) -> Floats:
    """Outputs (f, segments, block, blocks of a segment, k)."""
    a, b, c, d = filters
    count, columns = len(d), values.shape[1]
    side = min(max(1, _WIDTH // columns), -(-len(values) // _BLOCK))
    u = _arranged(values, side).reshape(-1, _BLOCK, side * columns)
    powers = [np.broadcast_to(np.eye(2), a.shape)]
    for _ in range(_BLOCK):
        powers.append(a @ powers[-1])
    from_state = np.stack([(c[:, None] @ p)[:, 0] for p in powers[:-1]], axis=1)  # C Aⁿ, (f, block, 2)
    to_state = np.stack([(p @ b[:, :, None])[:, :, 0] for p in powers[-2::-1]], axis=2)  # Aⁿ B, (f, 2, block)
    impulse = np.concatenate([d[:, None], (from_state[:, :-1] @ b[:, :, None])[:, :, 0]], axis=1)
    lag = np.subtract.outer(np.arange(_BLOCK), np.arange(_BLOCK))
    response = np.where(lag >= 0, impulse[:, np.maximum(lag, 0)], 0.0)

    gained = (to_state[:, None] @ u).reshape(count, -1, 2, side, columns)
    gained = np.ascontiguousarray(gained.transpose(1, 3, 0, 2, 4)).reshape(-1, count, 2, columns)
    state = np.zeros_like(gained)  # at the start of each block
    for n in range(1, len(state)):
        np.matmul(powers[-1], state[n - 1], out=state[n])
        state[n] += gained[n - 1]
    state = state.reshape(-1, side, count, 2, columns).transpose(2, 0, 3, 1, 4).reshape(count, -1, 2, side * columns)
    y = response[:, None] @ u
    y += from_state[:, None] @ state
    return y.reshape(count, -1, _BLOCK, side, columns)


_TERMS = 24  # of a series for an angle below 2 per sample: the last is below 1e-17
_SMALL = 1.0  # angle per sample below which closed forms lose digits and the series is taken


def displacement(load: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """η of η̈ + 2ζω η̇ + ω² η = load, starting at rest under the first load.

    `load` (t, ...), `frequency` (f,) rad/s; returns (t, ...).
    """
    omega = np.asarray(frequency, dtype=float)
    return _responses(load, omega, damping, step, np.ones_like(omega), np.zeros_like(omega), 1 / omega**2)


def riding_acceleration(base: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """Absolute acceleration of oscillators riding on a base with the given acceleration, starting at rest on it."""
    omega = np.asarray(frequency, dtype=float)
    return _responses(base, omega, damping, step, omega**2, 2 * damping * omega, np.ones_like(omega))


def largest_riding_acceleration(
    base: Floats, frequency: Floats, damping: float, step: float, covered: NDArray[np.bool_]
) -> Floats:
    """Largest size of :func:`riding_acceleration` at the samples `covered` (t,): a shock response spectrum, (f, k).

    `base` (t, k), `frequency` (f,) rad/s.
    """
    filters = _filters(frequency, damping, step, frequency**2, 2 * damping * frequency)
    return largest(filters, base - base[0], base[0], covered)


def _responses(
    load: Floats, frequency: Floats, damping: float, step: float, by_place: Floats, by_rate: Floats, steady: Floats
) -> Floats:
    """Outputs by_place η + by_rate η̇; `steady` is that of a unit load."""
    loads = np.reshape(np.asarray(load, dtype=float), (len(load), -1))
    # The filter runs on what changes: it then starts at rest without knowing its own history.
    filters = _filters(np.ravel(frequency), damping, step, np.ravel(by_place), np.ravel(by_rate))
    out = run(filters, loads - loads[0]) + np.ravel(steady)[:, None, None] * loads[0]
    return out.reshape(*np.shape(frequency), *np.shape(load))


def _filters(omega: Floats, damping: float, step: float, by_place: Floats, by_rate: Floats) -> Filters:
    """State (η, η̇) from sample to sample, without the share of the newest load, which acts at once."""
    small = omega * step < _SMALL
    ramp, unit, impulse = np.where(small, _series(omega, damping, step), _closed_form(omega, damping, step))
    free = np.array([[1 - omega**2 * unit, impulse], [-(omega**2) * impulse, 1 - omega**2 * unit]])
    free[1, 1] -= 2 * damping * omega * impulse
    free = np.moveaxis(free, 2, 0)
    # A load that runs straight from u0 to u1 is a step of u0 and a ramp of u1 − u0.
    new = np.stack([ramp, unit], axis=1) / step
    old = np.stack([unit, impulse], axis=1) - new
    output = np.stack([by_place, by_rate], axis=1)
    return Filters(free, np.einsum("fij,fj->fi", free, new) + old, output, np.einsum("fi,fi->f", output, new))


def _closed_form(omega: Floats, damping: float, step: float) -> Floats:
    """η after one step from rest under the load t, under a unit load, and after a unit impulse, (3, f)."""
    damped = omega * np.sqrt(1 - damping**2)
    decay, turn = np.exp(-damping * omega * step), damped * step
    impulse = decay * np.sin(turn) / damped
    unit = (1 - decay * np.cos(turn) - damping * omega * impulse) / omega**2
    return np.stack([(step - impulse - 2 * damping * omega * unit) / omega**2, unit, impulse])


def _series(omega: Floats, damping: float, step: float) -> Floats:
    """Value by the power series of η under the load t, and its derivatives."""
    terms = [np.zeros_like(omega), np.zeros_like(omega), np.full_like(omega, step**3 / 6)]  # of steps¹, ², ³
    for k in range(2, _TERMS):
        last, one_before = terms[-1], terms[-2]
        push = 2 * damping * omega * step * (k + 1) * last + (omega * step) ** 2 * one_before
        terms.append(-push / ((k + 2) * (k + 1)))
    series, power = np.stack(terms), np.arange(1, len(terms) + 1)[:, None]
    return np.stack([series.sum(0), (power * series).sum(0) / step, (power * (power - 1) * series).sum(0) / step**2])
