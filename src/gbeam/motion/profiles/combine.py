"""Profiles made of others: sums, vectors, and sizes that are clamped."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats
from gbeam.errors import InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Seconds, Times
from gbeam.motion.profiles.piecewise import PiecewiseLinear, constant
from gbeam.motion.profiles.profile import Convolved, Profile, append_axes
from gbeam.numerics.series import Series, stack, where

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary


class _Combined(Profile):
    """A profile made of others, whose times are all of theirs."""

    parts: Sequence[Profile]

    @property
    def breaks(self) -> Any:
        return merged_breaks(*self.parts)

    def corners(self, step: Seconds) -> Floats:
        return np.unique(np.concatenate([part.corners(step) for part in self.parts]))

    def knots(self, step: Seconds) -> Floats:
        return np.unique(np.concatenate([part.knots(step) for part in self.parts]))

    @property
    def extent(self) -> tuple[float, float] | None:
        return merged_extent(*self.parts)


@typed
@record
class Sum(_Combined):
    """Sum of profiles of the same unit.

    Parameters
    ----------
    parts : sequence of Profile
        One or more, all scalar or all vectors.

    Raises
    ------
    InputError
        If there is no part.

    Examples
    --------
    >>> profile = gb.Sum((gb.constant(1.0), gb.Sine(amplitude=2.0, duration=4.0)))
    >>> print(profile.derivatives(1.0, 0)[0])
    3.0
    """

    parts: Sequence[Profile]

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("parts", "is empty", "list one profile or more")
        object.__setattr__(self, "parts", tuple(self.parts))

    def series(self, t: Times, order: int) -> Series:
        return reduce(add, (part.series(t, order) for part in self.parts))

    def smoothed(self, width: Times) -> Profile:
        # Convolution is linear.
        return Sum(tuple(part.smoothed(width) for part in self.parts))


@record
class Vector(_Combined):
    """A vector profile made of three scalar ones; see :func:`vector`."""

    parts: tuple[Profile, Profile, Profile]

    def series(self, t: Times, order: int) -> Series:
        return stack([part.series(t, order) for part in self.parts])

    def smoothed(self, width: Times) -> Profile:
        x, y, z = (part.smoothed(width) for part in self.parts)
        return Vector((x, y, z))


@record
class Turned(Profile):
    """A vector profile in other axes: `matrix` (3, 3) times another."""

    profile: Profile
    matrix: Any

    def series(self, t: Times, order: int) -> Series:
        return self.profile.series(t, order).map(lambda c: c @ self.matrix.T)

    @property
    def breaks(self) -> Any:
        return self.profile.breaks

    def corners(self, step: Seconds) -> Floats:
        return self.profile.corners(step)

    def knots(self, step: Seconds) -> Floats:
        return self.profile.knots(step)

    @property
    def extent(self) -> tuple[float, float] | None:
        return self.profile.extent

    @property
    def record(self) -> RecordSummary | None:
        return self.profile.record

    def smoothed(self, width: Times) -> Profile:
        return Turned(self.profile.smoothed(width), self.matrix)


@typed
def vector(x: Any | None = None, y: Any | None = None, z: Any | None = None) -> Vector:
    """Return the vector profile of three components. One left out is zero.

    Parameters
    ----------
    x, y, z : Profile or float, optional
        Scalars in base axes, of one unit.

    Raises
    ------
    InputError
        If a component is no scalar.

    Examples
    --------
    >>> load = gb.vector(x=gb.constant(9.81), z=gb.Sine(20.0, 4.0))
    >>> print(load.derivatives(1.0, 0)[0])
    [ 9.81  0.   20.  ]
    """
    parts = [
        as_profile(name, 0.0 if component is None else component) for name, component in (("x", x), ("y", y), ("z", z))
    ]
    return Vector((parts[0], parts[1], parts[2]))


def as_profile(where: str, value: Any, components: int = 1) -> Profile:
    """The profile itself, or a constant one of a number or of three. InputError unless it has as many `components`."""
    if isinstance(value, Profile):
        profile = value
    else:
        with naming(where):
            profile = constant(value)
    shape = np.shape(profile(0.0))
    if shape != (() if components == 1 else (components,)):
        shape_words = "a scalar" if shape == () else "a vector" if shape == (3,) else f"an array of shape {shape}"
        fix = "give a scalar; a vector goes by name, acceleration = ..." if components == 1 else "give x, y and z"
        raise InputError(where, f"is {shape_words}", fix)
    return profile


def merged_extent(*profiles: Profile) -> tuple[float, float] | None:
    """From the first time of any of the profiles to the last, s, or None if all are constant."""
    ends = [profile.extent for profile in profiles if profile.extent is not None]
    return (min(first for first, _ in ends), max(last for _, last in ends)) if ends else None


def merged_breaks(*profiles: Profile) -> Any:
    """Times of all the profiles' jumps, ascending, s."""
    breaks = [profile.breaks for profile in profiles]
    xp = namespace(*breaks)
    return xp.sort(xp.concatenate(breaks))


_PER_WIDTH = 40  # knots per width of a kernel: straight lines between them are within a thousandth of a jump


def clamped(profile: Profile, first: float, last: float) -> Profile:
    """Return a profile that keeps its values before `first` and after `last` (s). Lines keep their closed smoothing."""
    match profile:
        case PiecewiseLinear() if not is_traced(profile.times, profile.values):
            return _cut(profile, first, last)
        case Sum():
            return Sum(tuple(clamped(part, first, last) for part in profile.parts))
        case Vector():
            x, y, z = (clamped(part, first, last) for part in profile.parts)
            return Vector((x, y, z))
        case Turned():
            return Turned(clamped(profile.profile, first, last), profile.matrix)
    return Clamped(profile, first, last)


def _cut(table: PiecewiseLinear, first: float, last: float) -> PiecewiseLinear:
    """The table from `first` to `last`, s, with knots there."""
    times = np.asarray(table.times)
    if first <= times[0] and times[-1] <= last:
        return table
    inside = np.concatenate([[first], times[(times > first) & (times < last)], [last]])
    return PiecewiseLinear(inside, table(inside))


@record
class Clamped(Profile):
    """A curved profile that is constant before one time and after another, s; see :func:`clamped`."""

    profile: Profile
    first: Times
    last: Times

    def __post_init__(self) -> None:
        assign(self, first=as_array(self.first), last=as_array(self.last))

    def series(self, t: Times, order: int) -> Series:
        time = as_array(t)
        inner = self.profile.series(namespace(time, self.first, self.last).clip(time, self.first, self.last), order)
        inside = (time >= self.first) & (time <= self.last)  # the ends themselves belong to it, with their derivatives
        return where(append_axes(inside, inner.value.ndim - time.ndim), inner, inner.value)

    @property
    def breaks(self) -> Any:
        """The two times, in place of what lies beyond them, and the breaks between, s."""
        breaks = self.profile.breaks
        xp = namespace(breaks, self.first, self.last)
        inner_breaks = xp.clip(breaks, self.first, self.last)
        return xp.concatenate([self.first[None], inner_breaks, self.last[None]])

    def corners(self, step: Seconds) -> Floats:
        """The two times and the corners between, s."""
        first, last = float(self.first), float(self.last)
        return np.concatenate([[first], np.clip(self.profile.corners(step), first, last), [last]])

    def knots(self, step: Seconds) -> Floats:
        return np.unique(np.clip(self.profile.knots(step), float(self.first), float(self.last)))

    def smoothed(self, width: Times) -> Profile:
        """By quadrature; if the profile is a convolution itself, of a table of it: nested quadrature costs minutes."""
        inner = self.profile
        if not isinstance(inner, Convolved) or is_traced(width, inner.width, self.first, self.last):
            return Convolved(self, width)
        times = self.knots(min(float(width), float(inner.width)) / _PER_WIDTH)
        return PiecewiseLinear(times, self(times)).smoothed(width)
