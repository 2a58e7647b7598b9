"""Stress cycles: the standard's own example, and damage in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gbeam import Flight, Response, Sine, compare, simulate
from gbeam.analysis import Quantities, fatigue, stress_cycles
from gbeam.results import Fatigue

from ..analysis.helpers import strip, with_body


def test_cycles_of_the_standards_example() -> None:
    """ASTM E1049-85, figure 6: reversals −2, 1, −3, 5, −1, 3, −4, 4, −2."""
    cycles = stress_cycles(np.arange(9.0), np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2]))
    counts = {size: cycles.count[cycles.range == size].sum() for size in (3, 4, 6, 8, 9)}
    assert counts == {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5} and cycles.total == 4.0


def test_cycles_of_an_oscillation() -> None:
    """Ten periods of amplitude 3 about 1, sampled beside its extremes."""
    t = np.linspace(0, 10, 141)
    cycles = stress_cycles(t, 1 + 3 * np.sin(2 * np.pi * t))
    assert cycles.total == pytest.approx(10.0, abs=0.51)
    full = cycles.range > 5
    np.testing.assert_allclose(cycles.range[full], 6.0, rtol=1e-4)
    np.testing.assert_allclose(cycles.mean[full], 1.0, atol=1e-3)
    assert cycles.equivalent_range(4.0) == pytest.approx(6.0 * 9.5**0.25, rel=2e-3)


def damage(flight: Response, machine: Response) -> Fatigue | None:
    return fatigue(Quantities.from_response("flight", flight), Quantities.from_response("centrifuge", machine))


def flown(amplitude: float) -> Response:
    return simulate(strip("FOAM", (0, 0, 2), 0.05), Flight(z=Sine(amplitude, 0.1)), duration=0.4, step=1e-3)


def test_damage_grows_with_the_power_of_the_stress() -> None:
    once, twice = flown(50.0), flown(100.0)
    same, more = damage(once, once), damage(once, twice)
    assert same is not None and more is not None
    assert same.exponent == 5.0 and same.damage_ratio == pytest.approx(1.0)
    assert more.damage_ratio == pytest.approx(2.0**5, rel=1e-3)
    beside_rounding = damage(flown(1e-70), once)
    assert beside_rounding is not None and beside_rounding.damage_ratio == math.inf
    assert once.loads is not None
    gentle, twice_as_much = (with_body(each, loads=replace(each.loads, fatigue_exponent=3.0)) for each in (once, twice))
    milder = damage(gentle, twice_as_much)
    assert milder is not None and milder.damage_ratio == pytest.approx(2.0**3, rel=1e-3)
    assert damage(gentle, twice) is None  # of another material
    assert damage(once, with_body(twice, loads=None)) is None


def test_no_cycles_no_damage() -> None:
    """A steady stress has rounding errors, which are no cycles."""
    still = flown(1.0)
    assert still.loads is not None
    steady = 1e7 * (1 + 1e-15 * np.random.default_rng(0).normal(size=len(still.time)))
    still = with_body(still, loads=replace(still.loads, fibre=steady[:, None]))
    none = damage(still, still)
    assert none is not None and none.flight.total == 0 and np.isnan(none.damage_ratio)


def test_peaks_of_a_comparison_lie_between_samples() -> None:
    """Of the response where they lie in the flight's time, else of the samples there."""
    once = flown(50.0)
    whole = compare(once, once).peaks
    loads = once.peaks.loads
    assert loads is not None and whole["tip"].machine == once.peaks.max_size
    assert whole["root_moment"].flight == loads.moment[0].size.value
    assert whole["stress"].flight == loads.stress.value.max()
    early = replace(once, time=once.time + 10.0)  # as if the response's peaks lay in a spin-up, before
    shifted = compare(early, early).peaks
    for name, pair in shifted.items():
        assert pair.flight == pytest.approx(whole[name].flight, rel=1e-3)
        assert pair.time_flight == pytest.approx(whole[name].time_flight + 10.0, abs=1e-3)
