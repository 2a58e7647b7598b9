"""Friction of joints: rest and small departures without it, and where it holds."""

from __future__ import annotations

import re

import numpy as np
import pytest

import gbeam as gb

WEIGHT = 2.0 * 9.81 * 0.5  # N, along the incline
BLOCK = gb.RigidBody(2.0, (1.0, 1.0, 1.0))
ROD = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
DOWN = (0.0, 0.0, -9.81)


def on_incline(**joint: object) -> gb.System:
    """A block of 2 kg on a slide that falls by 30°."""
    axes = [(np.cos(np.pi / 6), 0, -0.5)]
    return gb.System({"block": BLOCK}, {"slide": gb.Joint("prismatic", "block", axes=axes, **joint)}, gravity=DOWN)


def hinged(**joint: object) -> gb.System:
    return gb.System({"rod": ROD}, {"hinge": gb.Joint("revolute", "rod", axes=[(0, 1, 0)], **joint)}, gravity=DOWN)


def of_friction(answer: object) -> list[str]:
    return [each for each in answer.warnings if "friction" in each]  # type: ignore[attr-defined]


def on_ball(**more: object) -> gb.System:
    ball = gb.Joint("spherical", "rod", friction={"wx": 8.0, "wy": 8.0, "wz": 8.0}, **more)
    return gb.System({"rod": gb.RigidBody(1.0, (0.1, 0.1, 0.1), centre=(0.5, 0, 0))}, {"ball": ball}, gravity=DOWN)


def test_a_ball_that_stands_upright_is_held_about_all_axes() -> None:
    upright = gb.static(on_ball(initial={"ry": 0.01 - np.pi / 2}))
    assert upright.stable and len(upright.warnings) == 3
    (about_y,) = [each for each in upright.warnings if "holds ball.wy" in each]
    assert f"with {4.905 * np.sin(0.01):.4g} of its 8 N m" in about_y


def test_static_answers_where_friction_holds() -> None:
    rest = gb.static(on_incline(friction=12.0))
    (held,) = rest.warnings
    assert held.startswith("nothing but friction holds slide.displacement, where it begins, with 9.81 of its 12 N")
    assert rest.stable and not rest.displacement.any() and not rest.accelerated
    np.testing.assert_allclose(rest.effort, [-WEIGHT], rtol=1e-9)
    for question in (gb.static, gb.modes, gb.linearize):
        with pytest.raises(gb.ComputationError, match=r"accelerated by 9\.81 N, of which friction holds 9 N"):
            question(on_incline(friction=9.0))


@pytest.mark.parametrize(("effort", "force"), [(2.0, WEIGHT + 2.0), (-WEIGHT - 3.0, 3.0), (2.5, None)])
def test_a_drive_takes_its_share_of_what_friction_holds(effort: float, force: float | None) -> None:
    system = on_incline(friction=12.0, effort=effort)
    if force is None:
        with pytest.raises(gb.ComputationError, match=r"accelerated by 12\.31 N, of which friction holds 12 N"):
            gb.static(system)
    else:
        (held,) = gb.static(system).warnings
        assert f"with {force:.4g} of its 12 N" in held


def test_a_rod_that_stands_upright_is_held_by_friction() -> None:
    upright = hinged(initial=-np.pi / 2 + 1e-3, friction=0.1)
    rest = gb.static(upright)
    assert rest.stable and rest.at("rod.end")[2] == pytest.approx(1.0, abs=1e-3)
    assert any("holds hinge.angle, where it begins" in each for each in rest.warnings)
    assert gb.static(hinged(initial=-np.pi / 2, friction=0.0)).stable is False
    assert not gb.modes(upright).instabilities


def test_only_joints_that_friction_can_hold_are_held() -> None:
    """A slide that its friction holds carries a rod that hangs, whose own friction is too small for a start aside."""
    base = gb.RigidBody(2.0, (1.0, 1.0, 1.0), points={"pin": (0, 0, 0)})
    slide = gb.Joint("prismatic", "base", axes=[(np.cos(np.pi / 6), 0, -0.5)], friction=40.0)
    hinge = gb.Joint("revolute", "rod", "base.pin", axes=[(0, 1, 0)], friction=1.0)
    rest = gb.static(gb.System({"base": base, "rod": ROD}, {"slide": slide, "hinge": hinge}, gravity=DOWN))
    assert rest.coordinate("hinge.angle") == pytest.approx(np.pi / 2) and rest.coordinate("slide.displacement") == 0
    assert any("slide.displacement, where it begins, with 14.71 of its 40 N" in each for each in rest.warnings)
    assert any(each.startswith("friction of hinge.angle, 1 N m, is left out") for each in rest.warnings)


def test_a_sprung_joint_rests_and_vibrates_without_friction() -> None:
    """At rest k θ = m g l/2 cos θ; about it the stiffness is k + m g l/2 sin θ, the inertia m l²/3 about the hinge."""
    answers = [
        (gb.static(each), gb.modes(each), gb.linearize(each))
        for each in (hinged(stiffness=50.0, friction=1.0), hinged(stiffness=50.0))
    ]
    rest, modes, plant = answers[0]
    angle = float(rest.coordinate("hinge.angle"))
    assert 50.0 * angle == pytest.approx(4.905 * np.cos(angle), rel=1e-9)
    stiffness = 50.0 + 4.905 * np.sin(angle)
    assert modes.frequency[0] == pytest.approx(np.sqrt(stiffness / (1 / 12 + 0.25)) / (2 * np.pi), rel=1e-9)
    assert abs(modes.damping_ratio[0]) < 1e-9
    (band,) = of_friction(rest)
    assert float(re.findall(r"up to ([\d.]+)° either way", band)[0]) == pytest.approx(
        np.degrees(1 / stiffness), rel=1e-3
    )
    assert all(
        "friction of hinge.angle, 1 N m, is left out" in each for answer in answers[0] for each in answer.warnings
    )
    np.testing.assert_array_equal(plant.a, answers[1][2].a)
    assert not any(of_friction(each) for each in answers[1])


def test_a_closed_loop_has_the_poles_that_it_has_without_friction() -> None:
    def closed(friction: float | None) -> gb.StateSpace:
        damper = gb.Feedback(lambda t, y: -2.0 * y, ["hinge.angle_rate"], ["hinge.angle"], sample=0.01)
        system = hinged(stiffness=50.0, friction=friction)
        loop = gb.System(system.bodies, system.joints, gravity=DOWN, controllers={"damper": damper})
        return gb.linearize(loop, loop="closed")

    np.testing.assert_allclose(closed(1.0).a, closed(None).a, rtol=1e-12)
    assert of_friction(closed(1.0)) and not of_friction(closed(None))
