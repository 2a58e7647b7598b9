"""The linearised closed loop: against python-control, the sampled simulation, and delays in closed form."""

from __future__ import annotations

from typing import Any

import control
import numpy as np
import pytest

import gbeam as gb
from tests.system.test_feedback import NAMES, SAMPLE, lead, satellite


@pytest.mark.parametrize("delay", [0.0, 0.5 * SAMPLE, SAMPLE, 2.25 * SAMPLE])
def test_a_small_motion_follows_the_closed_loop(delay: float) -> None:
    """From sample to sample the response is A^k x, of the plant, the law and the commands that are still to act."""
    system = satellite(gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE, delay), angle=1e-5)
    closed = gb.linearize(system, loop="closed", outputs=["axis.angle", "panel.tip.place_y"])
    response = gb.simulate(system, initial="undeformed", duration=4.0, step=SAMPLE / 8, estimate=False)
    state, angles = np.zeros(len(closed.a)), []
    state[0] = 1e-5
    for _ in range(201):
        angles.append(closed.c @ state)
        state = closed.a @ state
    size = np.abs(angles).max(axis=0)
    moved = response.at("panel.tip")[::8, 1]
    np.testing.assert_allclose(response.coordinate("axis.angle")[::8], np.array(angles)[:, 0], atol=2e-5 * size[0])
    np.testing.assert_allclose(moved, np.array(angles)[:, 1], atol=2e-5 * size[1])
    slowest = closed.eigenvalue[0]
    assert slowest.real < 0 and closed.step == SAMPLE


@pytest.mark.parametrize("delay", [0, 1, 2])
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
            [np.geomspace(1e-3, np.pi / SAMPLE, 5000), *(p + np.linspace(-2, 2, 3000) for p in (26.6, 84.3, 104.7))]
        )
    )
    ours = cut.to_control()(np.exp(1j * w * SAMPLE))
    np.testing.assert_allclose(np.squeeze(ours), np.squeeze(loop(np.exp(1j * w * SAMPLE))), rtol=1e-6, atol=1e-9)
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
        ([gb.Feedback(lambda t, y: -y[:1], NAMES, ["axis.angle"], SAMPLE)], "closed", "is a function"),
        ([gb.Feedback(half, NAMES, ["axis.angle"], s) for s in (0.01, 0.02)], "closed", "beside 0.01 s"),
        ([], "closed", "'closed'"),
    ]
    for laws, loop, problem in refused:
        with pytest.raises(gb.InputError, match=problem):
            gb.linearize(satellite(*laws), loop=loop)
