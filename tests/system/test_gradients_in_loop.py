"""Derivatives and batches through sampled controllers: of laws, limits, references, states and the plant."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from scipy.signal import cont2discrete

import gbeam as gb

from ..analysis.test_gradients import agree
from ..lagrange import quickly_compiled
from .test_feedback import NAMES, PANEL, SAMPLE, lead

Values = dict[str, Any]


def satellite(inertia: Any, angle: Any, *laws: gb.Feedback) -> gb.System:
    hub = gb.RigidBody(100.0, (50.0, 50.0, inertia), points={"rim": gb.Place((0.5, 0.0, 0.0), (np.pi / 2, 0.0, 0.0))})
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=angle)
    joints = {"axis": axis, "clamp": gb.Joint("fixed", "panel", "hub.rim")}
    named = {f"c{k}": each for k, each in enumerate(laws)}
    return gb.System({"hub": hub, "panel": PANEL}, joints, {"jet": gb.PointForce("panel.tip")}, controllers=named)


def figure(system: gb.System, duration: float = 0.3) -> Any:
    """A number of all that moves and of all that the loop records."""
    run = gb.simulate(system, duration=duration, step=0.01, initial="undeformed", estimate=False)
    assert run.loop is not None
    recorded = (1e-2 * run.loop.measured**2).sum() + (1e-3 * (run.loop.asked**2 + run.loop.applied**2)).sum()
    stress = 1e-6 * run.bodies["panel"].loads.stress[-3:].sum()
    return 10 * run.at("panel.tip")[-3:].sum() + recorded + stress


def of_matrices(at: Values) -> Any:
    """A delay that is no multiple of the sample, an accelerometer that is fed through, a limit and references."""
    a, b, c, d = lead()
    law = a, b, -at["gain"] * c, -at["gain"] * d
    names = ["axis.angle", "panel.tip.acceleration_z"]
    loop = gb.Feedback(law, names, ["axis.angle"], SAMPLE, 0.7 * SAMPLE, at["limit"], [at["aim"], 0.0])
    return figure(satellite(at["inertia"], at["angle"], loop))


def of_functions(at: Values) -> Any:
    """PI with a state of its own on the axis, and a jet at the tip, by a gauge too, of other samples."""

    def integral(t: float, y: Any, state: Any) -> tuple[Any, Any]:
        return -at["gain"] * y[:1] - 150.0 * y[1:] - state["sum"], {"sum": state["sum"] + at["rise"] * y[:1]}

    loops = (
        gb.Feedback(integral, NAMES, ["axis.angle"], SAMPLE, SAMPLE, state={"sum": np.ones(1) * at["sum"]}),
        gb.Feedback(
            lambda t, y: -at["push"] * (y[:1] + 1e-3 * y[1:]),
            ["panel.tip.velocity_y", "panel.root.moment_y"],
            ["jet.force_y"],
            1.5 * SAMPLE,
            0.01,
        ),
    )
    return figure(satellite(50.0, 0.1, *loops))


AT = {
    of_matrices: {"gain": 0.05, "limit": 0.42, "aim": 0.2, "inertia": 50.0, "angle": 0.1},
    of_functions: {"gain": 80.0, "rise": 2.0, "sum": 1.0, "push": 2.0},
}


@pytest.mark.parametrize("laws", AT)
def test_derivatives_through_a_loop(laws: Any) -> None:
    agree(laws, AT[laws])


def test_a_batch_of_gains_is_as_many_runs_and_no_number_has_no_derivative() -> None:
    def looped(gain: Any) -> Any:
        return figure(satellite(50.0, 0.1, gb.Feedback((*lead()[:3], gain * lead()[3]), NAMES, ["axis.angle"], SAMPLE)))

    gains = np.array([0.5, 1.0, 2.0, np.nan])
    values, slopes = quickly_compiled(jax.vmap(jax.value_and_grad(looped)))(gains)
    for gain, value in zip(gains[:3], values, strict=False):
        assert float(value) == pytest.approx(looped(float(gain)), rel=1e-12)
    assert (slopes[:3] != 0).all() and np.isnan(values[3]) and np.isnan(slopes[3])


def test_a_loop_that_leaves_all_bounds_has_no_derivative() -> None:
    def escaped(gain: Any) -> Any:
        law = gb.Feedback(lambda t, y: gain * y[:1] ** 3, NAMES, ["axis.angle"], SAMPLE)
        return figure(satellite(50.0, 0.1, law))

    value, slope = quickly_compiled(jax.value_and_grad(escaped))(1e7)
    assert np.isnan(value) and np.isnan(slope)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            lambda k: {"law": lambda t, y: k * np.sign(y[:1])},
            "looks at numbers that JAX traces; write it with jax.numpy",
        ),
        (lambda k: {"law": lambda t, y: k * y[:1] if t > 0.1 else y[:1]}, r"gives what JAX traces at 0\.12 s"),
        (lambda k: {"law": lambda t, y: k * y}, "gives 2 efforts"),
        (lambda k: {"law": lambda t, y: -y[:1], "sample": k}, "sample is traced by JAX"),
    ],
)
def test_laws_that_cannot_be_traced_are_refused(law: Any, words: str) -> None:
    def looped(k: Any) -> Any:
        arguments = {"sample": SAMPLE} | law(k)
        return figure(satellite(50.0, 0.1, gb.Feedback(measure=NAMES, drive=["axis.angle"], **arguments)))

    with pytest.raises(gb.InputError, match=words):
        quickly_compiled(jax.grad(looped))(0.02)


@pytest.mark.parametrize(
    ("question", "words"),
    [
        (lambda k: figure(satellite(50.0, k), k), "duration is traced by JAX"),
        (lambda k: gb.linearize(satellite(k, 0.0)).a.sum(), "is traced by JAX, and linearize looks"),
        (lambda k: gb.modes(satellite(k, 0.0)).frequency[0], "is traced by JAX, and modes looks"),
        (lambda k: gb.static(satellite(k, 0.0)).place[0, 0], "is traced by JAX, and static looks"),
    ],
)
def test_numbers_that_are_looked_at_cannot_be_traced(question: Any, words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        quickly_compiled(jax.grad(question))(0.1)


def test_what_a_traced_beam_carries_cannot_be_measured() -> None:
    def looped(modulus: Any) -> Any:
        section = gb.Section.rectangle(0.5, 0.02)
        panel = gb.assemble(gb.Beam(3.0, section, gb.Material(2700.0, modulus), damping_ratio=0.005), "FOAM", z=1)
        law = gb.Feedback(lambda t, y: -y, ["panel.root.moment_y"], ["axis.angle"], SAMPLE)
        axis = gb.Joint("revolute", "panel", axes=[(0, 1, 0)])
        return figure(gb.System({"panel": panel}, {"axis": axis}, controllers={"c": law}))

    with pytest.raises(gb.InputError, match=r"has 'panel\.root\.moment_y' of a beam that JAX traces"):
        quickly_compiled(jax.grad(looped))(70e9)


def test_a_law_in_continuous_time_is_sampled_by_tustins_rule() -> None:
    law = gb.Feedback(lead(), NAMES, ["axis.angle"], SAMPLE).law
    for ours, scipys in zip(law, cont2discrete(lead(), SAMPLE, method="bilinear"), strict=False):
        np.testing.assert_allclose(ours, scipys, rtol=1e-12)
