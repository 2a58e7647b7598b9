"""How wide a load's corners must be rounded before an arm can follow them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gbeam.motion.centrifuge.target.load_limits import MIN_TRANSVERSE_LOAD, UNTOUCHED
from gbeam.motion.profiles.profile import Profile

_WIDEST, _LADDER = 3.0, 1.05  # s; ratio of two widths tried one after the other
_LEAST = 0.01  # s: the first width tried where there is no smoothing
_PER_WIDTH = 30  # times over the narrowest kernel
_QUICK = 512
_ROUNDING = 1e-3  # of what the arm allows: what finite differences leave

Floats = NDArray[np.float64]


def required_smoothing(
    corners: Profile, gravity: float, idle: float, arm: float, time: Floats, runs: Sequence[slice], width: float
) -> list[float | None]:
    """For each stretch of times, the smallest smoothing with which nothing in it turns too sharply for the arm.

    It is found by trying: on a slope that gravity bends, −ä <= a²/R may need more than a corner's 2jR/a², or be out of
    any smoothing's reach.

    `time` (t,) s.
    """
    step = min(float(time[1] - time[0]), max(width, _LEAST) / _PER_WIDTH)
    count = np.ceil((time[-1] - time[0] + _WIDEST) / step)
    # A number of times whose Fourier transform is quick.
    times = time[0] - _WIDEST / 2 + step * np.arange(_QUICK * int(np.ceil(count / _QUICK)))
    spectrum = np.fft.rfft(corners(times), axis=0)
    ends = [(float(time[run.start]), float(time[run.stop - 1])) for run in runs]
    widths: list[float | None] = [None] * len(runs)
    wide = max(width, _LEAST / _LADDER) * _LADDER
    index = np.arange(times.size)
    offset = np.minimum(index, times.size - index) * step
    across = MIN_TRANSVERSE_LOAD if gravity else 0.0
    while None in widths and wide <= _WIDEST:
        kernel = np.where(offset < wide / 2, 1 + np.cos(2 * np.pi * offset / wide), 0.0)
        load = np.fft.irfft(spectrum * np.fft.rfft(kernel / kernel.sum())[:, None], times.size, axis=0)
        total = np.linalg.norm(load, axis=1)
        is_held = (total < UNTOUCHED * idle) | (np.linalg.norm(load[:, 1:], axis=1) < across)
        size = np.sqrt(np.maximum(total**2 - gravity**2, 1e-12))
        turn = -np.gradient(np.gradient(size, step), step)
        sharp = times[(turn > size**2 / arm * (1 + _ROUNDING)) & ~is_held]
        for i, (start, end) in enumerate(ends):
            if widths[i] is None and not np.any((sharp > start - wide / 2) & (sharp < end + wide / 2)):
                widths[i] = wide
        wide *= _LADDER
    return widths
