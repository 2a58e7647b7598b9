"""One structure as a system of one body has the answers that it has alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics.tree.one_body import on_motion

STRIP = gb.Section.rectangle(width=0.02, thickness=0.004)
BEAM = gb.Beam(0.3, STRIP, gb.Material(2700, 70e9), [gb.PointMass(0.3, 0.05)], damping_ratio=0.01)
SETTINGS = gb.ResponseSettings(0.6, step=1e-3, integrator="hht", estimate=False, loads=False)
PUSH = gb.Sine(2.0, 0.5)
HUBS: dict[str, dict[str, Any]] = {
    "outward": {"radius": 0.2},
    "set, under gravity, damped": {"radius": 0.1, "setting_angle": 0.4, "gravity": (1.0, -9.0, 3.0), "damping": 0.3},
    "inward, set, sprung": {"radius": 1.2, "pointing": "inward", "setting_angle": -0.7, "stiffness": 5.0},
}


@pytest.mark.parametrize("kind", ["FOAM", "CFOAM", "exact"])
@pytest.mark.parametrize("hub", HUBS)
def test_a_structure_on_a_free_hub_moves_as_a_body_on_a_hinge(kind: str, hub: str) -> None:
    structure = gb.assemble(BEAM, kind, axial=1, y=2, z=2)
    motion = gb.Hub(inertia=0.5, torque=PUSH, **HUBS[hub])
    alone = gb.simulate(structure, motion, SETTINGS)
    system, ground = on_motion(structure, motion)
    assert ground is None
    of_system = gb.simulate(system, ground, SETTINGS)
    assert alone.hub is not None
    angle = alone.hub.angle
    assert np.abs(angle).max() > 1e-2
    # Both bend from where gravity holds the beam, the hub at rest.
    assert np.abs(of_system.coordinate("hinge.angle") - angle).max() < 1e-9 * np.abs(angle).max()
    assert np.abs(of_system.q[:, 1:] - alone.q).max() < 1e-9 * np.abs(alone.q).max()


def test_the_root_points_as_the_hub_says() -> None:
    structure = gb.assemble(BEAM, "FOAM", axial=1, y=2, z=2)
    for pointing, angle in (("outward", 0.3), ("inward", 0.3), ("inward", 0.0), ("outward", math.pi)):
        hub = gb.Hub(radius=0.7, inertia=1.0, pointing=pointing, setting_angle=angle)
        system, _ = on_motion(structure, hub)
        point = gb.static(system)
        tip, root = (point.at(f"beam.{name}") for name in ("tip", "root"))
        assert root == pytest.approx([0.7, 0, 0])
        assert tip - root == pytest.approx([0.3 if pointing == "outward" else -0.3, 0, 0], abs=1e-12)
