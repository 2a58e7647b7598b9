"""How a beam is mounted on a hub, and the motion of its root as the hub turns about z."""

from __future__ import annotations

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.bases.base import Base

POINTINGS = ("outward", "inward")


class Mount(eqx.Module):
    """The beam's root on the x axis of the hub's axes H, turned by a constant rotation.

    Parameters
    ----------
    radius : float
        From the hub's axis to the root, m; may be zero.
    pointing : str
        ``outward`` or ``inward``: from the root away from the hub's axis, or towards it and beyond.
    setting_angle : float
        Turn of the section's y and z axes about the beam, from the beam's y axis in the plane of rotation, rad.
    gravity : sequence of three floats, optional
        Acceleration of free fall, m/s², in hub axes at hub angle zero; it stays where it is as the hub turns.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    radius: Float[Array, ""]
    R_HB: Float[Array, "3 3"]
    gravity: Float[Array, 3] | None

    def __init__(
        self,
        radius: float,
        pointing: str = "outward",
        setting_angle: float = 0.0,
        gravity: ArrayLike | None = None,
    ) -> None:
        if pointing not in POINTINGS:
            raise InputError("pointing", f"is {pointing!r}", f"choose one of {', '.join(POINTINGS)}")
        if not np.isfinite(setting_angle):
            raise InputError("setting_angle", f"is {setting_angle}", "give a finite angle")
        if gravity is not None and (np.shape(gravity) != (3,) or not np.isfinite(np.asarray(gravity)).all()):
            raise InputError("gravity", f"is {gravity!r}", "give three finite components, along x, y and z of the hub")
        c, s = np.cos(setting_angle), np.sin(setting_angle)
        about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        about_z = np.diag([1.0, 1.0, 1.0] if pointing == "outward" else [-1.0, -1.0, 1.0])
        self.radius = jnp.asarray(positive("radius", radius, "m", zero=True), dtype=float)
        self.R_HB = jnp.asarray(about_z @ about_x)
        self.gravity = None if gravity is None else jnp.asarray(gravity, dtype=float)

    def base(self, angle: Array | float, rate: Array, acceleration: Array) -> Base:
        """Motion of the base, specific force where gravity acts, at angles, rates and accelerations of one shape."""
        none = jnp.zeros_like(rate)
        a_WO_H = jnp.stack([-self.radius * rate**2, self.radius * acceleration, none], axis=-1)
        if self.gravity is not None:
            x, y, z = self.gravity
            c, s = jnp.cos(angle), jnp.sin(angle)
            a_WO_H = a_WO_H - jnp.stack([c * x + s * y, c * y - s * x, z + none], axis=-1)
        axis = jnp.stack([none, none, none + 1], axis=-1) @ self.R_HB
        return Base(a_WO_H @ self.R_HB, rate[..., None] * axis, acceleration[..., None] * axis)
