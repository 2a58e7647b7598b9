"""The two mountings: what docs/mounting.svg shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gbeam import Centrifuge, Flight, constant

G = 9.80665
DRAWING = (Path(__file__).parents[2] / "docs" / "mounting.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(("mounting", "lead"), [("upright", 1), ("inverted", -1)])
def test_the_mountings_are_those_of_the_drawing(mounting: str, lead: int) -> None:
    machine = Centrifuge(
        Flight(z=constant(6 * G)), arm=3.3, control_point=0.2, inverse="flat", gravity=True, mounting=mounting,
        start="idle", span=(0.0, 1.0),
    )  # fmt: skip
    axes = machine.axes(0.5)
    # Columns: x, y and z of the beam; rows: outwards along the arm, along the motion of C, upwards.
    R_AB = (Rotation.from_euler("z", axes.angle2) * Rotation.from_euler("x", axes.angle3)).as_matrix()
    x, y, z = R_AB.T
    np.testing.assert_allclose(x, [0, lead, 0], atol=1e-12)  # the tip leads or trails
    # Specific force: the centripetal acceleration, inwards, and what carries the weight, upwards.
    np.testing.assert_allclose(z, [-np.sqrt(1 - 1 / 36), 0, 1 / 6], atol=1e-12)
    assert np.sign(y[2]) == -lead  # the width's axis points down or up
    assert axes.rate1 == pytest.approx((35**0.5 * G / 3.3) ** 0.5)
    yaw, roll = np.degrees(axes.angle2), np.degrees(axes.angle3)
    assert f"θ₂ = {yaw:.0f}°" in DRAWING and f"θ₃ = {roll:.1f}°".replace("-", "−") in DRAWING
