"""Loss of stability of a run: by how much a disturbance grows meanwhile, and what a run says of it.

Critical values in closed form: Euler, Greenhill, Beck; see tests/analysis_verbs/test_critical_loads.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis import Excitation as Drive
from gbeam.analysis import lowest_over_time, worst_loss
from gbeam.results import Base

from .helpers import EI, LENGTH, LINE, OMEGA, SECTION, strip

TLAM = strip("TLAM")
EULER, GREENHILL, BECK = np.pi**2 / 4, 7.8373, 20.051
AGREES = 5e-3  # of FOAM with four clamped-free shapes


def spin(rate: np.ndarray) -> Base:
    """Rotation about y, in whose plane the strip bends, hub radius 0; an angular acceleration that must not matter."""
    o = np.zeros_like(rate)
    return Base(np.stack([o, o, o], 1), np.stack([o, rate, o], 1), np.stack([o, rate, o], 1))


def base_of(history: Base) -> tuple[Any, Any, Any]:
    return history.a_WO_B, history.w_WB_B, history.alpha_WB_B


def at_rest(structure: Any, time: np.ndarray) -> np.ndarray:
    return np.zeros((len(time), structure.size))


def test_tlam_softens_by_the_square_of_the_rate() -> None:
    """TLAM without foreshortening has K − Ω²M in the plane of rotation: lost at Ω = ω₁."""
    rate = np.array([0.0, 0.5, 1.0]) * OMEGA
    answer = lowest_over_time(TLAM.coefficients, Drive(*base_of(spin(rate))))
    np.testing.assert_allclose(answer, OMEGA**2 - rate**2, atol=1e-8 * OMEGA**2)


@pytest.mark.parametrize("count", [9, 100])
def test_the_loss_is_found_between_the_samples(count: int) -> None:
    time = np.linspace(0, 2, count)
    loss = worst_loss(TLAM, time, spin(time * OMEGA), at_rest(TLAM, time))
    assert loss is not None and loss.start == pytest.approx(1.0, abs=1e-3) and not loss.flutter
    assert loss.end == 2.0


def test_no_loss_and_loss_from_the_start() -> None:
    time = np.linspace(0, 1, 5)
    q = at_rest(TLAM, time)
    assert worst_loss(TLAM, time, spin(0.9 * OMEGA * time), q) is None
    loss = worst_loss(TLAM, time, spin((2 - time) * OMEGA), q)
    assert loss is not None and loss.start == 0.0 and loss.causes == (f"the base turns at {2 * OMEGA:.4g} rad/s",)


def test_foam_does_not_lose_it_on_a_hub() -> None:
    rate, time = np.linspace(0, 5 * OMEGA, 20), np.linspace(0, 1, 20)
    base = spin(rate)
    on_rim = Base(np.outer(rate**2, [-LENGTH, 0, 0]), base.w_WB_B, base.alpha_WB_B)
    assert worst_loss(strip(), time, on_rim, at_rest(strip(), time)) is None


def column(kind: str, *loads: gb.Load, damping: float = 0.0, counts: tuple[int, int, int] = (0, 0, 4)) -> Any:
    """The strip, loaded."""
    beam = gb.Beam(LENGTH, SECTION, gb.Material(2700.0, 7e10), damping_ratio=damping, loads=loads, rotary_inertia=False)
    return gb.assemble(beam, gb.Model(kind, *counts))


def ran(structure: Any, motion: Any = None, duration: float = 2.0) -> gb.Response:
    motion = gb.Flight(z=gb.constant(0.0)) if motion is None else motion
    return gb.simulate(structure, motion, duration=duration, step=duration / 500, integrator="gauss", estimate=False)


def axial(profile: Any) -> Any:
    return gb.vector(x=profile)


def unstable(response: gb.Response) -> bool:
    return response.outcome != "done" or any("definite" in each or "not stable" in each for each in response.warnings)


def test_the_growth_is_that_of_one_shape() -> None:
    """q̈ = ω²(P/P₁ − 1) q of a column with one shape under a constant load."""
    one = {"counts": (0, 0, 1)}
    limit = gb.critical_load(column("FOAM", gb.Load(LENGTH, force=(-1.0, 0.0, 0.0)), **one)).value
    assert limit is not None
    structure = column("FOAM", gb.Load(LENGTH, force=(-1.5 * limit, 0.0, 0.0)), **one)
    time = np.linspace(0, 0.3, 50)
    still = Base(*np.zeros((3, 50, 3)))
    loss = worst_loss(structure, time, still, at_rest(structure, time))
    assert loss is not None and loss.growth == pytest.approx(0.3 * OMEGA * np.sqrt(0.5), rel=1e-6)
    assert (loss.start, loss.end) == (0.0, 0.3)


PUSHES = {
    # An axial load at the tip, dead; along the beam; the base's own push; its weight on a shaker that stands.
    "Euler": (lambda p: [gb.Load(LENGTH, force=axial(p))], EULER * EI / LENGTH**2, -1.0),
    "Greenhill": (lambda p: [gb.Load(distributed=axial(p))], GREENHILL * EI / LENGTH**3, -1.0),
    "push": (None, GREENHILL * EI / (LINE * LENGTH**3), 1.0),
}


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
@pytest.mark.parametrize("name", PUSHES)
def test_a_straight_column_that_is_pressed_too_far_is_lost(kind: str, name: str) -> None:
    """The load grows evenly: the loss is at the share that the closed form gives; just below it there is none."""
    loads, critical, sign = PUSHES[name]
    for most, lost in ((0.98, False), (1.25, True)):
        ramp = gb.SmoothStep(sign * most * critical, 2.0)
        structure = column(kind, *(loads(ramp) if loads else ()), counts=(1, 0, 4))
        answer = ran(structure, None if loads else gb.Flight(x=ramp, z=gb.constant(0.0)))
        assert unstable(answer) == lost
        if lost:
            assert answer.outcome == "diverged" and "stiffness is not positive definite from t = " in answer.message
            at = float(answer.message.partition("t = ")[2].partition(" s")[0])
            assert abs(float(ramp(at))) == pytest.approx(critical, rel=AGREES)
            assert ("beam.loads[0] acts with" if loads else "the root is pushed with") in answer.message
            assert ("use exact" in answer.message) == (
                kind == "FOAM"
            ) and "a small load across the beam" in answer.message


def test_an_exact_column_that_gives_way_is_followed() -> None:
    """A small load across decides where it goes: it bends far and rests where it is stable."""
    ramp = gb.SmoothStep(-1.2 * EULER * EI / LENGTH**2, 1.0)
    answer = ran(
        column("exact", gb.Load(LENGTH, force=gb.vector(x=ramp, z=gb.constant(1e-3))), damping=0.05, counts=(1, 0, 4))
    )
    assert answer.outcome == "done" and not unstable(answer)
    assert np.abs(answer.tip[:, 2]).max() > 0.3 * LENGTH


@pytest.mark.parametrize(("load", "lost"), [(0.95, False), (1.1, True)])
def test_a_follower_force_has_no_divergence_but_flutter(load: float, lost: bool) -> None:
    """Eight times Euler's load is nothing to a load that follows; Beck's is its limit."""
    push = gb.Load(LENGTH, force=(-load * BECK * EI / LENGTH**2, 0.0, 0.0), follower=True)
    answer = ran(column("FOAM", push, damping=1e-6))
    assert unstable(answer) == lost
    if lost:
        assert answer.outcome == "diverged" and "equilibrium is not stable from t = 0 s" in answer.message


@pytest.mark.parametrize(("share", "words"), [(0.005, ""), (0.15, "-fold meanwhile")])
def test_a_load_that_acts_briefly_is_no_loss(share: float, words: str) -> None:
    """Ten times Euler's load for shares of the first period: nothing has the time to grow a thousandfold."""
    period = 2 * np.pi / OMEGA
    knock = gb.Sine(-10 * EULER * EI / LENGTH**2, 2 * share * period, start=0.02)  # pushes, then pulls
    answer = ran(column("FOAM", gb.Load(LENGTH, force=axial(knock)), damping=0.01), duration=0.2)
    assert answer.outcome == "done" and unstable(answer) == bool(words)
    assert all(words in each for each in answer.warnings if "definite" in each)


def test_a_shaft_above_its_critical_speed_is_held_by_its_spin() -> None:
    """K − Ω²M is indefinite for a round beam that spins about its axis; seen from outside it only spins."""
    round_beam = gb.Beam(LENGTH, gb.Section.circle(0.004), gb.Material(2700.0, 7e10), damping_ratio=0.0)
    structure = gb.assemble(round_beam, gb.Model("FOAM", 0, 2, 2))
    base = gb.Flight(x=0.0, rates=gb.vector(x=gb.constant(1.5 * float(structure.rest[0][0])))).base(
        time := np.linspace(0, 1, 20)
    )
    assert (lowest_over_time(structure.coefficients, Drive(*base_of(base))) < 0).all()
    assert worst_loss(structure, time, base, at_rest(structure, time)) is None


def test_a_beam_among_other_bodies_loses_its_stability_alike() -> None:
    """In a system the same words tell of it, behind the name of the beam where several bodies deform."""
    section = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.assemble(gb.Beam(0.3, section, gb.Material(2700, 70e9), damping_ratio=0.01), "FOAM", axial=1, y=1, z=2)
    pushed = gb.Flight(x=gb.trapezoid(12000.0, jerk=120000.0, start=0.05, hold=0.2), z=1.0)
    how: dict[str, Any] = {"duration": 0.4, "step": 1e-3, "estimate": False}
    alone, among = gb.simulate(beam, pushed, **how), gb.simulate(gb.System.of(beam, "strip"), pushed, **how)
    assert alone.outcome == among.outcome == "diverged"
    assert among.message == alone.message
    short = gb.assemble(gb.Beam(0.1, section, gb.Material(2700, 70e9), damping_ratio=0.01), "FOAM", axial=1, y=1, z=2)
    two = gb.System({"strip": beam, "stub": short}, {"a": gb.Joint("fixed", "strip"), "b": gb.Joint("fixed", "stub")})
    assert gb.simulate(two, pushed, **how).message == f"strip: {alone.message}"
