"""A rigid hub that turns about z with the beam on its rim: at a prescribed rate, or free under a torque."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from gbeam.checks import positive
from gbeam.motion.base import Base
from gbeam.motion.derivative import with_rate
from gbeam.motion.profile import Profile


class HubRate(eqx.Module):
    """A hub whose rate is prescribed.

    Parameters
    ----------
    radius : float
        From the axis to the root, m; may be zero.
    rate : Profile
        Ω(t) about z, rad/s.

    Raises
    ------
    InputError
        If the radius is negative or not finite.
    """

    radius: Float[Array, ""]
    rate: Profile

    def __init__(self, radius: float, rate: Profile) -> None:
        self.radius, self.rate = jnp.asarray(positive("radius", radius, "m", zero=True), dtype=float), rate

    def base(self, t: ArrayLike) -> Base:
        """Motion of the base at times `t` (s, any shape): a_O = (−rΩ², r dΩ/dt, 0)."""
        rate, acceleration = with_rate(self.rate, jnp.asarray(t, dtype=float))
        none = jnp.zeros_like(rate)
        return Base(
            jnp.stack([-self.radius * rate**2, self.radius * acceleration, none], axis=-1),
            jnp.stack([none, none, rate], axis=-1),
            jnp.stack([none, none, acceleration], axis=-1),
        )

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return self.rate.breaks


class HubTorque(eqx.Module):
    """A free hub driven by a torque; its angle is one of the unknowns of the equations of motion.

    Parameters
    ----------
    radius : float
        From the axis to the root, m; may be zero.
    inertia : float
        Moment of inertia of the hub about its axis, kg m².
    torque : Profile
        About z, N m; called as ``hub.torque(t)``.

    Raises
    ------
    InputError
        If the radius is negative, or the inertia not positive.
    """

    radius: Float[Array, ""]
    inertia: Float[Array, ""]
    torque: Profile

    def __init__(self, radius: float, inertia: float, torque: Profile) -> None:
        self.radius = jnp.asarray(positive("radius", radius, "m", zero=True), dtype=float)
        self.inertia = jnp.asarray(positive("inertia", inertia, "kg m²"), dtype=float)
        self.torque = torque

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return self.torque.breaks
