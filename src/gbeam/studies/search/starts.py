"""Where searches begin that look for more than the nearest valley, and how many of them end in one place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import refuse_more
from gbeam.results.result import Floats

MAX_STARTS = 1000
_SAME = 1e-2  # of the bounds' width: values that are nearer are the same
_WIDE = 10.0  # times: bounds further apart are searched in equal ratios


def starting_points(own: Floats, limits: Floats, count: int) -> list[Floats]:
    """The scenario's values (p,), and further ones spread evenly between bounds (p, 2), by a Sobol sequence.

    Raises
    ------
    InputError
        If there is less than one, or there are very many.
    """
    if count < 1:
        raise InputError("--starts", f"is {count}", "give one or more")
    refuse_more("--starts", "searches", count, MAX_STARTS, 1e5, "give fewer")
    if count == 1:
        return [own]
    from scipy.stats import qmc  # half a second

    low, high = limits.T
    sequence = qmc.Sobol(len(own), rng=0).random_base2(max(1, int(np.ceil(np.log2(count - 1)))))
    share = sequence[: count - 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = high / low
        wide = (low > 0) & (ratio > _WIDE)
        points = np.where(wide, low * ratio**share, low + share * (high - low))
    return [own, *points]


def agreeing(ends: Sequence[Floats], best: Floats, limits: Floats) -> int:
    """How many of the values that searches ended at are the best ones."""
    width = limits[:, 1] - limits[:, 0]
    return sum(bool((np.abs(end - best) <= _SAME * width).all()) for end in ends)
