"""Oscillators under a load known at even times: exact where it runs straight between them (Smallwood's filters)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gbeam.numerics.filters.linear_filter import Filters, largest, run

Floats = NDArray[np.float64]
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
    given = np.reshape(np.asarray(load, dtype=float), (len(load), -1))
    # The filter runs on what changes: it then starts at rest without knowing its own history.
    filters = _filters(np.ravel(frequency), damping, step, np.ravel(by_place), np.ravel(by_rate))
    out = run(filters, given - given[0]) + np.ravel(steady)[:, None, None] * given[0]
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
    """The same by the power series of η under the load t, and its derivatives."""
    terms = [np.zeros_like(omega), np.zeros_like(omega), np.full_like(omega, step**3 / 6)]  # of steps¹, ², ³
    for k in range(2, _TERMS):
        last, one_before = terms[-1], terms[-2]
        push = 2 * damping * omega * step * (k + 1) * last + (omega * step) ** 2 * one_before
        terms.append(-push / ((k + 2) * (k + 1)))
    series, power = np.stack(terms), np.arange(1, len(terms) + 1)[:, None]
    return np.stack([series.sum(0), (power * series).sum(0) / step, (power * (power - 1) * series).sum(0) / step**2])
