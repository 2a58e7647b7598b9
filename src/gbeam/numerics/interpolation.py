"""Histories at other times than their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def interpolated(time: Floats, own: Floats, values: Floats) -> Floats:
    """Values (t, ...) known at the times `own`, at `time`: on straight lines, and constant beyond the ends.

    `time` (u,), `own` (t,).
    """
    if len(own) >= len(time) and np.array_equal(own[: len(time)], time):
        return values[: len(time)]
    if len(own) == 1:
        return np.repeat(values, len(time), axis=0)
    after = np.clip(np.searchsorted(own, time), 1, len(own) - 1)
    share = np.clip((time - own[after - 1]) / (own[after] - own[after - 1]), 0.0, 1.0)
    share = share.reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(values[after - 1] + share * (values[after] - values[after - 1]))
