"""Three-axis centrifuge: from its axes to the motion of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float

from gbeam.motion.bases.base import Base


class Axes(eqx.Module):
    """States of the three axes; every field an array of the shape of time, angles in rad.

    Axis 1 turns the arm about the vertical Z; its angle is the integral of its rate and moves nothing but
    the scenery. Axis 2 (yaw, parallel to axis 1) turns the gimbal at the arm's end by `angle2` from the
    outward radius; axis 3 (roll) turns the specimen about the beam's axis by `angle3` from the horizontal.

    Parameters
    ----------
    rate1, acceleration1 : array
        ω1 in rad/s, dω1/dt in rad/s².
    angle2, rate2, acceleration2 : array
    angle3, rate3, acceleration3 : array
    """

    rate1: Float[Array, "*t"]
    acceleration1: Float[Array, "*t"]
    angle2: Float[Array, "*t"]
    rate2: Float[Array, "*t"]
    acceleration2: Float[Array, "*t"]
    angle3: Float[Array, "*t"]
    rate3: Float[Array, "*t"]
    acceleration3: Float[Array, "*t"]


def forward(axes: Axes, arm: Float[Array, ""] | float, gravity: Float[Array, ""] | float) -> Base:
    """Motion of the specimen at the control point C, where the axes 2 and 3 meet.

    Parameters
    ----------
    axes : Axes
    arm : float
        R, from axis 1 to axis 2, m.
    gravity : float
        γ, m/s²: 9.80665 for the specific force a − g, 0 for the acceleration.

    Returns
    -------
    Base
        At C: its ``a_WO_B`` is that of C; see :func:`moved`.

    Notes
    -----
    a1 points outward, a2 along the arm's motion, Z up; b1 = cos θ2 a1 + sin θ2 a2, b2 = −sin θ2 a1 + cos θ2
    a2, and the base axes are e1 = b1, e2 = cos θ3 b2 + sin θ3 Z, e3 = −sin θ3 b2 + cos θ3 Z. The paper's
    control point lies "at the intersection of axes 1 and 2", which are parallel: 2 and 3 are meant.
    """
    sin2, cos2 = jnp.sin(axes.angle2), jnp.cos(axes.angle2)
    sin3, cos3 = jnp.sin(axes.angle3), jnp.cos(axes.angle3)
    yaw, dyaw = axes.rate1 + axes.rate2, axes.acceleration1 + axes.acceleration2
    radial, tangential = -arm * axes.rate1**2, arm * axes.acceleration1
    along = radial * cos2 + tangential * sin2
    across = -radial * sin2 + tangential * cos2
    return Base(
        jnp.stack([along, across * cos3 + gravity * sin3, -across * sin3 + gravity * cos3], axis=-1),
        jnp.stack([axes.rate3, yaw * sin3, yaw * cos3], axis=-1),
        jnp.stack(
            [
                axes.acceleration3,
                dyaw * sin3 + yaw * axes.rate3 * cos3,
                dyaw * cos3 - yaw * axes.rate3 * sin3,
            ],
            axis=-1,
        ),
    )


def moved(base: Base, offset: ArrayLike) -> Base:
    """Return the motion at another point of the same rigid base: a + α × r + ω × (ω × r).

    Parameters
    ----------
    base : Base
    offset : array, shape (3,)
        r, from the point of `base` to the new one, base axes, m.
    """
    r = jnp.broadcast_to(jnp.asarray(offset, dtype=float), base.w_WB_B.shape)
    turning = jnp.cross(base.alpha_WB_B, r) + jnp.cross(base.w_WB_B, jnp.cross(base.w_WB_B, r))
    return Base(base.a_WO_B + turning, base.w_WB_B, base.alpha_WB_B)
