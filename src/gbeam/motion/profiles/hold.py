"""A profile that stands still until a time: what the machine is brought up to before it follows."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float
from numpy.typing import NDArray

from gbeam.motion.profiles.convolution import Convolved
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile, Stack, Sum


def held_before(profile: Profile, time: float) -> Profile:
    """Return a profile that has its value at `time` (s) until then, and is itself after.

    Straight lines stay straight lines, so that their smoothing keeps its closed form.
    """
    match profile:
        case PiecewiseLinear():
            return _cut(profile, time)
        case Sum():
            return Sum(tuple(held_before(part, time) for part in profile.parts))
        case Stack():
            x, y, z = (held_before(part, time) for part in profile.parts)
            return Stack((x, y, z))
    return HeldBefore(profile, jnp.asarray(time, dtype=float))


def _cut(table: PiecewiseLinear, time: float) -> PiecewiseLinear:
    times, values = np.asarray(table.times), np.asarray(table.values)
    if time <= times[0]:
        return table
    after = times > time
    first = np.asarray(eqx.filter_jit(table)(time))[None]
    return PiecewiseLinear(np.append(time, times[after]), np.concatenate([first, values[after]]))


class HeldBefore(Profile):
    """A curved profile that is constant until a time; see :func:`held_before`."""

    profile: Profile
    time: Float[Array, ""]

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        return self.profile(jnp.maximum(jnp.asarray(t, dtype=float), self.time))

    @property
    def breaks(self) -> Float[Array, " b"]:
        """The time, in place of what lies before it, and the breaks after it, s."""
        return jnp.append(self.time, jnp.maximum(self.profile.breaks, self.time))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Knots from the time on, s."""
        return np.unique(np.maximum(self.profile.knots(step), float(self.time)))

    def smoothed(self, width: float) -> Profile:
        """By quadrature."""
        return Convolved(self, width)
