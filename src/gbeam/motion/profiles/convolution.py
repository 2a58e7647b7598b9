"""Hann smoothing of a curved profile, by Gauss-Legendre panels split where a derivative jumps."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float
from numpy.typing import NDArray

from gbeam.motion.profiles.hann import hann
from gbeam.motion.profiles.profile import Profile, sampled

# On one panel the integrand is a smooth curve times one period of a cosine: 20 points leave only rounding.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(20)


class Convolved(Profile):
    """A profile convolved with the Hann kernel of width W.

    The panels end at the profile's breaks, wherever these lie in the window of abs(σ − t) < W/2, so that each
    integrand is smooth and the derivatives by `jax.jvp` (the nodes move with t) are as accurate as the value.

    Parameters
    ----------
    profile : Profile
        Analytic between its breaks, and with few of them: the cost grows with their number.
    width : float
        W, s.
    """

    profile: Profile
    width: Float[Array, ""]

    def __init__(self, profile: Profile, width: float) -> None:
        self.profile, self.width = profile, jnp.asarray(width, dtype=float)

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        now = jnp.asarray(t, dtype=float)
        low, high = now[..., None] - self.width / 2, now[..., None] + self.width / 2
        ends = jnp.concatenate([low, jnp.clip(self.profile.breaks, low, high), high], axis=-1)
        middle, half = (ends[..., 1:] + ends[..., :-1]) / 2, jnp.diff(ends) / 2
        shape = (*now.shape, -1)
        at = (middle[..., None] + half[..., None] * _POINTS).reshape(shape)
        weight = (half[..., None] * _WEIGHTS).reshape(shape) * hann(2, (now[..., None] - at) / self.width) / self.width
        values = self.profile(at)
        return jnp.sum(weight.reshape(weight.shape + (1,) * (values.ndim - at.ndim)) * values, axis=now.ndim)

    @property
    def breaks(self) -> Float[Array, " b"]:
        """None: the third derivative is continuous."""
        return self.profile.breaks[:0]

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times, s, no further apart than `step` within half a width of the profile's knots."""
        half = float(self.width) / 2
        inner = self.profile.knots(step)
        return sampled(inner[0] - half, inner[-1] + half, step)

    def smoothed(self, width: float) -> Profile:
        """Smoothed once more."""
        return Convolved(self, width)
