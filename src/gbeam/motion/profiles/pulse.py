"""Smooth profiles: the slew and the sine pulse of the hub-beam literature, and a spline, as commands are designed."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, finite, positive
from gbeam.guards.quantities import OfProfile, Quantity, Seconds, Times
from gbeam.motion.profiles.profile import STEPS_PER_EVENT, TURN, Profile, hann_orders, sampled
from gbeam.numerics.bspline import DEGREE, PIECE, Spline
from gbeam.numerics.series import Series


class _Pulse(Profile):
    """A curve over a duration from a start on, s, at whose ends a derivative jumps."""

    duration: Any
    start: Any

    @property
    def breaks(self) -> Any:
        return self.start + self.duration * np.arange(2.0)

    def corners(self, step: Seconds) -> Floats:
        """Start and end, s, and the quarters between where these are of few steps."""
        parts = STEPS_PER_EVENT if float(self.duration) < 2 * STEPS_PER_EVENT * step else 1
        return np.asarray(self.start + self.duration * (np.arange(1 + parts) / parts))

    def knots(self, step: Seconds) -> Floats:
        return sampled(float(self.start), float(self.start + self.duration), step)


@typed
@record
class SmoothStep(_Pulse):
    """Slew from zero to a level: level/T (t − T/2π sin 2πt/T) for 0 < t < T, the level after.  # 2009 (43)

    Raises
    ------
    InputError
        If a number is impossible.

    Examples
    --------
    >>> slew = gb.SmoothStep(level=3.0, duration=2.0)
    >>> print(slew.derivatives(1.0, 0)[0], slew.derivatives(5.0, 0)[0])
    1.5 3.0
    """

    level: Annotated[Any, OfProfile(), "value at the end"]
    duration: Annotated[Any, Quantity("time", "positive"), "duration of the rise, T"]
    start: Annotated[Any, Quantity("time"), "time at which the rise begins"] = 0.0

    def __post_init__(self) -> None:
        assign(
            self,
            level=as_array(finite("level", self.level)),
            duration=as_array(self.duration),
            start=as_array(self.start),
        )

    def series(self, t: Times, order: int) -> Series:
        phase = (as_array(t) - self.start) / self.duration
        # 2009 (43) is a step rounded by a Hann kernel of width T.
        orders = hann_orders(1, 1 + order, phase - 0.5)
        return Series.from_derivatives([self.level * h / self.duration**k for k, h in enumerate(orders)], order)

    def integral(self, t: Times) -> Any:
        phase = (as_array(t) - self.start) / self.duration
        return self.level * self.duration * hann_orders(0, 0, phase - 0.5)[0]


@typed
@record
class Sine(_Pulse):
    """One period of a sine: amplitude sin 2πt/T for 0 <= t <= T, zero before and after.  # 2009 (44)

    Raises
    ------
    InputError
        If a number is impossible.

    Examples
    --------
    >>> pulse = gb.Sine(amplitude=50.0, duration=2.0)
    >>> print(pulse.derivatives(0.5, 0)[0])
    50.0
    """

    amplitude: Annotated[Any, OfProfile(), "amplitude"]
    duration: Annotated[Any, Quantity("time", "positive"), "duration of the one period, T"]
    start: Annotated[Any, Quantity("time"), "time at which it begins"] = 0.0

    def __post_init__(self) -> None:
        assign(
            self,
            amplitude=as_array(finite("amplitude", self.amplitude)),
            duration=as_array(self.duration),
            start=as_array(self.start),
        )

    def series(self, t: Times, order: int) -> Series:
        phase = (as_array(t) - self.start) / self.duration
        xp = namespace(phase, self.amplitude)
        size = xp.where((phase >= 0) & (phase < 1), self.amplitude, 0.0)
        sine, cosine = xp.sin(TURN * phase), xp.cos(TURN * phase) if order else 0.0
        waves = (sine, cosine, -sine, -cosine)
        return Series.from_derivatives(
            [size * (TURN / self.duration) ** k * waves[k % 4] for k in range(order + 1)], order
        )


@typed
@record
class SplineProfile(Profile):
    """A uniform quintic B-spline over a duration; constant before and after, four times continuously differentiable.

    Parameters
    ----------
    duration : float
        s.
    coefficients : (k,)
        Of the basis functions, k − 5 pieces; the first five alike, and the last five: the values before and after.
    start : float
        s.

    Raises
    ------
    InputError
        If a number is impossible, there are fewer than eleven coefficients, or the ends differ.

    Examples
    --------
    >>> import numpy as np
    >>> slew = gb.SplineProfile(2.0, np.repeat([0.0, 3.0], [6, 6]))
    >>> print(f"{slew.derivatives(1.0, 0)[0]:.4f}")
    1.5000
    """

    duration: Times
    coefficients: Any
    start: Times = 0.0

    def __post_init__(self) -> None:
        """Refuse a duration that is not positive, and too few coefficients for a flat begin and end."""
        coefficients = array("coefficients", self.coefficients)
        if coefficients.ndim != 1 or len(coefficients) < 2 * DEGREE + 1:
            raise InputError("coefficients", f"have the shape {coefficients.shape}", "give eleven or more in a row")
        assign(
            self,
            duration=as_array(positive("duration", self.duration, "s")),
            coefficients=coefficients,
            start=as_array(finite("start", self.start)),
        )

    @property
    def _spline(self) -> Spline:
        return Spline(0.0, self.duration / (self.coefficients.shape[0] - DEGREE), self.coefficients[:, None])

    def series(self, t: Times, order: int) -> Series:
        elapsed = as_array(t) - self.start
        xp = namespace(elapsed, self.coefficients)
        inside = self._spline.series(xp.clip(elapsed, 0.0, self.duration), order)
        is_outside = (elapsed < 0) | (elapsed > self.duration)
        value, *rates = (coefficient[..., 0] for coefficient in inside.coefficients)
        return Series((value, *(xp.where(is_outside, 0.0, rate) for rate in rates)))

    def integral(self, t: Times) -> Any:
        elapsed = as_array(t) - self.start
        inside = namespace(elapsed, self.coefficients).clip(elapsed, 0.0, self.duration)
        # Before and after it is constant.
        return self._spline.integral(inside)[..., 0] + (elapsed - inside) * self(t)

    @property
    def breaks(self) -> Any:
        """None: the fourth derivative is continuous."""
        return np.empty(0)

    def corners(self, step: Seconds) -> Floats:
        """Start and end, s, and the ends of the pieces where these are of few steps."""
        pieces = len(self.coefficients) - DEGREE
        short = float(self.duration) / pieces < PIECE * step
        return np.asarray(self.start + self.duration * np.linspace(0, 1, 1 + (pieces if short else 1)))

    def knots(self, step: Seconds) -> Floats:
        return sampled(float(self.start), float(self.start + self.duration), step)


def fit_spline(duration: float, time: Any, values: Any, pieces: int) -> SplineProfile:
    """Least-squares spline of values (t,) at times (t,) from 0 to the duration, s.

    It is flat at the first and the last value: the first and last coefficients are those values.
    """
    basis = Spline(0.0, duration / pieces, np.eye(pieces + DEGREE))(time)
    coefficients = np.zeros(pieces + DEGREE)
    coefficients[:DEGREE], coefficients[-DEGREE:] = values[0], values[-1]
    inner, *_ = np.linalg.lstsq(basis[:, DEGREE:-DEGREE], values - basis @ coefficients, rcond=None)
    coefficients[DEGREE:-DEGREE] = inner
    return SplineProfile(duration, coefficients)
