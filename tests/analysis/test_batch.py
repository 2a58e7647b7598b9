"""Many cases at once are the same cases one by one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from ..specimens import appendage, hub_beam, laden


def slew(level: float, duration: float) -> gb.Hub:
    return gb.Hub(radius=0.5, rate=gb.SmoothStep(level, duration))


def errors(response: gb.Response) -> list[float]:
    every = response.errors.displacement, response.errors.loads, response.errors.stress
    return [value for each in every for value in (each.step, each.total)]


def agree(cases: list[tuple[gb.Structure, Any]], within: float, **how: Any) -> list[gb.Response]:
    few = 4 if cases[0][0].linear and not cases[0][1].free else 2
    how = {"estimate": False, **how}
    together = dict(gb.simulate_batch(cases, together=few, **how))
    how.pop("one_structure", None)
    assert sorted(together) == list(range(len(cases)))
    for k, (structure, motion) in enumerate(cases):
        alone = gb.simulate(structure, motion, **how)
        size = np.abs(alone.displacement).max()
        assert together[k].outcome == alone.outcome and together[k].warnings == alone.warnings
        assert together[k].steps == alone.steps
        np.testing.assert_array_equal(together[k].time, alone.time)
        for ours, theirs in zip(errors(together[k]), errors(alone), strict=True):
            assert ours == pytest.approx(theirs, rel=1e-3, abs=within, nan_ok=True)
        np.testing.assert_allclose(together[k].displacement, alone.displacement, rtol=0, atol=within * size)
        np.testing.assert_allclose(together[k].peaks.max_abs, alone.peaks.max_abs, rtol=0, atol=within * size)
        np.testing.assert_allclose(together[k].q, alone.q, rtol=0, atol=within * np.abs(alone.q).max())
        ours, theirs = (each.body.qdd for each in (together[k], alone))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=10 * within * np.abs(theirs).max())
    return [together[k] for k in range(len(cases))]


@pytest.mark.parametrize(("integrator", "step"), [("newmark", 0.02), ("gauss", 0.05), ("generalized-alpha", 0.02)])
def test_slews_of_many_rates_and_durations(integrator: str, step: float) -> None:
    """Some share their corners' places among the steps and some do not; one has a structure of other sizes."""
    model, other = hub_beam("FOAM", y=2), hub_beam("FOAM", axial=0, y=2)
    motions = [(3.0, 2.0), (2.5, 2.0), (2.0, 1.03), (3.0, 1.57), (1.0, 0.41)]
    cases = [(model, slew(*each)) for each in motions] + [(other, slew(3.0, 2.0)), (other, slew(2.0, 2.0))]
    agree(cases, 1e-11, duration=3.0, integrator=integrator, step=step)


def test_flights_with_loads_and_structures_of_their_own() -> None:
    """Everything at once: bodies off the axis, springs, loads that follow; damping and stiffness differ."""
    stiffer = gb.assemble(appendage(gb.PointMass(8.0, 0.2), damping_ratio=0.02), "FOAM", axial=1, y=2)
    flights = [gb.Flight(x=1.0, y=gb.trapezoid(a, jerk=10 * a, start=0.1, hold=0.5), z=0.5) for a in (1.0, 2.0)]
    cases = [(structure, flight) for structure in (laden("FOAM"), stiffer, hub_beam("FOAM", y=2)) for flight in flights]
    agree(cases, 1e-11, duration=1.0, integrator="newmark", step=0.02, loads=True)


def test_cases_of_equal_sizes_with_and_without_loads_stand_apart() -> None:
    loaded = gb.assemble(
        appendage(gb.PointMass(8.0, 0.1), loads=[gb.Load(8.0, force=(0.0, 1.0, 0.0))]), "FOAM", axial=1, y=2
    )
    flights = [gb.Flight(y=gb.trapezoid(a, jerk=10 * a, start=0.1, hold=0.5)) for a in (1.0, 2.0)]
    cases = [(structure, flight) for flight in flights for structure in (hub_beam("FOAM", y=2), loaded)]
    agree(cases, 1e-11, duration=1.0, integrator="newmark", step=0.02)


@pytest.mark.parametrize("integrator", ["gauss", "newmark"])
def test_free_hubs(integrator: str) -> None:
    """Of FOAM, whose equations are polynomials; torques with a jump are split there, and the scheme starts anew."""
    model = hub_beam("FOAM", y=2)
    torques = [gb.Sine(200.0, 2.0), gb.Sine(150.0, 2.0), gb.Sine(100.0, 1.03), gb.Sine(50.0, 0.97)]
    cases = [(model, gb.Hub(radius=0.5, inertia=200.0, torque=torque)) for torque in torques]
    agree(cases, 1e-7, duration=3.0, integrator=integrator, step=0.02)


@pytest.mark.parametrize(("integrator", "step"), [("newmark", None), ("gauss", None), ("gauss", 0.05)])
def test_cases_whose_steps_follow_from_their_errors(integrator: str, step: float | None) -> None:
    """They need different numbers of runs and steps; the last one moves too far for its model."""
    model = hub_beam("FOAM", y=2)
    motions = [slew(3.0, 2.0), slew(0.5, 1.5), slew(3.0, 0.31), slew(1e3, 2.0)]
    cases = [(model, motion) for motion in motions]
    responses = agree(cases, 1e-9, duration=3.0, integrator=integrator, step=step, estimate=True, tolerance=1e-3)
    if step is None:
        assert len({response.steps for response in responses[:3]}) > 1
    assert responses[-1].outcome == "diverged"


def test_free_hubs_whose_steps_follow_from_their_errors() -> None:
    model = hub_beam("FOAM", y=2)
    hubs = [gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(torque, 2.0)) for torque in (200.0, 20.0)]
    agree([(model, hub) for hub in hubs], 1e-6, duration=2.0, integrator="gauss", tolerance=1e-3)


def test_a_case_that_leaves_its_model_or_cannot_be_solved_is_integrated_alone() -> None:
    """TLAM beyond its critical speed beside a slow slew: the same outcome and message as alone."""
    model = hub_beam("TLAM", y=2)
    responses = agree([(model, slew(0.5, 2.0)), (model, slew(30.0, 0.5))], 1e-9, duration=8.0, step=0.02)
    assert [each.outcome for each in responses] == ["done", "diverged"]


def digits(response: gb.Response) -> bytes:
    arrays = (response.q, response.qd, response.body.qdd, response.displacement, response.peaks.max_abs)
    return b"".join(np.ascontiguousarray(each).tobytes() for each in arrays)


KINDS = ["slews", "slews by gauss", "automatic steps", "structures", "free hubs", "exact hubs of one structure"]


@pytest.mark.parametrize("kind", KINDS)
def test_what_stands_beside_a_case_does_not_change_a_digit_of_it(kind: str) -> None:
    """Batches of one width of cases in a random order, some left out: the last one is filled, or of one case."""
    random, model, together = np.random.default_rng(5), hub_beam("FOAM", y=2), 4
    how: dict[str, Any] = {"duration": 3.0, "integrator": "newmark", "step": 0.02}
    cases: list[tuple[gb.Structure, Any]] = [(model, slew(level, 2.0)) for level in np.linspace(1, 3, 6)]
    if kind == "slews by gauss":  # those of another duration end within a step, which is split there
        how |= {"integrator": "gauss", "step": 0.05}
        cases = [(model, slew(level, end)) for level in (1.0, 2.0, 3.0) for end in (1.03, 2.0)]
    if kind == "automatic steps":
        how = {"duration": 3.0, "tolerance": 1e-3}
        cases = [(model, slew(level, end)) for level in (1.0, 3.0) for end in (0.31, 2.0)]
    if kind == "structures":
        dampings = [gb.assemble(appendage(damping_ratio=0.01 * k), "FOAM", axial=1, y=2) for k in range(3)]
        cases += [(each, slew(2.0, 2.0)) for each in dampings]
    if kind.endswith(("free hubs", "one structure")):  # the largest needs more corrections, and those beside it no more
        together, how["integrator"] = 2, "gauss"
        torques = [10.0, 100.0, 2e4, 200.0, 4e4]
        if kind != "free hubs":
            model, torques, how = hub_beam("exact", y=2), [10.0, 200.0, 2000.0], {**how, "one_structure": True}
        cases = [(model, gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(torque, 2.0))) for torque in torques]
    alone = {}
    for k, case in enumerate(cases):
        ((_, response),) = gb.simulate_batch([case], together=together, **how)
        alone[k] = digits(response)
    for _ in range(4):
        some = random.permutation(len(cases))[: random.integers(2, len(cases) + 1)]
        beside = gb.simulate_batch([cases[k] for k in some], together=together, **how)
        assert all(digits(response) == alone[some[place]] for place, response in beside)


def test_one_structure_gives_what_each_case_gives_alone() -> None:
    """Of an exact beam, whose arrays then are the same for all; the torques jump, and the scheme starts anew there."""
    model = hub_beam("exact", y=2)
    hubs = [gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(torque, 1.03)) for torque in (200.0, 50.0)]
    agree([(model, hub) for hub in hubs], 1e-7, duration=3.0, integrator="gauss", step=0.02, one_structure=True)


def test_no_more_cases_are_taken_than_wait_for_others() -> None:
    taken = []

    def cases() -> Iterator[tuple[gb.Structure, gb.Hub]]:
        for k in range(9):
            taken.append(k)
            yield hub_beam("FOAM", y=2), slew(1.0 + 0.1 * k, 2.0)

    responses = gb.simulate_batch(cases(), together=4, duration=3.0, integrator="newmark", step=0.02)
    assert next(responses)[0] == 0 and taken == [0, 1, 2, 3]
    assert len(list(responses)) == 8


def test_what_a_batch_refuses() -> None:
    cases = [(hub_beam("FOAM", y=2), slew(1.0, 2.0))]
    with pytest.raises(gb.InputError, match="together is 0"):
        gb.simulate_batch(cases, duration=3.0, step=0.1, together=0)
    cases.append((gb.assemble(appendage(), "FOAM", axial=1, y=2), slew(1.0, 2.0)))
    with pytest.raises(gb.InputError, match="one_structure is true, and case 1 has another structure than the first"):
        list(gb.simulate_batch(cases, duration=3.0, step=0.1, one_structure=True))


def craft(width: float, amplitude: float) -> gb.System:
    """A bus that a wheel turns, with a panel on a sprung hinge."""
    section = gb.Section.rectangle(width=width, thickness=0.01)
    panel = gb.assemble(gb.Beam(1.0, section, gb.Material(300, 1e9), damping_ratio=0.01), "FOAM", axial=0, y=1, z=2)
    bus = gb.RigidBody(5.0, (0.4, 0.5, 0.6), points={"side": (0.3, 0, 0)})
    hinge = gb.Joint("revolute", "panel", on="bus.side", axes=[(0, 1, 0)], stiffness=20.0, damping=0.1)
    wheel = gb.PointForce("bus.root", moment=gb.vector(y=gb.Sine(amplitude, 1.0)), follower=True)
    return gb.System({"bus": bus, "panel": panel}, {"orbit": gb.Joint("free", "bus"), "hinge": hinge}, {"wheel": wheel})


def test_systems_of_bodies() -> None:
    cases = [(craft(width, amplitude), None) for width, amplitude in ((0.2, 0.3), (0.25, 0.5), (0.2, 0.4))]
    how: dict[str, Any] = {"duration": 1.0, "step": 0.01, "estimate": False}
    together = dict(gb.simulate_batch(cases, together=2, **how))
    assert sorted(together) == [0, 1, 2]
    for k, (system, _) in enumerate(cases):
        alone, one = gb.simulate(system, **how), together[k]
        assert (one.outcome, one.steps, one.warnings) == (alone.outcome, alone.steps, alone.warnings)
        for key in ("place", "velocity", "q"):
            ours, theirs = getattr(one, key), getattr(alone, key)
            np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-9 * np.abs(theirs).max())
        ours, theirs = (each.bodies["panel"].loads.root_moment for each in (one, alone))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-7 * np.abs(theirs).max())
