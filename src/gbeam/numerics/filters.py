"""Linear filters: a low-pass without phase, and oscillators under a load known at even times."""

from __future__ import annotations

import math

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


def displacement(load: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """η of η̈ + 2ζω η̇ + ω² η = load, starting at rest under the first load.

    `load` (t, ...), `frequency` (f,) rad/s, or one; returns (f, t, ...).
    """
    every = [_response(load, omega, damping, step, 1.0, 0.0, 1 / omega**2) for omega in np.ravel(frequency)]
    return np.reshape(every, (*np.shape(frequency), *np.shape(load)))


def riding_acceleration(base: Floats, frequency: ArrayLike, damping: float, step: float) -> Floats:
    """Absolute acceleration of oscillators riding on a base with the given acceleration, starting at rest on it."""
    every = [_response(base, omega, damping, step, omega**2, 2 * damping * omega, 1.0) for omega in np.ravel(frequency)]
    return np.reshape(every, (*np.shape(frequency), *np.shape(base)))


def largest_riding_acceleration(
    base: Floats, frequency: Floats, damping: float, step: float, covered: NDArray[np.bool_]
) -> Floats:
    """Largest size of :func:`riding_acceleration` at the samples `covered` (t,): a shock response spectrum, (f, k).

    `base` (t, k), `frequency` (f,) rad/s.
    """
    one_by_one = (riding_acceleration(base, omega, damping, step)[covered] for omega in frequency)  # all need memory
    return np.stack([np.abs(each).max(axis=0, initial=0.0) for each in one_by_one])


def _response(
    load: Floats, omega: float, damping: float, step: float, by_place: float, by_rate: float, steady: float
) -> Floats:
    """Output by_place η + by_rate η̇ of one oscillator; `steady` is that of a unit load."""
    from scipy.signal import lfilter

    damping = damping if damping != 1 else 1 - 1e-9  # one pole for two
    # η = Im w/ω_d of ẇ = λ w + load; after a step h under a load that is straight from u to v, of z = λ h,
    # w e^z + h (φ₁ u + φ₂ (v − u)) with φ₁ = (e^z − 1)/z and φ₂ = (φ₁ − 1)/z.
    damped = omega * math.sqrt(1 - damping**2)
    pole = complex(-damping * omega, damped)
    z = pole * step
    even = np.expm1(z) / z
    rising = (even - 1) / z
    # What changes is filtered: it starts at rest without a history of its own.
    w = lfilter([step * rising, step * (even - rising)], [1.0, -np.exp(z)], load - load[0], axis=0)
    return np.asarray(((by_place + by_rate * pole) * w).imag / damped + steady * load[0])
