"""Momentum and energy along trajectories of a conservative tree: kept to the order of the steps, below 1e-12."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from tests.crossing import crossed

ON = {
    "revolute": {"axes": [(0, 1, 0)], "stiffness": 40.0},
    "prismatic": {"axes": [(1, 0, 0)], "stiffness": 40.0},
    "spherical": {"stiffness": {"rx": 40.0, "ry": 40.0, "rz": 60.0}},
}


def panel(kind: str) -> gb.Structure | gb.RigidBody:
    if kind == "rigid":
        return gb.RigidBody(2.7, (1e-3, 0.9, 0.9), centre=(0.5, 0, 0))
    strip = gb.Beam(1.0, gb.Section.rectangle(0.05, 0.02), gb.Material(2700.0, 70e9), damping_ratio=0.0)
    return gb.assemble(strip, kind, axial=0, y=1, z=1)


# Every joint on rigid panels, and every one on panels that bend by some model.
USUAL = {("FOAM", "spherical"), ("exact", "revolute"), ("exact", "prismatic")}


@pytest.mark.parametrize(
    ("kind", "joint"), crossed(lambda *both: both[0] == "rigid" or both in USUAL, ("rigid", "FOAM", "exact"), ON)
)
def test_a_tumbling_satellite_keeps_momentum_and_energy(kind: str, joint: str) -> None:
    """Two panels on springs that bend, swing and slide: each step halved takes a sixteenth of what is not kept, until
    1e-12 is left.
    """
    slow = kind == "rigid" or joint == "prismatic"  # what springs move is slower than bending
    longest, duration = (8e-3, 0.256) if slow else (1e-3, 0.0625)
    places = {"left": gb.Place((-0.5, 0, 0), (0, 0, np.pi)), "right": (0.5, 0, 0)}
    joints = {"orbit": gb.Joint("free", "bus", initial_rate={"wx": 0.5, "wy": 2.0, "wz": 0.3, "x": 0.1})}
    for name, moved in (("left", 0.3), ("right", 0.2)):
        initial = {"ry": moved} if joint == "spherical" else moved
        joints[name] = gb.Joint(joint, name, f"bus.{name}", initial=initial, **ON[joint])
    bodies = {"bus": gb.RigidBody(20.0, (2.0, 3.0, 4.0), points=places), "left": panel(kind), "right": panel(kind)}
    system, lost = gb.System(bodies, joints), []
    for step in (longest, longest / 2, longest / 8):
        response = gb.simulate(system, duration=duration, step=step, estimate=False, loads=False, initial="undeformed")
        kept = response.invariants
        assert kept is not None and np.ptp(kept.energy[:, 1]) > 0.01 * kept.energy[0, 0]
        lost.append((kept.momentum_change, kept.angular_momentum_change, kept.energy_change))
    first, second, last = np.array(lost)
    assert (second < 1e-9).all() and (last < 1e-12).all()
    np.testing.assert_allclose(np.log2(first / second)[:2], 4.0, atol=0.25)


@pytest.mark.parametrize("centre", [(0.0, 0.0, 0.0), (0.3, 0.1, 0.2)])
def test_momentum_is_kept_to_rounding_where_it_is_linear_in_the_rates_alone(centre: tuple[float, float, float]) -> None:
    """Gauss's method keeps what is quadratic in q and q̇: the momentum of a body about its centre of mass, not of one
    whose coordinates are of another point, nor any angular momentum.
    """
    body = gb.RigidBody(20.0, (2.0, 3.0, 4.0), centre=centre)
    free = gb.Joint("free", "body", initial_rate={"wx": 0.5, "wy": 2.0, "wz": 0.3, "x": 0.1})
    lost = []
    for step in (4e-2, 2e-2):
        kept = gb.simulate(
            gb.System({"body": body}, {"free": free}), duration=1.0, step=step, estimate=False
        ).invariants
        assert kept is not None
        lost.append((kept.momentum_change, kept.angular_momentum_change))
    first, second = np.array(lost)
    if not any(centre):
        assert first[0] < 1e-14 and second[0] < 1e-14
        first, second = first[1:], second[1:]
    np.testing.assert_allclose(first / second, 16.0, rtol=0.1)


def test_a_flung_rod_takes_long_steps() -> None:
    """Newton's method diverges far into a window; by what that leaves of derivatives nothing has converged."""
    stiffness, mass = np.diag([1e4] * 3 + [1e2] * 3), np.diag([1.0, 1.0, 1.0, 20.0, 10.0, 10.0])
    beam = gb.Beam(10.0, gb.Section.of_matrices(stiffness, mass), damping_ratio=0.0)
    rod = gb.assemble(beam, "exact", axial=6, z=10, shear_z=8)
    push = {"push": gb.PointForce("rod.root", (8.0, 0.0, 0.0), (0.0, -80.0, 0.0))}
    system = gb.System({"rod": rod}, {"free": gb.Joint("free", "rod", turn=(0.0, -2.2, 0.0))}, push)
    tips = []
    for step in (0.02, 0.01):
        run = gb.simulate(system, duration=0.7, step=step, estimate=False, loads=False, initial="undeformed")
        assert run.outcome == "done"
        tips.append(run.at("rod.tip")[-1])
    np.testing.assert_allclose(tips[0], tips[1], atol=2e-3)
