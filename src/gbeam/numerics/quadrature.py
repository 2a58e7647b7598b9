"""Integrals over time of what is known at samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def cumulative(time: Floats, value: Floats, slope: Floats) -> Floats:
    """Integral from the first time to each, by the trapezium rule with its end correction: of fourth order.

    `time`, `value`, `slope` (n,).
    """
    step = np.diff(time)
    pieces = step * (value[1:] + value[:-1]) / 2 - step**2 * np.diff(slope) / 12
    return np.append(0.0, np.cumsum(pieces))
