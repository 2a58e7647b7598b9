"""Flight: the root accelerates as recorded or prescribed; the axes turn only where the record holds body rates."""

from __future__ import annotations

from typing import ClassVar, Self

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from gbeam.motion.bases.base import Base
from gbeam.motion.profiles.piecewise import PiecewiseLinear, constant
from gbeam.motion.profiles.profile import Profile, Stack, smoothed
from gbeam.numerics.time_derivative import with_rate


def stack(x: Profile | None = None, y: Profile | None = None, z: Profile | None = None) -> Stack:
    """Return the vector profile of three scalar ones; a component left out is zero.

    Parameters
    ----------
    x, y, z : Profile or None
        Components in base axes, of one unit.
    """
    none = constant(0.0)
    return Stack((x or none, y or none, z or none))


class Flight(eqx.Module):
    """A base in flight: in translation (ω = α = 0), or turning at given body rates.

    Parameters
    ----------
    acceleration : Profile
        Vector profile: acceleration, or specific force, of the root in base axes, m/s².
    rates : Profile, optional
        Vector profile: angular velocity in base axes, rad/s, without corners; α is its derivative, since the rate of a
        vector ω is the same seen from its own axes.
    notes : tuple of str
        What was done to the record; they become warnings of the response.
    """

    kind: ClassVar[str] = "flight"
    acceleration: Profile
    rates: Profile | None = None
    notes: tuple[str, ...] = eqx.field(static=True, default=())

    def base(self, t: ArrayLike) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        a_WO_B = self.acceleration(t)
        if self.rates is None:
            return Base(a_WO_B, jnp.zeros_like(a_WO_B), jnp.zeros_like(a_WO_B))
        return Base(a_WO_B, *with_rate(self.rates, jnp.asarray(t, dtype=float)))

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    def over(self, start: float, end: float) -> Self:
        """The flight itself: it needs no preparation."""
        return self

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        if self.rates is None:
            return self.acceleration.breaks
        return jnp.sort(jnp.concatenate([self.acceleration.breaks, self.rates.breaks]))


def body_rates(recorded: PiecewiseLinear, smoothing: float = 0.0) -> Profile:
    """Return recorded body rates without corners, ready to be differentiated.

    Parameters
    ----------
    recorded : PiecewiseLinear
        rad/s, base axes.
    smoothing : float
        Width of the Hann kernel, s; at least four of the record's intervals, since a straight line between samples has
        an angular acceleration in steps.
    """
    times = recorded.times
    interval = float(times[-1] - times[0]) / max(times.size - 1, 1)
    return smoothed(recorded, max(smoothing, 4 * interval))
