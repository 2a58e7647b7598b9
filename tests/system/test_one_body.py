"""One structure as a system of one body has the answers that it has alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics import moving_system

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
    system, ground = moving_system(structure, motion)
    assert ground is None
    of_system = gb.simulate(system, ground, SETTINGS)
    assert alone.hub is not None
    angle = alone.hub.angle
    assert np.abs(angle).max() > 1e-2
    # Both bend from where gravity holds the beam, the hub at rest.
    assert np.abs(of_system.coordinate("hinge.angle") - angle).max() < 1e-9 * np.abs(angle).max()
    assert np.abs(of_system.body.q - alone.body.q).max() < 1e-9 * np.abs(alone.body.q).max()


def test_the_root_points_as_the_hub_says() -> None:
    structure = gb.assemble(BEAM, "FOAM", axial=1, y=2, z=2)
    for pointing, angle in (("outward", 0.3), ("inward", 0.3), ("inward", 0.0), ("outward", math.pi)):
        hub = gb.Hub(radius=0.7, inertia=1.0, pointing=pointing, setting_angle=angle)
        system, _ = moving_system(structure, hub)
        point = gb.static(system)
        tip, root = (point.at(f"beam.{name}") for name in ("tip", "root"))
        assert root == pytest.approx([0.7, 0, 0])
        assert tip - root == pytest.approx([0.3 if pointing == "outward" else -0.3, 0, 0], abs=1e-12)


def test_sfoam_on_a_free_hub_is_as_printed() -> None:
    """2009 (32): the hub's row lacks 2 θ̇ (F2 − K2 q)·q̇ + q̇·B q̇ of FOAM's. Elsewhere it is refused."""
    structure, like = (gb.assemble(BEAM, kind, axial=0, y=2, z=2) for kind in ("SFOAM", "FOAM"))
    hub = gb.Hub(radius=0.2, inertia=0.5, torque=PUSH)
    y, yd, ydd = np.random.default_rng(0).normal(size=(3, 5)) * [[0.01], [2.0], [5.0]]
    system, felt = (moving_system(each, hub)[0] for each in (structure, like))
    ours, printed = (each.tree(y, yd, ydd, each.inputs(np.asarray(0.1))) for each in (system, felt))
    c, q, qd = like.coefficients, y[1:], yd[1:]
    k2 = c.k_ww[2, 2] - hub.radius * c.k_a[0]
    swept, b = c.f_ww[2, 2] - hub.radius * c.f_a[0] - k2 @ q, c.k_al[2] + hub.radius * c.k_a[1]
    printed[0] -= 2 * yd[0] * swept @ qd + qd @ b @ qd
    np.testing.assert_allclose(ours, printed, rtol=1e-12, atol=1e-12 * np.abs(printed).max())
    with pytest.raises(gb.InputError, match=r"bodies.beam.model is SFOAM, whose base does not feel the beam"):
        gb.System({"beam": structure}, {"free": gb.Joint("free", "beam")})


def test_a_system_is_pushed_until_it_buckles() -> None:
    """Greenhill's heavy column, 7.8373 EI/(m L³), as a structure and as a body of a system."""
    column = gb.assemble(gb.Beam(0.3, STRIP, BEAM.material, damping_ratio=0.01), "FOAM", axial=1, z=4)
    system = gb.System({"column": column}, {"clamp": gb.Joint("fixed", "column")})
    alone, held = gb.buckling_acceleration(column), gb.buckling_acceleration(system)
    stiffness, mass = 70e9 * 0.02 * 0.004**3 / 12, 2700 * 0.02 * 0.004 * 0.3
    assert alone.value == pytest.approx(7.8373 * stiffness / (mass * 0.3**2), rel=1e-3)
    assert held.value == pytest.approx(alone.value, rel=1e-9) and held.direction == alone.direction == "z"
    rest = gb.static(system, acceleration=(0.0, 0.0, 3.0))
    assert rest.at("column.tip")[2] == pytest.approx(0.0 + gb.static(column, acceleration=(0.0, 0.0, 3.0)).tip[2])


def test_a_hub_turns_by_the_momentum_of_its_torque() -> None:
    """∫ T exp(−c (t − s)/J) ds / J of a hub whose beam is light; it then goes on turning faster by (T − c Ω)/J."""
    light = gb.Beam(0.3, STRIP, gb.Material(1e-3, 70e9), damping_ratio=0.01)
    hub = gb.Hub(radius=0.2, inertia=0.5, torque=gb.constant(2.0), damping=0.25)
    rest = gb.static(gb.assemble(light, "FOAM", axial=1, y=2, z=2), hub, 3.0)
    rate = 2.0 / 0.25 * (1 - np.exp(-0.25 * 3.0 / 0.5))
    assert rest.body.base.w_WB_B[2] == pytest.approx(rate, rel=1e-6)
    assert rest.body.base.alpha_WB_B[2] == pytest.approx((2.0 - 0.25 * rate) / 0.5, rel=1e-5)


def test_an_exact_beam_keeps_its_branch_past_a_bifurcation() -> None:
    """Turned inward, a little off its axis, it bends ever farther; Newton's method from afar ends on a branch that is
    not stable.
    """
    mass = gb.PointMass(0.3, 0.05, offset=(0.0, 0.0, 0.002))
    exact = gb.assemble(gb.Beam(0.3, STRIP, BEAM.material, [mass], damping_ratio=0.01), "exact", axial=1, z=4)
    tips = []
    for rate in (50.0, 70.0, 90.0, 110.0):
        rest = gb.static(exact, gb.Hub(radius=0.8, pointing="inward", rate=rate))
        assert rest.stable
        tips.append(float(np.linalg.norm(rest.tip)))
    assert np.all(np.diff(tips) > 0) and tips[-1] > 0.02
