"""A profile that stands still until a time: what the machine is brought up to before it follows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record
from gbeam.motion.profiles.combine import Sum, Vector
from gbeam.motion.profiles.convolution import Convolved, beside
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.series import Series, where


def hold_until(time: float, profile: Profile) -> Profile:
    """Return a profile that has its value at `time` (s) until then, and is itself after.

    Straight lines stay straight lines, so that their smoothing keeps its closed form.
    """
    match profile:
        case PiecewiseLinear() if not is_traced(profile.times, profile.values):
            return _cut(profile, time)
        case Sum():
            return Sum(tuple(hold_until(time, part) for part in profile.parts))
        case Vector():
            x, y, z = (hold_until(time, part) for part in profile.parts)
            return Vector((x, y, z))
    return HeldUntil(time, profile)


def _cut(table: PiecewiseLinear, time: float) -> PiecewiseLinear:
    times, values = np.asarray(table.times), np.asarray(table.values)
    if time <= times[0]:
        return table
    after = times > time
    first = np.asarray(table(time))[None]
    return PiecewiseLinear(np.append(time, times[after]), np.concatenate([first, values[after]]))


@record
class HeldUntil(Profile):
    """A curved profile that is constant until a time, s; see :func:`hold_until`."""

    time: Any
    profile: Profile

    def __post_init__(self) -> None:
        assign(self, time=as_array(self.time))

    def series(self, t: Any, order: int) -> Series:
        """Value and derivatives at times `t` (s)."""
        now = as_array(t)
        inner = self.profile.series(namespace(now, self.time).maximum(now, self.time), order)
        return where(beside(now >= self.time, inner.value.ndim - now.ndim), inner, inner.value)

    @property
    def breaks(self) -> Any:
        """The time, in place of what lies before it, and the breaks after it, s."""
        breaks = self.profile.breaks
        xp = namespace(breaks, self.time)
        return xp.append(self.time, xp.maximum(breaks, self.time))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Knots from the time on, s."""
        return np.unique(np.maximum(self.profile.knots(step), float(self.time)))

    def smoothed(self, width: Any) -> Profile:
        """By quadrature."""
        return Convolved(self, width)
