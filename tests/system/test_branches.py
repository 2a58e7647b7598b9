"""The stable one of several equilibria."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb

GRAVITY = (0.0, 0.0, -9.81)
ROD = gb.RigidBody(1.0, (0.0, 0.03, 0.03), centre=(0.3, 0, 0), points={"tip": (0.6, 0, 0)})


def pendulum(angle: float, **more: Any) -> gb.System:
    """A rod on a hinge, at an angle downwards from level."""
    hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=angle)
    return gb.System({"rod": ROD}, {"hinge": hinge}, gravity=GRAVITY, **more)


@pytest.mark.parametrize("angle", [0.0, 1.0, -1.2, np.pi])
def test_a_pendulum_hangs_wherever_it_is_drawn(angle: float) -> None:
    """Level there is no stiffness, and above level Newton's method goes up: ω² = m g c/(J + m c²)."""
    rest = gb.static(pendulum(angle))
    assert rest.coordinate("hinge.angle") == pytest.approx(np.pi / 2, rel=1e-12) and rest.stable
    (frequency,) = gb.modes(pendulum(angle)).frequency
    assert frequency == pytest.approx(0.788179, rel=1e-6)
    assert 2 * np.pi * frequency == pytest.approx(np.sqrt(9.81 * 0.3 / (0.03 + 0.3**2)), rel=1e-12)


def test_a_pendulum_that_is_drawn_upright_stays_there() -> None:
    """As a controller's plant: an equilibrium near the start is meant, stable or not."""
    rest = gb.static(pendulum(-np.pi / 2 + 0.05))
    assert rest.coordinate("hinge.angle") == pytest.approx(-np.pi / 2, rel=1e-12) and not rest.stable
