"""Controllers in the loop: against sampled linear systems, with delay, limits, accelerometers; what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.mechanics import gains
from gbeam.report import response_lines

PANEL = gb.assemble(
    gb.Beam(3.0, gb.Section.rectangle(0.5, 0.02), gb.Material(2700.0, 70e9), damping_ratio=0.005), "FOAM", y=0, z=3
)
NAMES = ["axis.angle", "axis.angle_rate"]
SAMPLE = 0.02


def satellite(*controllers: gb.Feedback, angle: float = 0.0) -> gb.System:
    """A hub with a panel that bends in its plane."""
    rim = gb.Place((0.5, 0.0, 0.0), (np.pi / 2, 0.0, 0.0))
    hub = gb.RigidBody(100.0, (50.0, 50.0, 50.0), points={"rim": rim})
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=angle)
    joints = {"axis": axis, "clamp": gb.Joint("fixed", "panel", "hub.rim")}
    forces = {"jet": gb.PointForce("panel.tip")}
    named = {f"c{k}": each for k, each in enumerate(controllers)}
    return gb.System({"hub": hub, "panel": PANEL}, joints, forces, controllers=named)


def lead() -> tuple[np.ndarray, ...]:
    """A law with two states of two measurements."""
    a = np.array([[-8.0, 3.0], [0.0, -15.0]])
    return a, np.array([[1.0, 0.2], [0.5, 1.0]]), np.array([[20.0, -30.0]]), np.array([[-80.0, -150.0]])


def sampled(law: gb.Feedback, measure: list[str], delay: float, angle: float, count: int) -> tuple[Any, Any]:
    """Angles and commands at samples, by the matrix exponential of the linear plant."""
    system = satellite(angle=angle)
    plant = gb.linearize(system, inputs=["axis.angle"], outputs=measure)
    n, part = len(plant.a), delay % SAMPLE
    x = plant.state - gb.linearize(satellite(), inputs=["axis.angle"], outputs=measure).state
    late, held, state, angles, asked = int(delay // SAMPLE), [0.0] * 50, law.start, [], []

    def over(x: np.ndarray, u: float, h: float) -> np.ndarray:
        block = np.zeros((n + 1, n + 1))
        block[:n, :n], block[:n, n:] = plant.a, plant.b
        return expm(block * h)[:n, :n] @ x + expm(block * h)[:n, n] * u

    for k in range(count):
        before = held[-1 - late - (part > 0)] if late else held[-1]
        y = plant.c @ x + plant.d @ [before]
        u, state = law.effort(k * SAMPLE, y, state)
        asked.append(u[0])
        held.append(float(law.limited(u)[0]))
        angles.append(x[0])
        if part:
            x = over(x, held[-2 - late], part)
        x = over(x, held[-1 - late], SAMPLE - part)
    return np.array(angles), np.array(asked)


@pytest.mark.parametrize(
    ("delay", "limit", "measure"),
    [
        (0.0, None, NAMES),
        (0.5 * SAMPLE, 4e-4, NAMES),
        (1.25 * SAMPLE, None, NAMES),
        (0.0, None, ["axis.angle", "panel.tip.acceleration_z"]),
    ],
)
def test_small_motions_are_those_of_the_sampled_linear_plant(delay: float, limit: Any, measure: list[str]) -> None:
    a, b, c, d = lead()
    gentle = 0.05 if "panel.tip.acceleration_z" in measure else 1.0  # where an accelerometer would make it unstable
    law = gb.Feedback((a, b, gentle * c, gentle * d), measure, ["axis.angle"], SAMPLE, delay, limit)
    options: dict[str, Any] = {"duration": 4.0, "step": SAMPLE / 8, "estimate": False}
    response = gb.simulate(satellite(law, angle=1e-5), initial="undeformed", **options)
    angles, asked = sampled(law, measure, delay, 1e-5, 201)
    size = np.abs(angles).max()
    np.testing.assert_allclose(
        response.coordinate("axis.angle")[::8], angles, atol=(2e-5 if gentle == 1.0 else 5e-4) * size
    )
    assert response.loop is not None
    np.testing.assert_allclose(
        response.loop.asked[:-1:8, 0], asked[:-1], atol=(1e-4 if gentle == 1.0 else 2e-3) * np.abs(asked).max()
    )
    saturated = 0.0 if limit is None else np.mean(np.abs(asked[:-1]) > limit)
    assert response.loop.saturated[0] == pytest.approx(saturated, abs=0.011)


def test_a_function_is_the_matrices_and_two_controllers_are_one() -> None:
    a, b, c, d = gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE).law

    def law(t: float, y: np.ndarray, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return c @ state + d @ y, a @ state + b @ y

    options: dict[str, Any] = {"duration": 2.0, "step": 0.01, "estimate": False}
    matrices = gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE)
    function = gb.Feedback(law, NAMES, ["axis.angle"], SAMPLE, state=np.zeros(2))
    half = [gb.Feedback(lambda t, y: 0.5 * (d @ y), NAMES, ["axis.angle"], SAMPLE) for _ in range(2)]
    whole = gb.Feedback(lambda t, y: d @ y, NAMES, ["axis.angle"], SAMPLE)
    pairs = ([matrices], [function]), ([whole], half)
    for one, other in pairs:
        left, right = (gb.simulate(satellite(*each, angle=0.3), **options) for each in (one, other))
        np.testing.assert_allclose(left.q, right.q, atol=1e-9)


def test_samples_are_taken_until_they_settle() -> None:
    """Later corrections of the motion leave them as they are: what was measured is there to rounding all the same."""
    times = list[float]()

    def law(t: float, y: np.ndarray) -> np.ndarray:
        times.append(t)
        return np.asarray(lead()[3] @ y)

    controller = gb.Feedback(law, NAMES, ["axis.angle"], SAMPLE)
    response = gb.simulate(satellite(controller, angle=0.3), duration=4.0, step=SAMPLE / 2, estimate=False)
    assert response.loop is not None and sum(t > 0 for t in times) <= 3 * 199 + 8  # asked again
    states = np.stack([response.q[:-1:2, 0], response.qd[:-1:2, 0]], axis=1)
    np.testing.assert_allclose(response.loop.measured[:-1:2], states, atol=1e-13)


def test_a_force_at_a_point_is_driven_and_reported() -> None:
    """A jet at the tip damps the panel; what is sampled and applied is in the response, and acts with the delay."""
    rates = ["panel.tip.velocity_x", "panel.tip.velocity_y"]
    jet = gb.Feedback(lambda t, y: -2.0 * y, rates, ["jet.force_x", "jet.force_y"], SAMPLE, delay=SAMPLE, limit=0.015)
    turned = gb.Feedback(lambda t, y: 5.0 * (t < 0.5), ["axis.angle"], ["axis.angle"], SAMPLE)
    response = gb.simulate(satellite(jet, turned), duration=4.0, step=0.01, estimate=False)
    loop = response.loop
    assert loop is not None and loop.drives == ("c0: jet.force_x", "c0: jet.force_y", "c1: axis.angle")
    velocity = response.velocity[:, response.points.index("panel.tip"), 1]
    np.testing.assert_allclose(loop.measured[:-1:2, 1], velocity[:-1:2], atol=1e-8)
    np.testing.assert_allclose(loop.applied[2::2, 1], np.clip(-2.0 * velocity[:-2:2], -0.015, 0.015), atol=1e-8)
    alone = gb.simulate(satellite(turned), duration=4.0, step=0.01, estimate=False)
    assert response.invariants is not None and alone.invariants is not None
    assert response.invariants.energy[-1].sum() < 0.995 * alone.invariants.energy[-1].sum()
    assert 0 < loop.saturated[1] < 1 and np.abs(loop.applied[:, :2]).max() <= 0.015
    share = f"{100 * loop.saturated[1]:.3g} % of the samples"
    limited = f"c0: jet.force_y limited at {share}; c1: axis.angle limited at 0 %"
    assert any(limited in each for each in response_lines(response))


def test_what_a_section_carries_is_measured() -> None:
    """As a strain gauge at the clamp: the moment is that of the response, and of the closed loop that is linearised."""
    names = [*NAMES, "panel.root.moment_y"]
    law = gb.Feedback(gains([[-80.0, -150.0, 0.02]]), names, ["axis.angle"], SAMPLE, 0.5 * SAMPLE)
    system = satellite(law, angle=1e-5)
    response = gb.simulate(system, initial="undeformed", duration=2.0, step=SAMPLE / 8, estimate=False)
    assert response.loop is not None and response.loop.units == ("rad", "rad/s", "N m")
    moment = response.bodies["panel"].loads.section_moment[:, 0, 1]
    np.testing.assert_allclose(response.loop.measured[8:-1:8, 2], moment[8:-1:8], atol=1e-9 * np.abs(moment).max())
    closed = gb.linearize(system, loop="closed", outputs=["axis.angle", "panel.root.moment_y"])
    state, angles = np.zeros(len(closed.a)), []
    state[0] = 1e-5
    for _ in range(101):
        angles.append((closed.c @ state)[0])
        state = closed.a @ state
    np.testing.assert_allclose(response.coordinate("axis.angle")[::8], angles, atol=1e-5 * 1e-5)
    assert closed.outputs[1].unit == "N m"


def pointed(turn: tuple[float, ...], spin: tuple[float, ...] = (0.0, 0.0, 0.0), gain: float = 2.0) -> gb.System:
    """A free rigid body whose attitude and spin are fed back to a torque in its axes: a star tracker and a gyro."""
    names = [f"bus.root.{each}_{axis}" for each in ("attitude", "spin") for axis in "xyz"]
    drives = [f"wheels.moment_{axis}" for axis in "xyz"]
    law = gb.Feedback(gains(np.hstack([-gain * np.eye(3), -1.5 * gain * np.eye(3)])), names, drives, SAMPLE)
    free = gb.Joint("free", "bus", turn=turn, initial_rate=dict(zip(("wx", "wy", "wz"), spin, strict=True)))
    wheels = gb.PointForce("bus.root", follower=True)
    bus = gb.RigidBody(10.0, (1.0, 2.0, 3.0))
    return gb.System({"bus": bus}, {"orbit": free}, {"wheels": wheels}, controllers={"c": law})


def test_attitude_about_one_axis_is_a_sampled_double_integrator() -> None:
    """x⁺ = A x + B u at any angle, and the closed loop that is linearised at rest has its poles."""
    a, b = np.array([[1.0, SAMPLE], [0.0, 1.0]]), np.array([SAMPLE**2 / 2, SAMPLE]) / 3.0
    step = a - np.outer(b, [2.0, 3.0])
    expected = [np.array([2.5, 0.0])]
    for _ in range(200):
        expected.append(step @ expected[-1])
    response = gb.simulate(pointed((0, 0, 2.5)), duration=4.0, step=SAMPLE, estimate=False, initial="undeformed")
    assert response.loop is not None and response.loop.units == ("rad",) * 3 + ("rad/s",) * 3
    np.testing.assert_allclose(response.loop.measured[:-1, [2, 5]], expected[:-1], atol=1e-9)
    np.testing.assert_allclose(response.signal("bus.root.attitude_z"), np.array(expected)[:, 0], atol=1e-9)
    closed = gb.linearize(pointed((0, 0, 0)), loop="closed", outputs=["bus.root.attitude_z"])
    for pole in np.log(np.linalg.eigvals(step)) / SAMPLE:
        assert np.abs(closed.eigenvalue - pole).min() < 1e-6


def test_attitude_in_three_axes_goes_to_the_target_and_jumps_at_half_a_turn() -> None:
    system = pointed((1.9, -1.6, 1.1), (0.3, 0.5, -0.4))
    response = gb.simulate(system, duration=16.0, step=SAMPLE, estimate=False, initial="undeformed")
    assert response.loop is not None
    attitude, spin = np.split(response.loop.measured[:-1], 2, axis=1)
    left = (attitude**2).sum(axis=1) + (spin**2 * (1.0, 2.0, 3.0)).sum(axis=1) / 2  # Lyapunov's function
    assert left[0] > 7.0 and left[-1] < 1e-6 and (np.diff(left) < 1e-3 * SAMPLE).all()
    turned = Rotation.from_rotvec(attitude)
    euler = response.attitude[:-1, response.points.index("bus.root")]
    assert (turned.inv() * Rotation.from_quat(euler, scalar_first=True)).magnitude().max() < 1e-9
    spun = gb.simulate(pointed((0, 0, 3.0), (0, 0, 1.0), 1e-12), duration=4.0, step=SAMPLE, initial="undeformed")
    angle = 3.0 + spun.time
    wrapped = (angle + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(spun.loop.measured[:-1, 2], wrapped[:-1], atol=1e-8)


@pytest.mark.parametrize(("limit", "fix"), [(None, "s: limit it, or look for"), (20.0, "s: look for what grows")])
def test_efforts_beyond_all_bounds_say_what_to_do(limit: float | None, fix: str) -> None:
    law = gb.Feedback(lambda t, y: -y, ["hinge.angle"], ["hinge.angle"], sample=SAMPLE, limit=limit)
    with pytest.raises(gb.ComputationError, match=fix):
        law.effort(0.1, np.array([np.nan]), None)


def test_a_relay_limits_cycle() -> None:
    """A law that jumps is satisfied too: at every sample the command is that of the state there."""
    relay = gb.Feedback(lambda t, y: -30.0 * np.sign(y[:1] + 0.5 * y[1:]), NAMES, ["axis.angle"], SAMPLE)
    response = gb.simulate(satellite(relay, angle=0.1), duration=6.0, step=0.01, estimate=False)
    assert response.outcome == "done" and response.loop is not None
    switched = -30.0 * np.sign(response.q[:-1:2, 0] + 0.5 * response.qd[:-1:2, 0])
    np.testing.assert_allclose(response.loop.applied[:-1:2, 0], switched)
    assert np.count_nonzero(np.diff(switched)) > 3


@pytest.mark.parametrize(
    ("more", "where"),
    [
        ({"sample": 0.0}, "sample"),
        ({"measure": []}, "measure"),
        ({"limit": -1.0}, "limit"),
        ({"delay": -0.1}, "delay"),
        ({"law": "pid"}, "law"),
        ({"law": (np.eye(2), np.eye(2), np.eye(2), np.eye(2))}, "law"),
        ({"reference": [1.0]}, "reference"),
        ({"reference": [1.0, None]}, "reference"),
    ],
)
def test_controllers_that_are_none_are_refused(more: dict[str, Any], where: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        gb.Feedback(**({"law": lambda t, y: y, "measure": NAMES, "drive": ["axis.angle"], "sample": SAMPLE} | more))
    assert caught.value.where == where


def test_names_and_laws_that_do_not_fit_are_refused() -> None:
    for measure, drive, where in ((["axis.angel"], ["axis.angle"], "measure"), (NAMES, ["axis.rate"], "drive")):
        with pytest.raises(gb.InputError) as caught:
            satellite(gb.Feedback(lambda t, y: y, measure, drive, SAMPLE))
        assert caught.value.where == f"controllers.c0.{where}"
    with pytest.raises(
        gb.ComputationError, match=r"controllers.c0: the law of axis.angle gives .* at 0 s: give 1 finite"
    ):
        gb.simulate(satellite(gb.Feedback(lambda t, y: y, NAMES, ["axis.angle"], SAMPLE)), duration=0.1)
    control = pytest.importorskip("control")
    with pytest.raises(gb.InputError, match="has the step"):
        gb.Feedback(control.ss(*lead(), 0.1), NAMES, ["axis.angle"], SAMPLE)
    with pytest.raises(gb.InputError, match="as many poles as zeros"):
        gb.Feedback(control.tf([1.0, 0.0], [1.0]), NAMES[:1], ["axis.angle"], SAMPLE)
    transfer = gb.Feedback(control.tf([1.0], [0.1, 1.0]), NAMES[:1], ["axis.angle"], SAMPLE)
    assert transfer.law[0].shape == (1, 1)
