"""Piecewise-linear profiles: constant, trapezoid, table. Their Hann smoothing has a closed form."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record, static
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import finite, positive
from gbeam.guards.quantities import OfProfile, Quantity, Seconds, Times
from gbeam.motion.profiles.profile import TOGETHER, Profile, Rounded, append_axes, hann_orders
from gbeam.numerics.series import Series

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary


@record
class PiecewiseLinear(Profile):
    """Straight between knots, constant before the first and after the last. One knot makes a constant."""

    times: Any  # of the knots, (k,) s, strictly increasing
    values: Any  # (k,) or (k, 3)
    slopes: Any  # of the k + 1 segments, the outer two level, (k + 1,) or (k + 1, 3)
    summary: RecordSummary | None = static()  # of the flight's record that it is

    def __init__(self, times: Times, values: Any, *, record: RecordSummary | None = None) -> None:
        """Refuse times and values that make no profile, and compute the slopes between them."""
        t, v = (array[None] if array.ndim == 0 else array for array in (as_array(times), as_array(values)))
        if t.ndim != 1 or t.size == 0:
            raise InputError("times", f"has shape {t.shape}", "give a list of one time or more")
        if len(v) != len(t):
            raise InputError("values", f"has {len(v)} entries for {len(t)} times", "give one value per time")
        for name, array in (("times", t), ("values", v)):
            _refuse_infinite(name, array)
        if not is_traced(t):
            _refuse_unordered(np.asarray(t))
        xp = namespace(t, v)
        level = xp.zeros((1, *v.shape[1:]))
        with np.errstate(over="ignore"):
            rise = xp.diff(v, axis=0) / append_axes(xp.diff(t), v.ndim - 1)
        if not is_traced(t, v):
            _refuse_steep(np.asarray(t), np.asarray(rise))
        assign(self, times=t, values=v, slopes=xp.concatenate([level, rise, level]), summary=record)

    def series(self, t: Times, order: int) -> Series:
        time = as_array(t)
        xp = namespace(time, self.times)
        return _line(self, time, xp.searchsorted(xp.asarray(self.times), time, side="right"), order)

    @property
    def breaks(self) -> Any:
        return self.times

    @property
    def record(self) -> RecordSummary | None:
        return self.summary

    def corners(self, step: Seconds) -> Floats:
        bent = (np.diff(np.asarray(self.slopes), axis=0) != 0).reshape(len(self.times), -1).any(axis=1)
        return np.asarray(self.times)[bent]

    def knots(self, step: Seconds) -> Floats:
        return np.asarray(self.times)

    def smoothed(self, width: Times) -> Profile:
        """Closed form: the straight pieces, with a rounded ramp at each knot near by."""
        return SmoothedPiecewiseLinear(self, width)


def _refuse_infinite(name: str, array: Any) -> None:
    if is_traced(array):
        return
    bad = np.flatnonzero(~np.isfinite(np.asarray(array).reshape(len(array), -1)).all(axis=1))
    if bad.size:
        raise InputError(f"{name}[{bad[0]}]", "is not finite", "give a finite number")


def _refuse_unordered(times: Floats) -> None:
    back = np.flatnonzero(np.diff(times) <= 0)
    if back.size:
        i = int(back[0])
        problem = f"is {times[i + 1]:g} s, after {times[i]:g} s"
        raise InputError(f"times[{i + 1}]", problem, "list times in strictly increasing order")


def _refuse_steep(times: Floats, rise: Floats) -> None:
    steep = np.argwhere(~np.isfinite(rise))
    if steep.size:
        i = int(steep[0, 0])
        problem = f"is {times[i + 1]:g} s, so near {times[i]:g} s that the slope is not finite"
        raise InputError(f"times[{i + 1}]", problem, "list times farther apart")


def _line(table: PiecewiseLinear, t: Any, segment: Any, order: int) -> Series:
    """Value and slope at `t` of the straight line through `segment` (0 before the first knot, k after the last)."""
    xp = namespace(t, segment, table.times, table.values)
    times, values, slopes = (xp.asarray(array) for array in (table.times, table.values, table.slopes))
    start = xp.maximum(segment - 1, 0)  # anchored in its own segment: no sum of slopes to lose digits in
    slope = slopes[segment]
    return Series.from_derivatives(
        [values[start] + slope * append_axes(t - times[start], values.ndim - 1), slope], order
    )


@record
class SmoothedPiecewiseLinear(Rounded):
    """Convolution of a piecewise-linear profile with the Hann kernel, exact and three times differentiable.

    Notes
    -----
    With Δ_i the change of slope at knot t_i, f(t) = line(t) + Σ Δ_i W h((t − t_i)/W), where `line` is the
    segment at t − W/2 prolonged, h the rounded ramp (:func:`~gbeam.motion.profiles.profile.hann`) and the sum runs
    over the knots within W/2 of t: later ones have not acted yet, earlier ones are in `line`. So the cost does
    not grow with the table.
    """

    table: PiecewiseLinear
    bends: Any  # change of slope at each knot, and a zero for indices past the end, (k + 1,) or (k + 1, 3)
    times: Any  # of the knots, the last twice, (k + 1,)
    width: Times
    count: int = static()  # most knots that one window can hold

    def __init__(self, table: PiecewiseLinear, width: Times) -> None:
        """Compute the bends at the knots, and how many knots one window of the kernel can hold."""
        t, slopes, width = table.times, table.slopes, as_array(width)
        xp = namespace(t, slopes)
        count = t.size
        if not is_traced(t, width):
            ends = np.searchsorted(t, t + width, side="right")
            # One more, since t − W/2 is rounded; then rounded up, so that widths share their programs.
            count = 8 * -(-(int(np.max(ends - np.arange(t.size))) + 1) // 8)
        bends = xp.concatenate([xp.diff(slopes, axis=0), xp.zeros_like(slopes[:1])])
        assign(self, table=table, bends=bends, times=xp.append(t, t[-1]), width=width, count=count)

    def series(self, t: Times, order: int) -> Series:
        """Values and derivatives at times `t`, s: the line at the window's begin, and a rounded ramp for each bend."""
        time = as_array(t)
        xp = namespace(time, self.times, self.bends, self.width)
        times, bends = xp.asarray(self.times), xp.asarray(self.bends)
        first, count = xp.searchsorted(times[:-1], time - self.width / 2, side="right"), self.count
        if xp is np and time.size:  # no more knots than the windows of these times hold
            count = int((np.searchsorted(times[:-1], time + self.width / 2, side="right") - first).max())
            if time.ndim == 1 and time.size * count > TOGETHER:
                return Series.in_pieces(
                    lambda piece: self.series(piece, order), time, 1 + time.size * count // TOGETHER
                )
        # Each knot in the window adds its bend times a rounded ramp.
        knots = xp.minimum(first[..., None] + np.arange(count), times.size - 1)
        ramps = hann_orders(0, order, (time[..., None] - times[knots]) / self.width)
        knot_bends = bends[knots]
        subscripts = "...j,...jv->...v" if bends.ndim > 1 else "...j,...j->..."
        rounded = [xp.einsum(subscripts, ramp, knot_bends) * self.width ** (1 - k) for k, ramp in enumerate(ramps)]
        return _line(self.table, time, first, order) + Series.from_derivatives(rounded, order)

    @property
    def sharp(self) -> Profile:
        return self.table


@typed
def constant(level: Annotated[ArrayLike, OfProfile(), "value, of a vector (3,)"]) -> PiecewiseLinear:
    """Return a constant profile.

    Raises
    ------
    InputError
        If a number is not finite.

    Examples
    --------
    >>> print(gb.constant(9.81).derivatives(3.0, 0)[0])
    9.81
    """
    number = as_array(level)
    if not is_traced(number) and not np.isfinite(np.asarray(number)).all():
        raise InputError("level", f"is {level!r}", "give a finite value")
    return PiecewiseLinear([0.0], number[None])


@typed
def trapezoid(
    level: Annotated[Any, OfProfile(), "value of the plateau, of either sign"],
    *,
    jerk: Annotated[Any, OfProfile(rate=True), "rate of change on the flanks, as a magnitude"],
    start: Annotated[Any, Quantity("time"), "time at which the rise begins"] = 0.0,
    hold: Annotated[Any, Quantity("time", "zero or more"), "duration of the plateau; zero for a triangle"],
) -> PiecewiseLinear:
    """Return a ramp from zero, a plateau and the same ramp down.

    Raises
    ------
    InputError
        If the level is zero or a number is impossible.

    Examples
    --------
    >>> pulse = gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0)
    >>> print(pulse.derivatives(3.0, 0)[0])
    78.5
    """
    height, slope = finite("level", level), positive("jerk", jerk, "per second")
    begin, plateau = as_array(start), as_array(hold)
    if not is_traced(height) and height == 0:
        raise InputError("level", "is 0", "give a plateau other than zero, or a constant profile of value 0")
    rise = abs(height) / slope
    xp = namespace(height, begin, rise, plateau)
    times = begin + xp.cumsum(xp.stack([0.0 * rise, rise, plateau + 0.0 * rise, rise]))
    corners = xp.asarray([0.0, 1.0, 1.0, 0.0]) * height
    if is_traced(times):
        triangle = not is_traced(plateau) and plateau == 0
        distinct = np.array([True, True, not triangle, True])
    else:
        distinct = np.append(True, np.diff(np.asarray(times)) > 0)  # a triangle has three corners
    return PiecewiseLinear(times[distinct], corners[distinct])


@typed
def tabulated(
    times: Annotated[Sequence[float] | Floats, Quantity("time"), "times (k,), strictly increasing"],
    values: Annotated[Sequence[float] | Floats, OfProfile(), "one value per time, (k,), of a vector (k, 3)"],
) -> PiecewiseLinear:
    """Return a profile through points, straight between them and constant beyond the ends.

    Raises
    ------
    InputError
        If the shapes differ, a number is not finite or the times do not increase.

    Examples
    --------
    >>> ramp = gb.tabulated([0.0, 1.0, 2.0], [0.0, 10.0, 0.0])
    >>> print(ramp.derivatives(1.5, 0)[0])
    5.0
    """
    return PiecewiseLinear(times, values)
