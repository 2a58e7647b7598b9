"""The two smooth profiles of the hub-beam literature: the smooth-step slew and the sine pulse."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, record
from gbeam.guards.arguments import typed
from gbeam.guards.checks import finite, positive
from gbeam.motion.profiles.convolution import TURN, hann_orders
from gbeam.motion.profiles.profile import STEPS_PER_EVENT, Profile, sampled
from gbeam.numerics.series import Series


class _Pulse(Profile):
    """A curve over a duration from a start on, s, at whose ends a derivative jumps."""

    duration: Any
    start: Any

    @property
    def breaks(self) -> Any:
        """Start and end, s, shape (2,)."""
        return self.start + self.duration * np.arange(2.0)

    def corners(self, step: float) -> NDArray[np.float64]:
        """Start and end, s, and the quarters between where these are of few steps."""
        parts = STEPS_PER_EVENT if float(self.duration) < 2 * STEPS_PER_EVENT * step else 1
        return np.asarray(self.start + self.duration * (np.arange(1 + parts) / parts))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times over the duration, s, no further apart than `step`."""
        return sampled(float(self.start), float(self.start + self.duration), step)


@typed
@record
class SmoothStep(_Pulse):
    """Slew from zero to a level: level/T (t − T/2π sin 2πt/T) for 0 < t < T, the level after.  # 2009 (43)

    Parameters
    ----------
    level : float
        Final value (rad/s for a hub's rate).
    duration : float
        T, s.
    start : float
        Time from which t counts, s.

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

    level: Any
    duration: Any
    start: Any = 0.0

    def __post_init__(self) -> None:
        assign(
            self,
            level=as_array(finite("level", self.level)),
            duration=as_array(positive("duration", self.duration, "s")),
            start=as_array(finite("start", self.start)),
        )

    def series(self, t: Any, order: int) -> Series:
        phase = (as_array(t) - self.start) / self.duration
        # 2009 (43) is a step rounded by a Hann kernel of width T.
        orders = hann_orders(1, 1 + order, phase - 0.5)
        return Series.of([self.level * h / self.duration**k for k, h in enumerate(orders)], order)

    def integral(self, t: Any) -> Any:
        """Integral from before the start to times `t` (s)."""
        phase = (as_array(t) - self.start) / self.duration
        return self.level * self.duration * hann_orders(0, 0, phase - 0.5)[0]


@typed
@record
class Sine(_Pulse):
    """One period of a sine: amplitude sin 2πt/T for 0 <= t <= T, zero before and after.  # 2009 (44)

    Parameters
    ----------
    amplitude : float
        N m for a hub's torque.
    duration : float
        T, s.
    start : float
        Time from which t counts, s.

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

    amplitude: Any
    duration: Any
    start: Any = 0.0

    def __post_init__(self) -> None:
        assign(
            self,
            amplitude=as_array(finite("amplitude", self.amplitude)),
            duration=as_array(positive("duration", self.duration, "s")),
            start=as_array(finite("start", self.start)),
        )

    def series(self, t: Any, order: int) -> Series:
        phase = (as_array(t) - self.start) / self.duration
        xp = namespace(phase, self.amplitude)
        size = xp.where((phase >= 0) & (phase < 1), self.amplitude, 0.0)
        sine, cosine = xp.sin(TURN * phase), xp.cos(TURN * phase) if order else 0.0
        waves = (sine, cosine, -sine, -cosine)
        return Series.of([size * (TURN / self.duration) ** k * waves[k % 4] for k in range(order + 1)], order)
