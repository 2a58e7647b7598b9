"""How a beam is mounted on a hub, and the motion of its root as the hub turns about z."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record
from gbeam.errors import InputError
from gbeam.guards.checks import finite, positive
from gbeam.guards.plausibility import possible
from gbeam.motion.bases.base import Base

POINTINGS = ("outward", "inward")


@record
class Mount:
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

    radius: Any
    R_HB: Any
    gravity: Any

    def __init__(
        self, radius: Any, pointing: str = "outward", setting_angle: Any = 0.0, gravity: Any | None = None
    ) -> None:
        if pointing not in POINTINGS:
            raise InputError("pointing", f"is {pointing!r}", f"choose one of {', '.join(POINTINGS)}")
        angle = finite("setting_angle", setting_angle)
        if gravity is not None:
            gravity = as_array(gravity)
            if gravity.shape != (3,) or (not is_traced(gravity) and not np.isfinite(np.asarray(gravity)).all()):
                fix = "give three finite components, along x, y and z of the hub"
                raise InputError("gravity", f"is {gravity!r}", fix)
        radius = as_array(positive("radius", radius, "m", zero=True))
        possible("radius", "radius", radius)
        xp = namespace(angle)
        c, s = xp.cos(angle), xp.sin(angle)
        about_x = xp.asarray([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        about_z = np.diag([1.0, 1.0, 1.0] if pointing == "outward" else [-1.0, -1.0, 1.0])
        assign(
            self,
            radius=radius,
            R_HB=about_z @ about_x,
            gravity=gravity,
        )

    def base(self, angle: Any, rate: Any, acceleration: Any) -> Base:
        """Motion of the base, specific force where gravity acts, at angles, rates and accelerations of one shape."""
        xp = namespace(angle, rate, acceleration, self.radius, self.R_HB, self.gravity)
        a_WO_H = xp.stack(self.root_acceleration(angle, rate, acceleration), axis=-1)
        axis = self.R_HB[2]
        return Base(a_WO_H @ self.R_HB, rate[..., None] * axis, acceleration[..., None] * axis)

    def root_acceleration(self, angle: Any, rate: Any, acceleration: Any) -> tuple[Any, Any, Any]:
        """Acceleration of the root, specific force where gravity acts, by components along the hub's axes, m/s²."""
        xp = namespace(angle, rate, acceleration, self.radius, self.gravity)
        x, y, z = -self.radius * rate**2, self.radius * acceleration, xp.zeros_like(rate)
        if self.gravity is None:
            return x, y, z
        c, s = xp.cos(angle), xp.sin(angle)
        gx, gy, gz = self.gravity
        return x - (c * gx + s * gy), y - (c * gy - s * gx), z - gz
