"""Three-axis centrifuge: from its axes to the motion of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.results.parts import Base


@record
class Axes:
    """States of the three axes; every field an array of the shape of time, angles in rad.

    Axis 1 turns the arm about the vertical Z. Its angle is the integral of its rate and moves nothing but
    the scenery. Axis 2 (yaw, parallel to axis 1) turns the gimbal at the arm's end by `angle2` from the
    outward radius. Axis 3 (roll) turns the specimen about the beam's axis by `angle3` from the horizontal.
    """

    rate1: Any
    acceleration1: Any
    angle2: Any
    rate2: Any
    acceleration2: Any
    angle3: Any
    rate3: Any
    acceleration3: Any

    @property
    def rates(self) -> Any:
        """Rates of the three axes, (..., 3) rad/s."""
        rates = self.rate1, self.rate2, self.rate3
        return namespace(*rates).stack(rates, axis=-1)

    @property
    def accelerations(self) -> Any:
        """Accelerations of the three axes, (..., 3) rad/s²."""
        accelerations = self.acceleration1, self.acceleration2, self.acceleration3
        return namespace(*accelerations).stack(accelerations, axis=-1)


def forward_kinematics(axes: Axes, arm: Any, gravity: Any) -> Base:
    """Motion of the specimen at the control point C, where the axes 2 and 3 meet.

    a1 points outward, a2 along the arm's motion, Z up; b1 = cos θ2 a1 + sin θ2 a2, b2 = −sin θ2 a1 + cos θ2
    a2, and the base axes are e1 = b1, e2 = cos θ3 b2 + sin θ3 Z, e3 = −sin θ3 b2 + cos θ3 Z. The paper's
    control point lies "at the intersection of axes 1 and 2", which are parallel: 2 and 3 are meant.
    """
    xp = namespace(axes.rate1, axes.angle2, axes.angle3, arm)
    sin3, cos3 = xp.sin(axes.angle3), xp.cos(axes.angle3)
    # The specimen yaws about Z at ω1 + dθ2/dt and rolls about e1 at dθ3/dt.
    yaw, dyaw = axes.rate1 + axes.rate2, axes.acceleration1 + axes.acceleration2
    w_WB_B = xp.stack([axes.rate3 + 0.0 * yaw, yaw * sin3, yaw * cos3], axis=-1)
    alpha_WB_B = xp.stack(
        [
            axes.acceleration3 + 0.0 * yaw,
            dyaw * sin3 + yaw * axes.rate3 * cos3,
            dyaw * cos3 - yaw * axes.rate3 * sin3,
        ],
        axis=-1,
    )
    return Base(control_point_load(axes, arm, gravity), w_WB_B, alpha_WB_B)


def control_point_load(axes: Axes, arm: Any, gravity: Any) -> Any:
    """Acceleration of C (..., 3), m/s², in base axes, or its specific force with `gravity`; axes as in
    :func:`forward`.
    """
    xp = namespace(axes.rate1, axes.angle2, axes.angle3, arm)
    sin2, cos2, sin3, cos3 = xp.sin(axes.angle2), xp.cos(axes.angle2), xp.sin(axes.angle3), xp.cos(axes.angle3)
    radial, tangential = -arm * axes.rate1**2, arm * axes.acceleration1
    # The arm's radial and tangential accelerations, turned by θ2 into the beam's axes and by θ3 about the beam.
    axial = radial * cos2 + tangential * sin2
    lateral = -radial * sin2 + tangential * cos2
    return xp.stack([axial, lateral * cos3 + gravity * sin3, -lateral * sin3 + gravity * cos3], axis=-1)
