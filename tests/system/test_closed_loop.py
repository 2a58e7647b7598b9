"""The linearised closed loop: against python-control, the sampled simulation, and delays in closed form."""

from __future__ import annotations

from typing import Any

import control
import numpy as np
import pytest
from scipy.linalg import expm

import gbeam as gb
from gbeam.mechanics import gains
from tests.crossing import crossed
from tests.system.test_feedback import NAMES, SAMPLE, lead, satellite

# Controllers at 3/2 of the sample, the second of which feels the commands at once.
OTHERS: list[list[gb.Feedback]] = [
    [],
    [gb.Feedback(gains([[-5.0, -15.0]]), NAMES, ["jet.moment_z"], 1.5 * SAMPLE, 0.7 * SAMPLE)],
    [gb.Feedback(gains([[-1.0]]), ["panel.tip.acceleration_z"], ["axis.angle"], 1.5 * SAMPLE)],
]


# Each delay of a controller alone, in samples, and each of the others beside one delay; the rest crosses them.
USUAL = {(delay, 0) for delay in (0.0, 0.5, 1.0, 2.25)} | {(0.5, 1), (2.25, 2)}


@pytest.mark.parametrize(("late", "which"), crossed(lambda *both: both in USUAL, (0.0, 0.5, 1.0, 2.25), range(3)))
def test_a_small_motion_follows_the_closed_loop(late: float, which: int) -> None:
    """From period to period the response is A^k x, of the plant, the laws and the commands that are still to act."""
    others = OTHERS[which]
    system = satellite(gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE, late * SAMPLE), *others, angle=1e-5)
    closed = gb.linearize(system, loop="closed", outputs=["axis.angle", "panel.tip.place_y"])
    samples = 3 if others else 1
    assert closed.step == pytest.approx(samples * SAMPLE, rel=1e-12)
    response = gb.simulate(system, initial="undeformed", duration=4.2, step=SAMPLE / 16, estimate=False)
    state, angles = np.zeros(len(closed.a)), []
    state[0] = 1e-5
    for _ in range(210 // samples + 1):
        angles.append(closed.c @ state)
        state = closed.a @ state
    size = np.abs(angles).max(axis=0)
    slow = np.searchsorted(response.time, closed.step * np.arange(len(angles)) - 1e-9)
    moved = response.at("panel.tip")[slow, 1]
    np.testing.assert_allclose(response.coordinate("axis.angle")[slow], np.array(angles)[:, 0], atol=5e-6 * size[0])
    np.testing.assert_allclose(moved, np.array(angles)[:, 1], atol=5e-6 * size[1])
    assert others or closed.eigenvalue[0].real < 0


def ticked(inertia: float, laws: list[tuple[float, float, int, int]]) -> Any:
    """Factors z over a period of 350 ms of a hub under PD laws (kp, kd, sample, delay in ticks of 5 ms), by ticks."""
    over = expm(0.005 * np.array([[0, 1, 0], [0, 0, 1 / inertia], [0, 0, 0]]))
    sizes = [2, *(delay + 1 for *_, delay in laws)]
    states = np.eye(sum(sizes))
    for tick in range(70):
        x, *pasts = np.split(states, np.cumsum(sizes)[:-1])
        torque = np.zeros(len(states))
        for k, (kp, kd, sample, delay) in enumerate(laws):
            asked = -kp * x[0] - kd * x[1] if tick % sample == 0 else pasts[k][0]
            torque += (asked, *pasts[k])[delay]
            pasts[k] = np.array([asked, *pasts[k][:-1]])
        states = np.concatenate([over[:2, :2] @ x + np.outer(over[:2, 2], torque), *pasts])
    return np.linalg.eigvals(states)


def test_two_rates_have_the_poles_of_the_map_over_their_common_period() -> None:
    """PD at 50 and 70 ms, late by 20 and 105 ms: by hand in ticks of 5 ms, and as a long run decays."""
    laws = [(1.2, 3.0, 10, 4), (0.6, 2.0, 14, 21)]
    options = [(gains([[-kp, -kd]]), NAMES, ["axis.angle"], 0.005 * s, 0.005 * d) for kp, kd, s, d in laws]
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=1e-3)
    controllers = {f"c{k}": gb.Feedback(*each) for k, each in enumerate(options)}
    system = gb.System({"hub": gb.RigidBody(1.0, (2.0, 2.0, 2.0))}, {"axis": axis}, controllers=controllers)
    closed = gb.linearize(system, loop="closed")
    assert closed.step == pytest.approx(0.35, rel=1e-12) and len(closed.a) == 2 + 1 + 2
    z = np.exp(0.35 * closed.eigenvalue)
    expected = ticked(2.0, laws)
    expected = expected[np.argsort(-np.abs(expected))][: len(z)]
    for each in expected:
        assert np.abs(z - each).min() < 1e-12
    response = gb.simulate(system, initial="undeformed", duration=10.5, step=0.05, estimate=False)
    late = np.interp([9.8, 10.15, 10.5], response.time, response.coordinate("axis.angle"))
    np.testing.assert_allclose(late[1:] / late[:-1], expected[0].real, rtol=1e-6)


def test_margins_of_two_rates_are_those_of_the_drive_that_is_sampled_once() -> None:
    """With its gain grown by the margin the closed loop is at its limit; the other's gain changes with time."""

    def laws(factor: float) -> list[gb.Feedback]:
        slow = tuple(each * (factor if k > 1 else 1.0) for k, each in enumerate(lead()))
        fast = gb.Feedback(gains([[-10.0, -20.0]]), NAMES, ["axis.angle"], SAMPLE)
        return [fast, gb.Feedback(slow, NAMES, ["axis.angle"], 3 * SAMPLE)]

    closed = gb.linearize(satellite(*laws(1.0)), loop="closed")
    (margin,) = closed.margins
    assert margin.drive == "c1: axis.angle" and closed.step == pytest.approx(3 * SAMPLE, rel=1e-12)
    assert closed.warnings[-1] == "no margins of c0: axis.angle, sampled more than once in the common period of 60 ms"
    limit = gb.linearize(satellite(*laws(margin.gain)), loop="closed").eigenvalue[0]
    assert limit.real == pytest.approx(0.0, abs=1e-5) and closed.eigenvalue[0].real < -1e-3
    assert abs(limit.imag) == pytest.approx(2 * np.pi * margin.gain_frequency, rel=1e-4)
    cut = gb.linearize(satellite(*laws(1.0)), loop="c1: axis.angle")
    assert cut.step == closed.step and len(cut.inputs) == 1
    with pytest.raises(gb.InputError, match=r"c0: axis.angle, sampled 3 times in the common period of 60 ms"):
        gb.linearize(satellite(*laws(1.0)), loop="c0: axis.angle")


@pytest.mark.parametrize("delay", [0, pytest.param(1, marks=pytest.mark.thorough), 2])
def test_poles_and_margins_are_those_of_python_control(delay: int) -> None:
    """The plant held between samples, a law in steps, and a delay of whole samples."""
    law = gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE, delay * SAMPLE)
    system = satellite(law)
    plant = gb.linearize(system, inputs=["axis.angle"], outputs=NAMES).to_control()
    held = control.c2d(plant, SAMPLE, "zoh")
    late = control.ss([], [], [], 1.0, SAMPLE)
    if delay:
        late = control.ss(np.eye(delay, k=-1), np.eye(delay)[:, :1], np.eye(delay)[-1:], 0.0, SAMPLE)
    loop = control.series(late, held, control.ss(*law.law, SAMPLE))
    loop = -1 * loop
    closed, cut = (gb.linearize(system, loop=each) for each in ("closed", "c0: axis.angle"))
    z = np.exp(closed.eigenvalue * SAMPLE)
    expected = control.poles(control.feedback(loop, 1))
    moduli = np.sort(np.abs(z))[-len(expected) :]
    np.testing.assert_allclose(moduli, np.sort(np.abs(expected))[-len(moduli) :], atol=1e-8)
    w = np.unique(
        np.concatenate(
            [np.geomspace(1e-3, np.pi / SAMPLE, 2000), *(p + np.linspace(-2, 2, 1000) for p in (26.6, 84.3, 104.7))]
        )
    )
    some = np.exp(1j * w[::8] * SAMPLE)
    np.testing.assert_allclose(np.squeeze(cut.to_control()(some)), np.squeeze(loop(some)), rtol=1e-6, atol=1e-9)
    gain, phase, modulus, at_gain, *_ = control.stability_margins(control.frd(loop, w))
    (margin,) = closed.margins
    assert margin.drive == "c0: axis.angle"
    assert margin.gain == pytest.approx(gain, rel=1e-4)
    assert 2 * np.pi * margin.gain_frequency == pytest.approx(at_gain, rel=1e-4)
    assert np.degrees(margin.phase) == pytest.approx(phase, rel=1e-3)
    assert margin.modulus == pytest.approx(modulus, rel=1e-3)
    # Where the delay margin is used up the loop is at its limit.
    more = gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE, delay * SAMPLE + margin.delay)
    assert gb.linearize(satellite(more), loop="closed").eigenvalue[0].real == pytest.approx(0.0, abs=2e-3)


def test_a_reference_is_an_input_and_gains_at_rest_are_one() -> None:
    a, b, c, d = (-1 * each if k > 1 else each for k, each in enumerate(lead()))
    law = gb.Feedback((a, b, c, d), NAMES, ["axis.angle"], SAMPLE, reference=[0.0, 0.0])
    closed = gb.linearize(satellite(law), loop="closed", inputs=[], outputs=["axis.angle"])
    assert [each.name for each in closed.inputs] == ["c0: axis.angle", "c0: axis.angle_rate"]
    steady = closed.to_control()
    gain = (closed.c @ np.linalg.solve(np.eye(len(closed.a)) - closed.a, closed.b) + closed.d)[0, 0]
    assert gain == pytest.approx(1.0, rel=1e-9) and steady.dt == SAMPLE


def test_two_controllers_at_one_rate_and_what_is_refused() -> None:
    half = tuple(each * (0.5 if k > 1 else 1.0) for k, each in enumerate(lead()))
    one = gb.linearize(satellite(gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE)), loop="closed")
    two = gb.linearize(satellite(*[gb.Feedback(half, NAMES, ["axis.angle"], SAMPLE)] * 2), loop="closed")
    np.testing.assert_allclose(two.eigenvalue[:6], one.eigenvalue[:6], rtol=1e-7)
    assert [each.drive for each in two.margins] == ["c0: axis.angle", "c1: axis.angle"]
    refused: list[tuple[Any, str, str]] = [
        ([gb.Feedback(lambda t, y: -np.sign(y[:1]), NAMES, ["axis.angle"], SAMPLE)], "closed", "in proportion"),
        ([gb.Feedback(lambda t, y: np.abs(y[:1]), NAMES, ["axis.angle"], SAMPLE)], "closed", "in proportion"),
        ([gb.Feedback(lambda t, y: [2.0], NAMES, ["axis.angle"], SAMPLE)], "closed", "asks for 2 N m of axis.angle"),
        ([gb.Feedback(half, NAMES, ["axis.angle"], s) for s in (0.01, 0.0101234)], "closed", "beside 0.01 s"),
        ([gb.Feedback(half, NAMES, ["axis.angle"], s) for s in (0.01, 10.0)], "closed", "at most 1,000 samples"),
        ([], "closed", "'closed'"),
    ]
    for laws, loop, problem in refused:
        with pytest.raises(gb.InputError, match=problem):
            gb.linearize(satellite(*laws), loop=loop)


def test_a_function_is_linearised_where_it_asks_for_nothing() -> None:
    """With a state as its matrices; curved by its slope where the system rests, or else without an error."""
    a, b, c, d = lead()
    a, b, c, d = gb.Feedback((a, b, c, d), NAMES, ["axis.angle"], SAMPLE).law

    def function(t: float, y: Any, state: Any) -> Any:
        return np.sinh(c @ state + d @ y), a @ state + b @ np.tan(y)

    def curved(t: float, y: Any) -> Any:
        return -50.0 * np.tanh(2 * y[:1]) - 150.0 * y[1:]

    def aside(t: float, y: Any) -> Any:
        return curved(t, y - (0.3, 0.0))

    options: Any = {"measure": NAMES, "drive": ["axis.angle"], "sample": SAMPLE, "delay": 0.5 * SAMPLE}
    linear = gb.Feedback(gains([[-100.0, -150.0]]), **options)
    referred = gb.Feedback(lambda t, e: -curved(t, e), reference=[0.3, 0.0], **options)
    pairs = [
        (gb.Feedback(function, state=np.zeros(2), **options), gb.Feedback(lead(), **options), 0.0),
        (gb.Feedback(curved, **options), linear, -0.5),
        (gb.Feedback(aside, **options), linear, 0.3),
        (referred, linear, 0.3),
        (referred, linear, 0.0),
    ]
    for law, matrices, angle in pairs:
        one, other = (gb.linearize(satellite(each, angle=angle), loop="closed") for each in (law, matrices))
        np.testing.assert_allclose(one.a, other.a, rtol=0, atol=1e-7 * np.abs(other.a).max())
        assert one.margins[0].gain == pytest.approx(other.margins[0].gain, rel=1e-6)


def test_a_run_under_curved_laws_of_two_rates_decays_by_the_poles() -> None:
    def quick(t: float, y: Any) -> Any:
        return -1.8 * np.tanh(y[:1]) - 5.0 * np.sinh(y[1:])

    def slow(t: float, y: Any, state: Any) -> Any:
        return -0.2 * y[:1] - state, state + 0.05 * (np.sin(y[1:]) - state)

    controllers = {
        "quick": gb.Feedback(quick, NAMES, ["axis.angle"], 0.05, 0.02),
        "slow": gb.Feedback(slow, NAMES, ["axis.angle"], 0.07, 0.105, state=np.zeros(1)),
    }
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial_rate=1e-4)
    system = gb.System({"hub": gb.RigidBody(1.0, (2.0, 2.0, 2.0))}, {"axis": axis}, controllers=controllers)
    response = gb.simulate(system, initial="undeformed", duration=21.0, step=0.05, estimate=False)
    late = np.interp([20.3, 20.65, 21.0], response.time, response.coordinate("axis.angle"))
    slowest = np.exp(0.35 * gb.linearize(system, loop="closed").eigenvalue[0])
    np.testing.assert_allclose(late[1:] / late[:-1], slowest, rtol=1e-6)


@pytest.mark.parametrize("gain", [-30.0, 40.0, 120.0])
def test_delay_margins_of_an_angle_fed_back_are_those_in_closed_form(gain: float) -> None:
    """L = g/(J s² + c s + k), late by half a sample: it crosses a gain of one where (k − J w²)² + c² w² = g².

    A gain that takes a part of the spring away, g < 0, crosses twice, at angles of L above zero.
    """
    inertia, damping, stiffness, sample = 2.0, 1.5, 80.0, 2e-3

    def held(delay: float) -> gb.StateSpace:
        axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], stiffness={"angle": stiffness}, damping={"angle": damping})
        law = gb.Feedback(gains([[-gain]]), ["axis.angle"], ["axis.angle"], sample, delay)
        bodies = {"hub": gb.RigidBody(1.0, (inertia,) * 3)}
        return gb.linearize(gb.System(bodies, {"axis": axis}, controllers={"c": law}), loop="closed")

    squares = np.roots([inertia**2, damping**2 - 2 * inertia * stiffness, stiffness**2 - gain**2])
    w = np.sqrt(squares[squares > 0])
    angles = np.angle(-gain / (inertia * (1j * w) ** 2 + damping * 1j * w + stiffness))
    assert len(w) == (1 if abs(gain) > stiffness else 2) and ((angles < 0) == (gain < 0)).all()
    phases = np.angle(np.exp(1j * (angles - w * sample / 2)))
    (margin,) = held(0.0).margins
    assert margin.delay == pytest.approx((angles % (2 * np.pi) / w).min() - sample / 2, rel=2e-5)
    assert margin.phase == pytest.approx(np.abs(phases).min(), rel=2e-5)
    # Where the delay margin is used up the loop is at its limit.
    growth = [held(share * margin.delay).eigenvalue.real.max() for share in (0.99, 1.01)]
    assert growth[0] < 0 < growth[1]
