"""The two smooth profiles of the hub-beam literature: the smooth-step slew and the sine pulse."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float
from numpy.typing import NDArray

from gbeam.checks import positive
from gbeam.motion.profiles.convolution import Convolved
from gbeam.motion.profiles.hann import hann
from gbeam.motion.profiles.piecewise import finite
from gbeam.motion.profiles.profile import Profile, sampled


class SmoothStep(Profile):
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
    """

    level: Float[Array, ""]
    duration: Float[Array, ""]
    start: Float[Array, ""]

    def __init__(self, level: float, duration: float, start: float = 0.0) -> None:
        self.level = jnp.asarray(finite("level", level), dtype=float)
        self.duration = jnp.asarray(positive("duration", duration, "s"), dtype=float)
        self.start = jnp.asarray(finite("start", start), dtype=float)

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        phase = (jnp.asarray(t, dtype=float) - self.start) / self.duration
        return self.level * hann(1, phase - 0.5)  # 2009 (43) is a step rounded by a Hann kernel of width T

    @property
    def breaks(self) -> Float[Array, " 2"]:
        """Start and end, s: the third derivative jumps there."""
        return self.start + self.duration * jnp.arange(2.0)

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times over the slew, s, no further apart than `step`."""
        return sampled(float(self.start), float(self.start + self.duration), step)

    def smoothed(self, width: float) -> Profile:
        """By quadrature."""
        return Convolved(self, width)


class Sine(Profile):
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
    """

    amplitude: Float[Array, ""]
    duration: Float[Array, ""]
    start: Float[Array, ""]

    def __init__(self, amplitude: float, duration: float, start: float = 0.0) -> None:
        self.amplitude = jnp.asarray(finite("amplitude", amplitude), dtype=float)
        self.duration = jnp.asarray(positive("duration", duration, "s"), dtype=float)
        self.start = jnp.asarray(finite("start", start), dtype=float)

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        phase = (jnp.asarray(t, dtype=float) - self.start) / self.duration
        wave = self.amplitude * jnp.sin(2 * jnp.pi * phase)
        return jnp.where((phase >= 0) & (phase < 1), wave, 0.0)

    @property
    def breaks(self) -> Float[Array, " 2"]:
        """Start and end, s: corners."""
        return self.start + self.duration * jnp.arange(2.0)

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times over the pulse, s, no further apart than `step`."""
        return sampled(float(self.start), float(self.start + self.duration), step)

    def smoothed(self, width: float) -> Profile:
        """By quadrature."""
        return Convolved(self, width)
