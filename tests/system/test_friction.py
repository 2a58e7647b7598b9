"""Friction of joints: its smooth law, what that does to runs, and rest and small departures without it.

References are Coulomb's own: a block on an incline, one that is driven slowly, and the swings of a mass on a spring.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics import SLIP, SLIPS

WEIGHT = 2.0 * 9.81 * 0.5  # N, along the incline
BLOCK, MASS = gb.RigidBody(2.0, (1.0, 1.0, 1.0)), gb.RigidBody(1.0, (1.0, 1.0, 1.0))
ROD = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
DOWN, ROOT = (0.0, 0.0, -9.81), Path(__file__).parents[2]


def on_incline(**joint: object) -> gb.System:
    """A block of 2 kg on a slide that falls by 30°."""
    axes = [(np.cos(np.pi / 6), 0, -0.5)]
    return gb.System({"block": BLOCK}, {"slide": gb.Joint("prismatic", "block", axes=axes, **joint)}, gravity=DOWN)


def sliding(**joint: object) -> gb.System:
    return gb.System({"mass": MASS}, {"slide": gb.Joint("prismatic", "mass", axes=[(1, 0, 0)], **joint)})


def hinged(**joint: object) -> gb.System:
    return gb.System({"rod": ROD}, {"hinge": gb.Joint("revolute", "rod", axes=[(0, 1, 0)], **joint)}, gravity=DOWN)


def swings(time: np.ndarray, stiffness: float, friction: float, start: float) -> np.ndarray:
    """Places (t,) of 1 kg on a spring with Coulomb's friction, let go at `start`: half waves, then it stays."""
    rate, offset = np.sqrt(stiffness), friction / stiffness
    half = (time // (np.pi / rate)).astype(int)
    amplitude, sign = start - offset - 2 * offset * half, (-1.0) ** half
    places = sign * (offset + amplitude * np.cos(rate * time - np.pi * half))
    last = int(np.ceil((start - offset) / (2 * offset)))  # of the turns: from there the spring is too weak
    return np.where(half < last, places, (-1.0) ** last * (start - 2 * offset * last))


def of_friction(answer: object) -> list[str]:
    return [each for each in answer.warnings if "friction" in each]  # type: ignore[attr-defined]


def test_the_law_is_said_wherever_friction_is_described() -> None:
    assert (f"{1e3 * SLIP:g} mm/s", f"{np.degrees(SLIP):.3g} °/s") == SLIPS
    described = [ROOT / "docs" / name for name in ("scenario.md", "theory.md", "howto/systems.md")]
    for text in (*(page.read_text(encoding="utf-8") for page in described), gb.Joint.__doc__ or ""):
        words = " ".join(text.split())
        assert all(each in words for each in SLIPS) and "creep" in words


def test_a_block_that_friction_holds_creeps_and_is_warned_of() -> None:
    response = gb.simulate(on_incline(friction=12.0), duration=5.0)
    way = 5.0 * SLIP * np.arctanh(WEIGHT / 12.0)
    assert response.coordinate("slide.displacement")[-1] == pytest.approx(way, rel=1e-3)
    creeping, wrong = of_friction(response)
    millimetres, seconds, felt = map(
        float, re.findall(r"by ([\d.]+) mm in ([\d.]+) s .* with ([\d.]+) of 12 N", creeping)[0]
    )
    assert creeping.startswith("slide.displacement creeps") and "smooth below 1 mm/s" in creeping
    assert millimetres == pytest.approx(1e3 * way, rel=1e-3) and seconds == pytest.approx(5.0, rel=0.02)
    assert felt == pytest.approx(WEIGHT, rel=1e-3)
    # All of its way is wrong, and stated to be.
    assert "wrong by an estimated 100 %" in wrong
    assert response.errors.displacement.friction == pytest.approx(1.0, rel=1e-3)
    assert response.error_estimate == pytest.approx(1.0, rel=1e-2)


def test_creep_beyond_the_rate_of_the_law_is_warned_of() -> None:
    """At 0.99 of its friction a joint creeps by 2.65 mm/s."""
    (creeping, _) = of_friction(gb.simulate(on_incline(friction=WEIGHT / 0.99), duration=1.0))
    assert "creeps by 2.6" in creeping


@pytest.mark.parametrize(("friction", "rate"), [(12.0, 1.0), (12.0, 0.2), (20.0, 1.0)])
def test_a_block_that_comes_to_rest_states_what_it_creeps(friction: float, rate: float) -> None:
    response = gb.simulate(on_incline(friction=friction, initial_rate=rate), duration=4.0)
    braked = (friction - WEIGHT) / 2.0
    time = np.minimum(response.time, rate / braked)
    true = np.abs(response.coordinate("slide.displacement") - (rate * time - braked * time**2 / 2)).max()
    stated = response.errors.displacement.friction * response.coordinate("slide.displacement").max()
    assert true / 1.1 < stated < 1.1 * true


def test_swings_state_what_the_smooth_law_does_to_them() -> None:
    """Five half waves, each 2 F/k shorter than the last, and a rest 10 mm off, where the smooth law creeps back."""
    response = gb.simulate(sliding(stiffness=50.0, friction=1.0, initial=0.21), duration=8.0, step=1e-3)
    places = response.coordinate("slide.displacement")
    true = np.abs(places - swings(response.time, 50.0, 1.0, 0.21)).max() / np.abs(places - places[0]).max()
    assert true / 3 < response.errors.displacement.friction < 3 * true
    assert true > 5 * response.errors.displacement.step
    (creeping, *_) = of_friction(response)
    assert creeping.startswith("slide.displacement creeps")


@pytest.mark.parametrize(
    "system",
    [
        sliding(stiffness=50.0, friction=1.0, initial=0.21),  # turns back, four times
        sliding(stiffness=1.0, friction=1e-3, initial=0.03),  # and this one slowly, at 30 mm/s at most
        hinged(friction=0.3),
        on_incline(friction=5.0),
        on_incline(friction=5.0, initial_rate=-0.2),
        gb.System({"block": BLOCK}, {"slide": gb.Joint("prismatic", "block", axes=[(1, 0, 0)], friction=4.0)}),
        sliding(friction=4.0, initial_rate=1.0),  # stops, and nothing pushes it on
        sliding(friction=4.0, rate=gb.SmoothStep(0.1, 0.5)),
        sliding(friction=4.0, rate=0.0),
    ],
)
def test_what_turns_back_or_stays_is_not_warned_of(system: gb.System) -> None:
    response = gb.simulate(system, duration=2.0)
    assert response.outcome == "done" and not of_friction(response)
    moves = 1e-9 < response.errors.displacement.friction < 0.01
    assert moves or np.isnan(response.errors.displacement.friction) or not response.largest.any()


def test_a_slow_drive_feels_a_tenth_and_is_warned_of() -> None:
    response = gb.simulate(sliding(friction=5.0, rate=1e-4), duration=2.0)
    np.testing.assert_allclose(response.effort[1:, 0], 5.0 * np.tanh(0.1), rtol=1e-6)
    (slow,) = of_friction(response)
    assert "slide.displacement moves by 0.2 mm in 2 s so slowly that its drive feels 0.4983 of 5 N at most" in slow


def on_ball(**more: object) -> gb.System:
    ball = gb.Joint("spherical", "rod", friction={"wx": 8.0, "wy": 8.0, "wz": 8.0}, **more)
    return gb.System({"rod": gb.RigidBody(1.0, (0.1, 0.1, 0.1), centre=(0.5, 0, 0))}, {"ball": ball}, gravity=DOWN)


def test_axes_of_a_ball_creep_each() -> None:
    creeping, _ = of_friction(gb.simulate(on_ball(), duration=1.0))
    assert creeping.startswith("ball.wy creeps") and "smooth below 0.0573 °/s" in creeping
    (angle,) = re.findall(r"by ([\d.]+)°", creeping)
    assert float(angle) == pytest.approx(np.degrees(SLIP * np.arctanh(4.905 / 8.0)), rel=0.02)


def test_a_ball_that_stands_upright_is_held_about_all_axes() -> None:
    upright = gb.static(on_ball(initial={"ry": 0.01 - np.pi / 2}))
    assert upright.stable and len(upright.warnings) == 3
    (about_y,) = [each for each in upright.warnings if "holds ball.wy" in each]
    assert f"with {4.905 * np.sin(0.01):.4g} of its 8 N m" in about_y


def test_loads_of_a_beam_state_what_friction_does_to_them() -> None:
    """A strip on a slide that friction brakes: how its force ends is smooth, and the strip rings by it."""
    section, material = gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9)
    strip = gb.assemble(gb.Beam(0.3, section, material, damping_ratio=0.05), "FOAM", z=1)
    slide = gb.Joint("prismatic", "strip", axes=[(0, 0, 1)], friction=0.5, initial_rate=0.2)
    system = gb.System({"strip": strip}, {"slide": slide})
    errors, none = (gb.simulate(system, duration=0.1, step=5e-4, estimate=each).errors for each in (True, False))
    assert errors.loads.total > errors.loads.friction > errors.displacement.friction > 1e-5
    assert errors.stress.friction > errors.displacement.friction and np.isnan(none.displacement.friction)


def test_static_answers_where_friction_holds() -> None:
    rest = gb.static(on_incline(friction=12.0))
    (held,) = rest.warnings
    assert held.startswith("nothing but friction holds slide.displacement, where it begins, with 9.81 of its 12 N")
    assert rest.stable and not rest.point_displacement.any() and not rest.accelerated
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
