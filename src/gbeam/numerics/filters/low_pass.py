"""A low-pass filter that shifts nothing in time: it conditions records and parts trend from vibration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.numerics.filters.linear_filter import Filters, run

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
    x = np.reshape(np.asarray(values, dtype=float), (len(values), -1))
    beyond = min(len(x) - 1, int(np.ceil(1 / (cutoff * step))))
    before, after = 2 * x[0] - x[beyond:0:-1], 2 * x[-1] - x[-2 : -beyond - 2 : -1]
    sections = _sections(np.tan(np.pi * cutoff * step))
    forward = _steady(sections, np.concatenate([before, x, after]))
    there_and_back = _steady(sections, forward[::-1])[::-1]
    return there_and_back[beyond : beyond + len(x)].reshape(np.shape(values))


def _sections(k: float) -> list[Filters]:
    """Pairs of poles by the bilinear transform, k being the tangent of half the cut-off's angle per sample."""
    angles = np.pi * (np.arange(ORDER // 2) + 0.5) / ORDER
    return [_biquad(k, 2 * np.cos(angle)) for angle in angles]


def _biquad(k: float, width: float) -> Filters:
    """k²/(s² + width k s + k²), s = (z − 1)/(z + 1), as a state-space filter in transposed direct form."""
    scale = 1 / (1 + width * k + k**2)
    b = k**2 * scale  # numerator b (1 + 2/z + 1/z²)
    a1, a2 = 2 * (k**2 - 1) * scale, (1 - width * k + k**2) * scale
    return Filters(
        a=np.array([[[-a1, 1.0], [-a2, 0.0]]]),
        b=np.array([[b * (2 - a1), b * (1 - a2)]]),
        c=np.array([[1.0, 0.0]]),
        d=np.array([b]),
    )


def _steady(sections: list[Filters], values: Floats) -> Floats:
    """Run sections in turn over (t, k), as if the first sample had lasted for ever before."""
    y = values - values[0]
    for section in sections:
        (y,) = run(section, y)
    return np.asarray(y + values[0])
