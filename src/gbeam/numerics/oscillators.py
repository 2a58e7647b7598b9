"""Oscillators under a load known at even times: exact where it runs straight between them (Smallwood's filters)."""

from __future__ import annotations

import warnings

import numpy as np
import scipy.signal
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def _filter(numerator: tuple[float, ...], frequency: float, damping: float, step: float) -> tuple[Floats, Floats]:
    """Ramp-invariant digital filter of numerator/(s² + 2ζωs + ω²)."""
    denominator = (1.0, 2 * damping * frequency, frequency**2)
    with warnings.catch_warnings():
        # A displacement begins with the cube of the step: a small leading coefficient, which scipy takes for an error.
        warnings.simplefilter("ignore", scipy.signal.BadCoefficients)
        b, a, _ = scipy.signal.cont2discrete((numerator, denominator), step, method="foh")
    return np.ravel(b), np.ravel(a)


def displacement(load: Floats, frequency: float, damping: float, step: float) -> Floats:
    """η of η̈ + 2ζω η̇ + ω² η = load (t, ...), starting at rest under the first load."""
    b, a = _filter((1.0,), frequency, damping, step)
    first = load[:1] / frequency**2
    # The filter runs on what changes: it then starts at rest without knowing its own history.
    return np.asarray(scipy.signal.lfilter(b, a, load - load[:1], axis=0)) + first


def riding_acceleration(base: Floats, frequency: float, damping: float, step: float) -> Floats:
    """Absolute acceleration (t, ...) of an oscillator riding on a base with the given acceleration."""
    b, a = _filter((2 * damping * frequency, frequency**2), frequency, damping, step)
    return np.asarray(scipy.signal.lfilter(b, a, base - base[:1], axis=0)) + base[:1]
