"""A low-pass filter that shifts nothing in time: what conditions records and tells trend from vibration."""

from __future__ import annotations

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from gbeam.errors import InputError

Floats = NDArray[np.float64]
ORDER = 4


def low_pass(values: Floats, step: float, cutoff: float) -> Floats:
    """Butterworth low-pass of fourth order, run forwards and backwards: no phase, −6 dB at the cut-off.

    The ends are continued by their point reflection over one period of the cut-off, as far as the samples reach.

    Parameters
    ----------
    values : (t, ...)
        Evenly spaced.
    step : float
        Interval, s.
    cutoff : float
        Hz.

    Raises
    ------
    InputError
        If the cut-off is not between zero and half the sampling rate.
    """
    if not 0 < cutoff < 0.5 / step:
        raise InputError(
            "cutoff", f"is {cutoff:g} Hz, with samples {step:g} s apart", f"give more than 0, below {0.5 / step:g} Hz"
        )
    sections = scipy.signal.butter(ORDER, 2 * cutoff * step, output="sos")
    reach = min(len(values) - 1, int(np.ceil(1 / (cutoff * step))))
    return np.asarray(scipy.signal.sosfiltfilt(sections, values, axis=0, padtype="odd", padlen=reach))
