"""Piecewise-linear profiles: constant, trapezoid, table. Their Hann smoothing has a closed form."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from numpy.typing import ArrayLike, NDArray

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.profiles.convolution import Convolved
from gbeam.motion.profiles.hann import hann
from gbeam.motion.profiles.profile import Profile, sampled


def finite(where: str, value: float) -> float:
    """Return `value` as a float, or say that it is not a finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(where, f"is {value!r}", "give a number") from None
    if not np.isfinite(number):
        raise InputError(where, f"is {number}", "give a finite value")
    return number


class PiecewiseLinear(Profile):
    """Straight between knots, constant before the first and after the last.

    Parameters
    ----------
    times : array_like, shape (k,)
        Knots, s, strictly increasing; one knot makes a constant.
    values : array_like, shape (k,) or (k, 3)
        Values at the knots, scalars or vectors.

    Raises
    ------
    InputError
        If the shapes differ, a number is not finite or the times do not increase.
    """

    times: Float[Array, " k"]
    values: Float[Array, " k *v"]
    slopes: Float[Array, " k1 *v"]  # of the k + 1 segments, the outer two level

    def __init__(self, times: ArrayLike, values: ArrayLike) -> None:
        t = np.atleast_1d(np.asarray(times, dtype=float))
        v = np.atleast_1d(np.asarray(values, dtype=float))
        if t.ndim != 1 or t.size == 0:
            raise InputError("times", f"has shape {t.shape}", "give a list of one time or more")
        if len(v) != len(t):
            raise InputError("values", f"has {len(v)} entries for {len(t)} times", "give one value per time")
        for name, array in (("times", t), ("values", v)):
            bad = np.flatnonzero(~np.isfinite(array.reshape(len(t), -1)).all(axis=1))
            if bad.size:
                raise InputError(f"{name}[{bad[0]}]", "is not finite", "give a finite number")
        back = np.flatnonzero(np.diff(t) <= 0)
        if back.size:
            i = int(back[0])
            raise InputError(
                f"times[{i + 1}]",
                f"is {t[i + 1]:g} s, after {t[i]:g} s",
                "list times in strictly increasing order",
            )
        level = np.zeros((1, *v.shape[1:]))
        rise = np.diff(v, axis=0) / np.diff(t).reshape(-1, *[1] * (v.ndim - 1))
        self.times, self.values = jnp.asarray(t), jnp.asarray(v)
        self.slopes = jnp.asarray(np.concatenate([level, rise, level]))

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        now = jnp.asarray(t, dtype=float)
        return _line(self, now, jnp.searchsorted(self.times, now, side="right"))

    @property
    def breaks(self) -> Float[Array, " k"]:
        """Times of the knots, s."""
        return self.times

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times of the knots, s, whatever the `step`."""
        return np.asarray(self.times)

    def smoothed(self, width: float) -> Profile:
        """Closed form: the straight pieces, with a rounded ramp at each knot near by."""
        return SmoothedPiecewiseLinear(self, width)


def _line(table: PiecewiseLinear, t: Float[Array, "*t"], segment: Array) -> Float[Array, "*t"]:
    """Value at `t` of the straight line through `segment` (0 before the first knot, k after the last)."""
    start = jnp.maximum(segment - 1, 0)  # anchored in its own segment: no sum of slopes to lose digits in
    since = t - table.times[start]
    return table.values[start] + table.slopes[segment] * _beside(since, table.values.ndim - 1)


def _beside(array: Array, axes: int) -> Array:
    """Append `axes` trailing axes of length one."""
    return array.reshape(array.shape + (1,) * axes)


class SmoothedPiecewiseLinear(Profile):
    """Convolution of a piecewise-linear profile with the Hann kernel, exact and three times differentiable.

    Notes
    -----
    With Δ_i the change of slope at knot t_i, f(t) = line(t) + Σ Δ_i W h((t − t_i)/W), where `line` is the
    segment at t − W/2 prolonged, h the rounded ramp (:func:`gbeam.motion.hann.hann`) and the sum runs over
    the knots within W/2 of t: later ones have not acted yet, earlier ones are in `line`. So the cost does
    not grow with the table.
    """

    table: PiecewiseLinear
    bends: Float[Array, " k1 *v"]  # change of slope at each knot, and a zero for indices past the end
    times: Float[Array, " k1"]
    width: Float[Array, ""]
    count: int = eqx.field(static=True)  # most knots that one window can hold

    def __init__(self, table: PiecewiseLinear, width: float) -> None:
        t = np.asarray(table.times)
        slopes = np.asarray(table.slopes)
        ends = np.searchsorted(t, t + width, side="right")
        self.table, self.width = table, jnp.asarray(width, dtype=float)
        self.bends = jnp.asarray(np.concatenate([np.diff(slopes, axis=0), np.zeros_like(slopes[:1])]))
        self.times = jnp.asarray(np.append(t, t[-1]))
        # One more, since t − W/2 is rounded; then rounded up, so that widths share their programs.
        self.count = 8 * -(-(int(np.max(ends - np.arange(t.size))) + 1) // 8)

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        now = jnp.asarray(t, dtype=float)
        first = jnp.searchsorted(self.table.times, now - self.width / 2, side="right")
        near = jnp.minimum(first[..., None] + jnp.arange(self.count), self.table.times.size)
        bent = self.width * hann(0, (now[..., None] - self.times[near]) / self.width)
        rounded = jnp.sum(_beside(bent, self.bends.ndim - 1) * self.bends[near], axis=now.ndim)
        return _line(self.table, now, first) + rounded

    @property
    def breaks(self) -> Float[Array, " b"]:
        """None: the third derivative is continuous."""
        return self.times[:0]

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times, s, no further apart than `step` within half a width of the table's knots."""
        reach = float(self.width) / 2
        return sampled(float(self.times[0]) - reach, float(self.times[-1]) + reach, step)

    def smoothed(self, width: float) -> Profile:
        """Smoothed once more, by quadrature."""
        return Convolved(self, width)


def constant(value: ArrayLike) -> PiecewiseLinear:
    """Return a constant profile.

    Parameters
    ----------
    value : float or array_like of shape (3,)

    Raises
    ------
    InputError
        If a number is not finite.
    """
    number = np.asarray(value, dtype=float)
    if not np.isfinite(number).all():
        raise InputError("value", f"is {value!r}", "give a finite value")
    return PiecewiseLinear([0.0], number[None])


def trapezoid(level: float, jerk: float, start: float, hold: float) -> PiecewiseLinear:
    """Return a ramp from zero, a plateau and the same ramp down.

    Parameters
    ----------
    level : float
        Height of the plateau (m/s², rad/s, ...), of either sign.
    jerk : float
        Slope of the ramps without sign, unit of `level` per second.
    start : float
        Start of the ramp up, s.
    hold : float
        Length of the plateau, s; zero for a triangle.

    Raises
    ------
    InputError
        If the level is zero or a number is impossible.
    """
    height, begin = finite("level", level), finite("start", start)
    if height == 0:
        raise InputError("level", "is 0", "give a plateau other than zero, or a constant profile of value 0")
    rise = abs(height) / positive("jerk", jerk, "per second")
    times = begin + np.cumsum([0.0, rise, positive("hold", hold, "s", zero=True), rise])
    corners = np.array([0.0, height, height, 0.0])
    distinct = np.append(True, np.diff(times) > 0)  # a triangle has three corners
    return PiecewiseLinear(times[distinct], corners[distinct])


def tabulated(times: ArrayLike, values: ArrayLike) -> PiecewiseLinear:
    """Return a profile through points, straight between them and constant beyond the ends.

    Parameters
    ----------
    times : array_like, shape (k,)
        s, strictly increasing.
    values : array_like, shape (k,) or (k, 3)

    Raises
    ------
    InputError
        As for :class:`PiecewiseLinear`.
    """
    return PiecewiseLinear(times, values)
