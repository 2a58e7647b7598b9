"""Systems at the edge of what they may be: no unknowns, no inertia, friction that holds, vibrations without end."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis import Drive, steady_state, transfer
from gbeam.report import text

ROD = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
DOWN = (0.0, 0.0, -9.81)


def hinged(**more: object) -> gb.System:
    return gb.System({"rod": ROD}, {"hinge": gb.Joint("revolute", "rod", axes=[(0, 1, 0)], **more)}, gravity=DOWN)


@pytest.mark.parametrize("kind", ["spherical", "free"])
@pytest.mark.parametrize(
    "name", ["stiffness", "ease", "damping", "friction", "stop_stiffness", "stops", "rate", "effort"]
)
def test_nothing_is_a_function_of_one_euler_parameter(kind: str, name: str) -> None:
    value = (-1.0, 1.0) if name == "stops" else 1.0
    with pytest.raises(gb.InputError, match="no coordinate"):
        gb.Joint(kind, "rod", **{name: {"e1": value}})


@pytest.mark.parametrize("integrator", ["gauss", "newmark"])
def test_a_motion_that_is_prescribed_needs_the_drive_that_it_needs(integrator: str) -> None:
    rate = gb.SmoothStep(3.0, 2.0)
    response = gb.simulate(hinged(rate=rate), duration=2.0, integrator=integrator)
    angle, change = response.coordinate("hinge.angle"), rate.derivatives(response.time, 1)[1]
    expected = change / 3 - 9.81 / 2 * np.cos(angle)
    assert response.outcome == "done" and response.effort.shape == (len(response.time), 1)
    np.testing.assert_allclose(response.effort[:, 0], expected, atol=1e-9)


def test_what_cannot_move_is_answered_by_every_question() -> None:
    fixed = gb.System({"rod": ROD}, {"clamp": gb.Joint("fixed", "rod")}, gravity=DOWN)
    response = gb.simulate(fixed, duration=1.0)
    assert response.outcome == "done" and not response.largest.any()
    np.testing.assert_allclose(response.ground_moment, [[0, 9.81 / 2, 0]] * len(response.time), atol=1e-12)
    np.testing.assert_allclose(gb.static(fixed).ground_force, DOWN)
    assert len(gb.modes(fixed).frequency) == 0
    with pytest.raises(gb.InputError, match="nothing to draw"):
        gb.modes(fixed).plot()
    assert gb.linearize(fixed).a.shape == (0, 0)


@pytest.mark.parametrize("body", [gb.RigidBody(0.0), gb.RigidBody(1.0), gb.RigidBody(1.0, (0, 2, 2), (0, 0, 0))])
@pytest.mark.parametrize("question", [gb.static, gb.modes, gb.linearize, lambda s: gb.simulate(s, duration=1.0)])
def test_a_joint_that_moves_no_mass_is_refused(body: gb.RigidBody, question: object) -> None:
    joint = gb.Joint("revolute", "rod", axes=[(1, 0, 0)])
    with pytest.raises(gb.InputError, match="without inertia"):
        question(gb.System({"rod": body}, {"hinge": joint}, gravity=DOWN))  # type: ignore[operator]


def test_rotations_without_inertia_are_named_as_they_are_given() -> None:
    rod = gb.RigidBody(1.0, (0.0, 2.0, 2.0))
    ball = gb.Joint("spherical", "rod", initial={"rx": 1.0, "ry": 2.0})
    for question in (gb.static, lambda system: gb.simulate(system, duration=1.0)):
        with pytest.raises(gb.InputError, match=r"leave ball\.rx without inertia"):
            question(gb.System({"rod": rod}, {"ball": ball}))


def test_springs_one_behind_the_other_are_refused_and_leave_a_richer_system_no_answer() -> None:
    def sprung(**root: float) -> gb.System:
        section, material = gb.Section.rectangle(width=0.02, thickness=0.004), gb.Material(2700, 70e9)
        strip = gb.Beam(0.5, section, material, damping_ratio=0.01, root=gb.Root(**root))
        joint = gb.Joint("fixed", "strip", stiffness={"rz": 20.0})
        return gb.System({"strip": gb.assemble(strip, "FOAM", y=1)}, {"clamp": joint})

    both, one = sprung(rotation_z=50.0), sprung()
    with pytest.raises(gb.InputError, match="one behind the other"):
        gb.modes(both)
    with pytest.raises(gb.ComputationError, match="with richer bodies"):
        transfer(steady_state(one, Drive()), both)


def test_modes_about_a_place_that_is_not_stable_say_so() -> None:
    modes = gb.modes(hinged(initial=-np.pi / 2))
    assert len(modes.frequency) == 0
    (growing,) = modes.instabilities
    assert growing.kind == "divergence" and growing.growth_rate == pytest.approx(np.sqrt(1.5 * 9.81), rel=1e-9)


@pytest.mark.parametrize("friction", [1.0, 4.9, 5.0, 30.0])
def test_friction_holds_what_it_can(friction: float) -> None:
    """A rod whose weight turns it by up to 4.905 N m creeps where friction is larger, and swings where it is not."""
    response = gb.simulate(hinged(friction=friction), duration=1.0, estimate=False)
    assert response.outcome == "done"
    if friction > 4.905:
        slip = 1e-3 * np.arctanh(4.905 / friction)
        np.testing.assert_allclose(response.coordinate("hinge.angle")[-1], slip, rtol=1e-3)
    else:
        assert response.coordinate("hinge.angle")[-1] > 5 * (4.905 - friction) / 2 * 0.1


def test_friction_takes_the_same_from_every_swing() -> None:
    """A mass on a spring with Coulomb friction: each swing ends 2 F/k shorter than it began."""
    mass = gb.RigidBody(1.0, (1.0, 1.0, 1.0))
    slide = gb.Joint("prismatic", "mass", axes=[(1, 0, 0)], stiffness=50.0, friction=1.0, initial=0.21)
    response = gb.simulate(gb.System({"mass": mass}, {"slide": slide}), duration=4.0, estimate=False)
    half = np.pi / np.sqrt(50.0)
    ends = np.interp(half * np.arange(5), response.time, response.coordinate("slide.displacement"))
    assert response.outcome == "done"
    np.testing.assert_allclose(ends, [0.21, -0.17, 0.13, -0.09, 0.05], atol=5e-4)


def test_a_vibration_that_no_number_of_steps_shows_asks_for_none() -> None:
    """A hinge as stiff as a clamp vibrates at 275 kHz."""
    stiff = gb.System({"rod": ROD}, {"hinge": gb.Joint("revolute", "rod", axes=[(0, 1, 0)], stiffness=1e12)})
    assert gb.simulate(stiff, duration=1.0).steps == 500


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4, 1e-4])
def test_a_flight_without_forces_meets_a_stop(step: float) -> None:
    """A stop that is met after a free flight gives the speed back, whatever the steps are."""
    block = gb.RigidBody(2.0)
    slide = gb.Joint("prismatic", "block", axes=[(1, 0, 0)], initial_rate=1.0, stops=(-1.0, 0.2), stop_stiffness=2e4)
    response = gb.simulate(gb.System({"block": block}, {"slide": slide}), duration=0.5, step=step, estimate=False)
    assert response.qd[-1, 0] == pytest.approx(-1.0, abs=0.3 * (100 * step) ** 2 + 1e-6)


def test_a_stop_that_is_met_between_two_times_is_not_overlooked() -> None:
    """An oscillator of one second grazes its stop, 10 µm before its turn, for less than a step."""
    rate, stop, end = 2 * np.pi, 1e6, 1 - 1e-5
    held = {"stiffness": rate**2, "stops": (-2.0, end), "stop_stiffness": stop}
    slide = gb.Joint("prismatic", "block", axes=[(1, 0, 0)], initial_rate=rate, **held)
    system = gb.System({"block": gb.RigidBody(1.0)}, {"slide": slide})
    response = gb.simulate(system, duration=0.6, step=5e-3)
    assert any("meets a stop and leaves it within one step, at 0.2" in each for each in response.warnings)
    assert np.isnan(response.errors.displacement.step)
    automatic = gb.simulate(system, duration=0.6)
    assert not any("stop" in each for each in automatic.warnings)
    # Before and behind the contact it is that oscillator; in it, one about another place, as stiff as both springs.
    meets, together = np.arcsin(end) / rate, np.sqrt(rate**2 + stop)
    ease, speed = stop * end / together**2, rate * np.cos(rate * meets)
    contact = (np.pi - 2 * np.arctan2((end - ease) * together, speed)) / together
    late = contact + 2 * meets - 0.5  # than without a stop
    behind = automatic.time > meets + contact
    expected = np.sin(rate * (automatic.time[behind] - late))
    away = np.abs(automatic.q[behind, 0] - expected).max()
    assert away < max(automatic.errors.displacement.step, 1e-5) < 1e-3
    assert np.abs(response.q[-1, 0] - expected[-1]) > 5e-4  # what the steps overlook


@pytest.mark.parametrize("law", [lambda t, y: "a", lambda t, y: 1j * y, lambda t, y: np.zeros(3), lambda t, y: None])
def test_a_law_that_gives_no_effort_is_named(law: object) -> None:
    loop = gb.Feedback(law, ["hinge.angle"], ["hinge.angle"], sample=0.01)
    system = gb.System(hinged().bodies, hinged().joints, controllers={"loop": loop})
    with pytest.raises(gb.ComputationError, match=r"law of hinge.angle gives .* at 0 s: give 1 finite effort"):
        gb.simulate(system, duration=1.0)


def test_a_law_without_measurements_and_too_many_samples_are_refused() -> None:
    with pytest.raises(gb.InputError, match="law takes"):
        gb.Feedback(lambda: 1.0, ["hinge.angle"], ["hinge.angle"], sample=0.01)
    loop = gb.Feedback(lambda t, y: -y, ["hinge.angle"], ["hinge.angle"], sample=1e-7)
    system = gb.System(hinged().bodies, hinged().joints, controllers={"loop": loop})
    with pytest.raises(gb.InputError, match=r"controllers\.loop\.sample"):
        gb.simulate(system, duration=1.0)


def test_a_controller_of_what_is_prescribed_has_nothing_to_move() -> None:
    turned, push = hinged(rate=gb.SmoothStep(3.0, 2.0)), {"push": gb.PointForce("rod.end")}
    loop = gb.Feedback(lambda t, y: -y, ["hinge.angle"], ["push.force_x"], sample=0.01)
    system = gb.System(turned.bodies, turned.joints, push, controllers={"loop": loop})
    with pytest.raises(gb.InputError, match="nothing to move"):
        gb.simulate(system, duration=1.0)


def test_a_place_at_rest_that_is_not_stable_says_so() -> None:
    """A rod that stands on its hinge, and a column under 1.05 times Euler's load, as for the beam alone."""
    upright, hanging = (gb.static(hinged(initial=angle)) for angle in (-np.pi / 2, np.pi / 2))
    assert hanging.stable and not upright.stable
    assert f"grows by {np.sqrt(1.5 * 9.81):.4g} per second" in upright.warnings[0] and not hanging.warnings
    section, material = gb.Section.rectangle(0.02, 0.002), gb.Material(2700, 70e9)
    euler = np.pi**2 * 70e9 * 0.02 * 0.002**3 / 12 / (4 * 0.5**2)
    for share, stable in ((0.95, True), (1.05, False)):
        beam = gb.Beam(0.5, section, material, damping_ratio=0.0, loads=[gb.Load(0.5, (-share * euler, 0, 0))])
        structure = gb.assemble(beam, "exact", axial=0, y=0, z=4)
        column = gb.System({"column": structure}, {"clamp": gb.Joint("fixed", "column")})
        assert gb.static(column).stable is gb.static(structure, gb.Flight(z=0.0)).stable is stable


def test_friction_is_said_to_be_left_out_where_it_holds() -> None:
    system = hinged(initial=np.pi / 2, friction=2.0)
    for answer in (gb.modes(system), gb.linearize(system)):
        assert any("friction of hinge.angle, 2 N m, is left out" in each for each in answer.warnings)
    assert not gb.modes(hinged(initial=np.pi / 2)).warnings
    turning = gb.linearize(hinged(initial=np.pi / 2, friction=2.0, initial_rate=1.0), at="start")
    assert not turning.warnings


def test_what_grows_without_a_point_is_named_by_its_turning() -> None:
    """A rod about its root, the only point of it: about its y it falls, along nothing."""
    rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0))
    upright = gb.System({"rod": rod}, {"hinge": gb.Joint("revolute", "rod", axes=[(0, 1, 0)])}, gravity=(-9.81, 0, 0))
    modes = gb.modes(upright)
    assert modes.instabilities[0].direction == "rod ry"
    assert "divergence of rod about its y, growing with 3.836 1/s" in repr(modes)


@pytest.mark.parametrize("question", [gb.modes, gb.linearize])
def test_a_model_without_positive_mass_is_a_named_outcome(question: object) -> None:
    """A soft strip on a sprung hinge, bent by 0.7 of its length: to second order its moment of inertia is negative."""
    soft = gb.Beam(1.0, gb.Section.rectangle(0.04, 0.001), gb.Material(2700.0, 70e9), damping_ratio=0.01)
    hinge = gb.Joint("revolute", "strip", axes=[(0, 1, 0)], stiffness=1e3)
    system = gb.System({"strip": gb.assemble(soft, "FOAM", axial=0, y=0, z=2)}, {"hinge": hinge}, gravity=(0, 0, -10))
    with pytest.raises(
        gb.ComputationError, match="the model of strip has no positive mass: give it the exact"
    ) as failed:
        question(system)  # type: ignore[operator]
    assert failed.value.outcome == "no positive mass"
    assert any("no positive mass" in each for each in gb.static(system).warnings)


def test_a_linear_model_about_an_unstable_place_says_so() -> None:
    (warning,) = gb.linearize(hinged(initial=-np.pi / 2)).warnings
    assert "not stable: divergence of" in warning and "growing with 3.836 1/s" in warning


@pytest.mark.parametrize("law", [lambda t, y: np.nan * y, ([[1.0]], [[1.0]], [[1e300]], [[1e300]])])
def test_a_law_that_leaves_all_bounds_is_a_failed_computation(law: object) -> None:
    loop = gb.Feedback(law, ["hinge.angle"], ["hinge.angle"], sample=0.01, reference=[1e10])
    system = gb.System(hinged().bodies, hinged().joints, controllers={"loop": loop})
    with pytest.raises(gb.ComputationError, match=r"the law of hinge.angle gives .* at 0 s: limit it"):
        gb.simulate(system, duration=1.0)


def test_a_drive_is_named_once() -> None:
    with pytest.raises(gb.InputError, match=r"has 'hinge\.angle' twice"):
        gb.Feedback(lambda t, y: y, ["hinge.angle"], ["hinge.angle", "hinge.angle"], sample=0.01)


@pytest.mark.parametrize("length", [0.01, 0.005])
def test_a_stout_peg_does_not_hide_what_holds_a_strip(length: float) -> None:
    """Its stiffness is 1e12 times the strip's, whose frequency is that on a clamp."""
    steel, aluminium = gb.Material(7850.0, 210e9, poissons_ratio=0.3), gb.Material(2700.0, 70e9, poissons_ratio=0.33)
    peg = gb.Beam(length, gb.Section.circle(0.005), steel, damping_ratio=0.01)
    strip = gb.Beam(1.0, gb.Section.rectangle(0.02, 0.002), aluminium, damping_ratio=0.01)
    bodies = {
        "peg": gb.assemble(peg, "exact", axial=1, y=2, z=2, twist=1),
        "strip": gb.assemble(strip, "exact", y=2, z=3),
    }
    joints = {"root": gb.Joint("fixed", "peg"), "clamp": gb.Joint("fixed", "strip", "peg.tip")}
    modes = gb.modes(gb.System(bodies, joints, gravity=(0, 0, -9.81)))
    first = 1.8751041**2 * np.sqrt(70e9 * 0.002**2 / 12 / 2700.0) / (2 * np.pi)
    assert modes.frequency[0] == pytest.approx(first, rel=0.02) and modes.errors is not None
    assert not modes.errors.note and 0 < modes.errors.total[0] < 0.01


def test_what_does_not_move_is_zero() -> None:
    """A flight along a strip on a sprung hinge bends nothing: what its steps leave is rounding, and not said."""
    beam = gb.Beam(0.25, gb.Section.rectangle(0.02, 0.003), gb.Material(2700.0, 70e9), damping_ratio=0.01)
    hinge = gb.Joint("universal", "strip", axes=[(0, 1, 0), (0, 0, 1)], stiffness={"angle_1": 40.0, "angle_2": 60.0})
    system = gb.System({"strip": gb.assemble(beam, "FOAM", axial=0, y=2, z=2)}, {"hinge": hinge})
    flight = gb.Flight(x=gb.trapezoid(49.0, jerk=49.0, start=0.2, hold=0.5))
    response = gb.simulate(system, flight, duration=1.0, step=2e-3, estimate=False)
    assert response.largest.max() == 0
    assert "at the end hinge.angle_1 0 deg, hinge.angle_2 0 deg" in text(response)


@pytest.mark.parametrize("step", [1e-2, 5e-4, 1e-4])
@pytest.mark.parametrize("stops", [{}, {"stops": {"rz": (-0.2, 0.2)}, "stop_stiffness": {"rz": 1e3}}])
def test_what_its_load_does_not_move_rests(step: float, stops: dict[str, object]) -> None:
    """A weight across the ways that a fixture gives leaves no force but rounding there, which has no sense."""
    fixture = gb.Joint("fixed", "box", at=(0, 0, 0.05), turn=(0, -1.5, 0), stiffness={"z": 2e4, "rz": 60.0}, **stops)
    box = gb.RigidBody(30.0, (0.3, 0.3, 0.36), (0.1, 0, 0.035))
    system = gb.System({"box": box}, {"fixture": fixture}, gravity=(-9.80665, 0, 0))
    response = gb.simulate(system, duration=0.1, step=step)
    assert response.outcome == "done" and np.abs(response.q).max() < 1e-15


def test_a_slide_across_gravity_comes_to_rest() -> None:
    """Its forces fall below the rounding of its weight, by which they are then known."""
    held = {"axes": [(0.6, 0.8, 0)], "turn": (0, -1.5, 0), "stiffness": 2e4, "damping": 300.0, "initial": 1e-3}
    box = {"box": gb.RigidBody(30.0, (0.3, 0.3, 0.36), (0.1, 0, 0.035))}
    slide = gb.System(box, {"slide": gb.Joint("prismatic", "box", **held)}, gravity=(0, 0, -9.81))
    response = gb.simulate(slide, duration=10.0, step=5e-3, estimate=False)
    assert response.outcome == "done" and np.abs(response.q[-1]).max() < 1e-15
