"""A profile that stands still before one time and after another."""

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

_PER_WIDTH = 40  # knots per width of a kernel: straight lines between them are within a thousandth of a jump


def clamped(profile: Profile, first: float, last: float) -> Profile:
    """Return a profile that is itself from `first` to `last` (s), and keeps its values there before and after.

    Straight lines stay straight lines, so that their smoothing keeps its closed form.
    """
    match profile:
        case PiecewiseLinear() if not is_traced(profile.times, profile.values):
            return _cut(profile, first, last)
        case Sum():
            return Sum(tuple(clamped(part, first, last) for part in profile.parts))
        case Vector():
            x, y, z = (clamped(part, first, last) for part in profile.parts)
            return Vector((x, y, z))
    return Clamped(profile, first, last)


def _cut(table: PiecewiseLinear, first: float, last: float) -> PiecewiseLinear:
    times = np.asarray(table.times)
    if first <= times[0] and times[-1] <= last:
        return table
    inside = np.concatenate([[first], times[(times > first) & (times < last)], [last]])
    return PiecewiseLinear(inside, table(inside))


@record
class Clamped(Profile):
    """A curved profile that is constant before one time and after another, s; see :func:`clamped`."""

    profile: Profile
    first: Any
    last: Any

    def __post_init__(self) -> None:
        assign(self, first=as_array(self.first), last=as_array(self.last))

    def series(self, t: Any, order: int) -> Series:
        """Value and derivatives at times `t` (s)."""
        now = as_array(t)
        inner = self.profile.series(namespace(now, self.first, self.last).clip(now, self.first, self.last), order)
        inside = (now >= self.first) & (now <= self.last)  # the ends themselves belong to it, with their derivatives
        return where(beside(inside, inner.value.ndim - now.ndim), inner, inner.value)

    @property
    def breaks(self) -> Any:
        """The two times, in place of what lies beyond them, and the breaks between, s."""
        breaks = self.profile.breaks
        xp = namespace(breaks, self.first, self.last)
        between = xp.clip(breaks, self.first, self.last)
        return xp.concatenate([self.first[None], between, self.last[None]])

    def corners(self, step: float) -> NDArray[np.float64]:
        """The two times and the corners between, s."""
        first, last = float(self.first), float(self.last)
        return np.concatenate([[first], np.clip(self.profile.corners(step), first, last), [last]])

    def knots(self, step: float) -> NDArray[np.float64]:
        """Knots between the two times, s."""
        return np.unique(np.clip(self.profile.knots(step), float(self.first), float(self.last)))

    def smoothed(self, width: Any) -> Profile:
        """By quadrature; of a table where the profile is itself one, since one within the other costs minutes."""
        inner = self.profile
        if not isinstance(inner, Convolved) or is_traced(width, inner.width, self.first, self.last):
            return Convolved(self, width)
        times = self.knots(min(float(width), float(inner.width)) / _PER_WIDTH)
        return PiecewiseLinear(times, self(times)).smoothed(width)
