"""A rigid hub that turns about z with the beam on its rim: at a prescribed rate, or free under a torque."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from gbeam.checks import positive
from gbeam.motion.bases.base import Base
from gbeam.motion.bases.mount import Mount
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.time_derivative import with_rate

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_STRIDE = 0.01  # s, between the times at which the angle is stored: Gauss's rule is exact to rounding from there


class HubRate(eqx.Module):
    """A hub whose rate is prescribed.

    Parameters
    ----------
    radius : float
        From the axis to the root, m; may be zero.
    rate : Profile
        Ω(t) about z, rad/s; the angle is zero at time zero.
    pointing, setting_angle, gravity
        As for :class:`gbeam.motion.Mount`.

    Raises
    ------
    InputError
        If the radius is negative or not finite, or the mount impossible.
    """

    mount: Mount
    rate: Profile
    times: Float[Array, " k"]
    angles: Float[Array, " k"]

    def __init__(
        self,
        radius: float,
        rate: Profile,
        pointing: str = "outward",
        setting_angle: float = 0.0,
        gravity: ArrayLike | None = None,
    ) -> None:
        self.mount, self.rate = Mount(radius, pointing, setting_angle, gravity), rate
        self.times, self.angles = jnp.zeros(1), jnp.zeros(1)
        if gravity is not None:  # nothing else asks for the angle over time
            times = jnp.asarray(np.unique(np.append(rate.knots(_STRIDE), [0.0, *np.asarray(rate.breaks)])))
            sums = jnp.concatenate([jnp.zeros(1), jnp.cumsum(self._turned(times[:-1], times[1:]))])
            self.times, self.angles = times, sums - sums[jnp.searchsorted(times, 0.0)]

    @property
    def radius(self) -> Float[Array, ""]:
        """From the axis to the root, m."""
        return self.mount.radius

    def _turned(self, start: Array, end: Array) -> Array:
        half = (end - start)[..., None] / 2
        return jnp.sum(half * _WEIGHTS * self.rate(start[..., None] + half * (1 + _POINTS)), axis=-1)

    def angle(self, t: ArrayLike) -> Array:
        """Angle at times `t` (s, any shape), rad; of a hub with gravity, without which nobody needs it."""
        now = jnp.asarray(t, dtype=float)
        last = jnp.maximum(jnp.searchsorted(self.times, now, side="right") - 1, 0)
        return self.angles[last] + self._turned(self.times[last], now)

    def base(self, t: ArrayLike) -> Base:
        """Motion of the base at times `t` (s, any shape): a_O = (−rΩ², r dΩ/dt, 0) in hub axes."""
        rate, acceleration = with_rate(self.rate, jnp.asarray(t, dtype=float))
        return self.mount.base(0.0 if self.mount.gravity is None else self.angle(t), rate, acceleration)

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
    pointing, setting_angle, gravity
        As for :class:`gbeam.motion.Mount`.
    stiffness, damping : float
        Torsional spring, at ease at the initial angle zero, and damper between hub and ground, N m/rad, N m s/rad.

    Raises
    ------
    InputError
        If the radius, the stiffness or the damping is negative, the inertia not positive, or the mount impossible.
    """

    mount: Mount
    inertia: Float[Array, ""]
    torque: Profile
    stiffness: Float[Array, ""]
    damping: Float[Array, ""]

    def __init__(
        self,
        radius: float,
        inertia: float,
        torque: Profile,
        pointing: str = "outward",
        setting_angle: float = 0.0,
        gravity: ArrayLike | None = None,
        stiffness: float = 0.0,
        damping: float = 0.0,
    ) -> None:
        self.mount = Mount(radius, pointing, setting_angle, gravity)
        self.inertia = jnp.asarray(positive("inertia", inertia, "kg m²"), dtype=float)
        self.stiffness = jnp.asarray(positive("stiffness", stiffness, "N m/rad", zero=True), dtype=float)
        self.damping = jnp.asarray(positive("damping", damping, "N m s/rad", zero=True), dtype=float)
        self.torque = torque

    @property
    def radius(self) -> Float[Array, ""]:
        """From the axis to the root, m."""
        return self.mount.radius

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return self.torque.breaks
