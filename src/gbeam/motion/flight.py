"""Flight: the root accelerates as recorded or prescribed, and the axes do not turn."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from gbeam.motion.base import Base
from gbeam.motion.piecewise import constant
from gbeam.motion.profile import Profile, Stack


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
    """A base in translation: ω = α = 0.

    Parameters
    ----------
    acceleration : Profile
        Vector profile: acceleration, or specific force, of the root in base axes, m/s².
    """

    acceleration: Profile

    def base(self, t: ArrayLike) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        a_WO_B = self.acceleration(t)
        return Base(a_WO_B, jnp.zeros_like(a_WO_B), jnp.zeros_like(a_WO_B))

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return self.acceleration.breaks
