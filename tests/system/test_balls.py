"""Balls that are sprung, damped, stopped, driven and prescribed: closed forms, energies and Euler's equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gbeam as gb
from gbeam.mechanics import Course
from gbeam.numerics import STEP

INERTIA = (0.1, 0.2, 0.25)
BODY = gb.RigidBody(2.0, INERTIA)
ROD = gb.RigidBody(2.0, INERTIA, centre=(0.1, 0.02, 0.03), points={"end": (1.0, 0.0, 0.0)})
SPRINGS = {"rx": 3.0, "ry": 5.0, "rz": 8.0}
SPIN = {
    "wx": gb.trapezoid(1.3, jerk=20, start=0.2, hold=1.0),
    "wy": gb.trapezoid(-2.0, jerk=9, start=0.0, hold=0.7),
    "wz": gb.trapezoid(3.0, jerk=30, start=0.4, hold=2.0),
}


def on_ball(body: gb.RigidBody = BODY, **about: object) -> gb.System:
    return gb.System({"rod": body}, {"ball": gb.Joint("spherical", "rod", turn=(0.3, -0.2, 0.5), **about)})


def test_springs_and_dampers_have_the_frequencies_of_their_axes() -> None:
    damping = {"wx": 0.01, "wy": 0.02, "wz": 0.03}
    modes = gb.modes(on_ball(stiffness=SPRINGS, damping=damping))
    rate = np.sqrt(np.array(list(SPRINGS.values())) / INERTIA)
    order = np.argsort(rate)
    np.testing.assert_allclose(modes.frequency, rate[order] / (2 * np.pi), rtol=1e-9)
    ratio = np.array(list(damping.values())) / (2 * rate * INERTIA)
    np.testing.assert_allclose(modes.damping_ratio, ratio[order], rtol=1e-8)


@pytest.mark.parametrize("kind", ["spherical", "free"])
def test_springs_and_stops_are_the_slope_of_their_energy(kind: str) -> None:
    """About any attitude the moments are derivatives of the stored energy with respect to the rotation from there."""
    about = {
        "stiffness": SPRINGS,
        "ease": {"ry": 0.3},
        "coupling": {"rx-ry": 1.0},
        "stops": {"rz": (-0.1, 0.2)},
        "stop_stiffness": {"rz": 40.0},
        "initial": {"rx": 1.4, "ry": -0.9, "rz": 0.7},
    }
    system = gb.System({"rod": BODY}, {"ball": gb.Joint(kind, "rod", turn=(1.0, 0.5, 0.2), **about)})
    y, still = system.start[0], np.zeros(system.tree.size)
    inputs = system.inputs(np.asarray(0.0))
    local, q, *_ = system.tree.local(y, still, still)
    moved = q + 1j * STEP * np.eye(len(q))
    stored = local.invariants(local.motion(moved, 0 * moved, 0 * moved, inputs), np.zeros(3))[2][:, 1]
    rows = local(q, 0 * q, 0 * q, inputs)
    np.testing.assert_allclose(rows, stored.imag / STEP, atol=1e-12)
    assert np.abs(rows[-3:]).min() > 0.1
    np.testing.assert_allclose(system.tree(y, still, still, inputs)[-3:], rows[-3:], atol=1e-12)


def test_a_sprung_and_stopped_ball_keeps_its_energy() -> None:
    about = {"stiffness": SPRINGS, "stops": {"rx": (-0.2, 0.3)}, "stop_stiffness": {"rx": 30.0}}
    swinging = on_ball(ROD, initial={"rx": 0.1, "ry": -0.5}, initial_rate={"wx": 2.0, "wz": -1.0}, **about)
    response = gb.simulate(swinging, duration=2.0, step=2e-4, estimate=False)
    assert response.invariants is not None and response.invariants.energy_change < 1e-6  # the stop bends within a step
    assert response.signal("ball.rx").max() > 0.3
    free = gb.simulate(on_ball(ROD, stiffness=SPRINGS, initial={"ry": -0.5}, initial_rate={"wz": -1.0}), duration=2.0)
    assert free.invariants is not None and free.invariants.energy_change < 1e-9
    np.testing.assert_allclose(response.signal("ball.wx"), response.angular_velocity[:, -1, 0], atol=1e-12)


def test_dampers_and_drives_by_closed_forms() -> None:
    slowed = gb.simulate(on_ball(damping={"wz": 0.05}, initial_rate={"wz": 3.0}), duration=2.0, estimate=False)
    np.testing.assert_allclose(slowed.signal("ball.wz"), 3 * np.exp(-0.05 / 0.25 * slowed.time), rtol=1e-7)
    rubbed = gb.simulate(on_ball(friction={"wy": 0.1}, initial_rate={"wy": 3.0}), duration=2.0, estimate=False)
    np.testing.assert_allclose(rubbed.signal("ball.wy"), 3 - 0.5 * rubbed.time, rtol=1e-6)
    driven = gb.simulate(on_ball(effort={"wx": 0.2}), duration=1.0, estimate=False)
    np.testing.assert_allclose(driven.signal("ball.wx"), 2 * driven.time, atol=1e-9)


def test_the_torque_of_a_ball_acts_back_on_what_carries_it() -> None:
    carrier = gb.RigidBody(5.0, (1.0, 1.0, 1.5), points={"side": (0.4, 0.1, 0.0)})
    system = gb.System(
        {"bus": carrier, "rod": ROD},
        {
            "air": gb.Joint("free", "bus"),
            "ball": gb.Joint("spherical", "rod", "bus.side", effort={"wx": 0.3, "wz": -0.5}, stiffness={"ry": 2.0}),
        },
    )
    response = gb.simulate(system, duration=1.0)
    kept = response.invariants
    assert kept is not None and np.abs(response.angular_velocity).max() > 0.5
    assert np.abs(kept.momentum).max() < 1e-10 and np.abs(kept.angular_momentum).max() < 1e-10


def test_the_torque_of_a_prescribed_ball_is_eulers() -> None:
    response = gb.simulate(on_ball(ROD, rate=SPIN, initial={"rz": 0.3}), duration=3.0)
    w, alpha = (
        np.stack(each, axis=1) for each in zip(*(p.derivatives(response.time) for p in SPIN.values()), strict=True)
    )
    np.testing.assert_allclose(response.signal("rod.root.spin_x"), w[:, 0], atol=1e-12)
    inertia, centre = np.diag(INERTIA), np.asarray(ROD.centre)
    push = 2.0 * (np.cross(alpha, centre) + np.cross(w, np.cross(w, centre)))
    torque = alpha @ inertia + np.cross(w, w @ inertia) + np.cross(centre, push)
    first = response.coordinates.index("ball.e1")
    np.testing.assert_allclose(response.effort[:, first : first + 3], torque, atol=1e-11)


def test_a_course_is_the_integral_of_its_rates() -> None:
    course = Course(list(SPIN.values()), np.array([1.0, 0.0, 0.0, 0.0]))

    def change(t: float, e: np.ndarray) -> np.ndarray:
        (s, v), w = (e[0], e[1:]), np.array([float(rate(np.asarray(t))) for rate in SPIN.values()])
        return np.append(-v @ w, s * w + np.cross(v, w)) / 2

    at = np.array([0.3, 1.0, 2.2, 5.0])
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "max_step": 0.01}
    exact = solve_ivp(change, (0, 5), [1.0, 0.0, 0.0, 0.0], t_eval=at, **options).y.T
    e, rate, second = course(at)
    np.testing.assert_allclose(e, exact, atol=1e-10)
    later, earlier = course(at + 1e-5), course(at - 1e-5)
    np.testing.assert_allclose((later[0] - earlier[0]) / 2e-5, rate, atol=1e-8)
    np.testing.assert_allclose((later[1] - earlier[1])[1:] / 2e-5, second[1:], atol=1e-7)


def test_small_departures_under_torques_and_prescribed_spin() -> None:
    plant = gb.linearize(on_ball(stiffness=SPRINGS), inputs=["ball.wx"], outputs=["ball.rx", "ball.wx"])
    np.testing.assert_allclose((plant.d - plant.c @ np.linalg.solve(plant.a, plant.b))[0, 0], 1 / 3.0)
    turning = gb.linearize(on_ball(ROD, rate={"wx": 0.0, "wy": 0.0, "wz": 1.0}))
    assert [each.name for each in turning.inputs] == [f"ball.r{axis}_acceleration" for axis in "xyz"]
    assert {each.unit for each in turning.inputs} == {"rad/s^2"}


def test_small_departures_under_a_torque_that_turns_with_the_body() -> None:
    """λ² = −k/J along it and −k/J θ/2 (cot θ/2 ± i) across: springs alike about all axes, at rest at θ = τ/k."""
    k, inertia, angle = 3.0, 0.2, 0.9
    axis = np.array([0.36, 0.48, 0.8])
    torque = {f"w{each}": k * angle * share for each, share in zip("xyz", axis, strict=True)}
    system = on_ball(gb.RigidBody(2.0, (inertia,) * 3), stiffness=dict.fromkeys(SPRINGS, k), effort=torque)
    across = angle / 2 * (1 / np.tan(angle / 2) + 1j)
    moving = gb.modes(system, errors=False)
    for poles in (gb.linearize(system).eigenvalue, moving.eigenvalue):
        for square in -k / inertia * np.array([1.0, across, np.conj(across)]):
            assert np.abs(poles**2 - square).min() < 1e-9 * np.abs(square)
    assert [each.kind for each in moving.instabilities] == ["flutter"]


def test_a_torque_on_a_free_body_is_a_moment_that_follows_its_root() -> None:
    beam = gb.Beam(1.0, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.0)
    bodies = {"hub": BODY, "rod": gb.assemble(beam, "exact", axial=1, y=2, z=2)}
    clamp, torque = gb.Joint("fixed", "rod", on="hub.root"), (0.02, 0.05, -0.03)
    driven = gb.Joint("free", "hub", effort=dict(zip(("wx", "wy", "wz"), torque, strict=True)))
    moment = gb.PointForce("hub.root", moment=torque, follower=True)
    by_effort = gb.System(bodies, {"air": driven, "clamp": clamp})
    by_moment = gb.System(bodies, {"air": gb.Joint("free", "hub"), "clamp": clamp}, forces={"push": moment})
    rest, beside = gb.static(by_effort), gb.static(by_moment)
    assert rest.at("rod.tip") == pytest.approx(beside.at("rod.tip"), rel=1e-9)
    assert [each.coordinate for each in rest.accelerated] == [each.coordinate for each in beside.accelerated]
    pair = [gb.modes(each, errors=False) for each in (by_effort, by_moment)]
    assert pair[0].rigid == pair[1].rigid == 6 and pair[0].frequency == pytest.approx(pair[1].frequency, rel=1e-9)


def test_one_component_alone_is_not_prescribed() -> None:
    with pytest.raises(gb.InputError, match=r"rate.wz.*without the other two components.*give wx, wy and wz"):
        gb.Joint("spherical", "rod", rate={"wz": 1.0})
    with pytest.raises(gb.InputError, match=r"stiffness.wx.*is no coordinate"):
        gb.Joint("spherical", "rod", stiffness={"wx": 1.0})


def test_a_body_whose_points_do_not_move_is_judged_by_its_turning() -> None:
    """A tumbling body on a ball moves no point: its steps were a fifth of a second, its spin off by twice itself."""
    tumbling = on_ball(initial_rate={"wx": 3.0, "wy": 8.0, "wz": 2.0})
    response = gb.simulate(tumbling, duration=8.0, estimate=False)
    assert response.largest.max() == 0 and 0 < response.errors.displacement.step < 1e-4
    spin = np.stack([response.signal(f"ball.w{axis}") for axis in "xyz"], axis=1)
    moments = spin * INERTIA  # torque-free: energy and the size of the momentum stay
    np.testing.assert_allclose((moments * spin).sum(axis=1), (moments * spin).sum(axis=1)[0], rtol=1e-6)

    def euler(_: float, w: np.ndarray) -> np.ndarray:
        return np.cross(INERTIA * w, w) / INERTIA

    exact = solve_ivp(euler, (0, 8), spin[0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(spin[-1], exact, atol=1e-3)


def test_springs_that_a_ball_turns_over_are_said() -> None:
    """A body that spins freely about x, sprung about y: at half a turn the rotation vector goes the other way."""
    ball = gb.Joint("spherical", "body", stiffness={"ry": 60.0}, initial_rate={"wx": 2.0, "wy": 0.1})
    body = gb.RigidBody(1.0, (0.02, 0.03, 0.04))
    long, short = (gb.simulate(gb.System({"body": body}, {"ball": ball}), duration=each, step=2e-3) for each in (2, 1))
    assert any("ball turns by more than half a turn, at 1.5" in each for each in long.warnings)
    assert not any("half a turn" in each for each in short.warnings)
    free = gb.Joint("spherical", "body", initial_rate={"wx": 2.0, "wy": 0.1})
    response = gb.simulate(gb.System({"body": body}, {"ball": free}), duration=2.0, step=2e-3)
    assert not any("half a turn" in each for each in response.warnings)


def test_a_stop_that_a_ball_grazes_between_two_times_is_not_overlooked() -> None:
    """A ball that turns about one axis is the hinge about it."""
    rate, end = 2 * np.pi, 1 - 1e-5
    body, over = gb.RigidBody(1.0, (1.0, 1.0, 1.0)), {"duration": 0.6, "step": 5e-3}
    held = {"stiffness": {"ry": rate**2}, "stops": {"ry": (-2.0, end)}, "stop_stiffness": {"ry": 1e6}}
    ball = gb.Joint("spherical", "body", initial_rate={"wy": rate}, **held)
    response = gb.simulate(gb.System({"body": body}, {"ball": ball}), **over)
    assert any("ball.ry meets a stop and leaves it within one step, at 0.2" in each for each in response.warnings)
    assert np.isnan(response.errors.displacement.step)
