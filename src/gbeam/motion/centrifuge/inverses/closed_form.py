"""Which axis angles make a given load: the inverse of the three-axis centrifuge (Zhang 2020, corrected).

An inverse maps a target (the load wanted at the control point, over time) to the arm's rate and the two
gimbal angles; their rates follow by differentiation. Here are those in closed form; `methods` names all.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.time_derivative import with_rate

Pose = tuple[Float[Array, "*t"], Float[Array, "*t"], Float[Array, "*t"]]  # ω1, θ2, θ3


class Geometry(eqx.Module):
    """What an inverse knows of the machine.

    Parameters
    ----------
    arm : float
        R, m.
    gravity : float
        γ, m/s²: 9.80665 if the target is specific force, else 0.
    sign : float
        +1 or −1: which of the two mountings of the specimen in the gimbals.
    """

    arm: Float[Array, ""]
    gravity: Float[Array, ""]
    sign: Float[Array, ""]


class Inverse(eqx.Module):
    """Axis motion for a target; elementwise in time and differentiable by nested `jax.jvp`.

    Each says what it promises: `within`, the largest tracking error as a fraction of the load where the target is not
    held (infinite where it promises nothing), and `unless`, why it may be more and what helps.
    """

    within: ClassVar[float]
    unless: ClassVar[str]

    @abstractmethod
    def __call__(self, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""


def speed(load: Float[Array, "... 3"], geometry: Geometry) -> Float[Array, "*t"]:
    """Rate of axis 1 whose centripetal acceleration is the horizontal load: ω1 = sqrt(H/R), H² = f² − γ²."""
    horizontal2 = jnp.sum(load**2, axis=-1) - geometry.gravity**2
    return (horizontal2 / geometry.arm**2) ** 0.25


def gimbals(
    load: Float[Array, "... 3"], lag: Float[Array, "*t"], geometry: Geometry
) -> tuple[Float[Array, "*t"], Float[Array, "*t"]]:
    """Angles of axes 2 and 3 that put the load where the specimen wants it.

    Parameters
    ----------
    load : array, shape (..., 3)
        Wanted at the control point, base axes, m/s².
    lag : array, shape (...)
        δ, rad: the angle by which the horizontal load trails the inward radius.

    Returns
    -------
    tuple of two arrays, shape (...)
        θ2 = π − δ − atan2(B2, f_x) and θ3 = atan2(γ, B2) − atan2(f_z, f_y), B2 = ±sqrt(f_y² + f_z² − γ²).

    Notes
    -----
    A load along the beam leaves θ3 open: it is then zero. The inner `where` keep the derivatives finite
    there.
    """
    fx, fy, fz = load[..., 0], load[..., 1], load[..., 2]
    horizontal2 = fy**2 + fz**2 - geometry.gravity**2
    bent = horizontal2 > 0
    across = geometry.sign * jnp.sqrt(jnp.where(bent, horizontal2, 1.0))
    roll = jnp.arctan2(geometry.gravity, across) - jnp.arctan2(jnp.where(bent, fz, 0.0), jnp.where(bent, fy, across))
    return jnp.pi - lag - jnp.arctan2(jnp.where(bent, across, 0.0), fx), roll


class QuasiStatic(Inverse):
    """The arm's tangential acceleration is ignored: an error of R dω1/dt square to the load."""

    within, unless = math.inf, ""
    geometry: Geometry

    def __call__(self, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""
        load = target(t)
        return speed(load, self.geometry), *gimbals(load, jnp.zeros_like(t), self.geometry)


class Flat(Inverse):
    """Yaw makes up for the tangential acceleration: δ = atan((dω1/dt)/ω1²).

    The horizontal load has the wanted direction at all times; its size is high by sqrt(1 + tan²δ),
    about δ²/2.
    """

    within, unless = math.inf, ""
    geometry: Geometry

    def __call__(self, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""
        load, dload = with_rate(target, t)
        rate, drate = jax.jvp(lambda f: speed(f, self.geometry), (load,), (dload,))
        return rate, *gimbals(load, jnp.arctan(drate / rate**2), self.geometry)
