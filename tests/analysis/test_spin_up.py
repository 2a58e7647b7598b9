"""A response from standstill to standstill: the flight's clock, its span, and what a comparison takes of it."""

from typing import Any

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb

from ..lagrange import quickly_compiled
from ..specimens import strip

G = STANDARD_GRAVITY
MODEL = strip("FOAM", 0, 1, 1, damping_ratio=0.01)
FLIGHT = gb.Flight(z=gb.tabulated([0, 0.5, 1, 2], np.array([2, 2, 4, 3]) * G))
DURATION = 2.0


def machine(**options: Any) -> gb.Centrifuge:
    arguments = {"arm": 3.3, "control_point": 0.2, "inverse": "flat", "gravity": True, "smoothing": 0.2, **options}
    return gb.Centrifuge(FLIGHT, **arguments)


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"step": 0.011},  # does not divide the duration
        {"integrator": "gauss", "step": 0.004},
    ],
)
def test_the_clock_is_the_flights(how: dict[str, Any]) -> None:
    flight, spun = (gb.simulate(MODEL, each, duration=DURATION, **how) for each in (FLIGHT, machine()))
    assert spun.outcome == "done" and spun.axes is not None
    begin, end = machine().over(0, DURATION).extent
    # Whole steps of the flight's grid, and no more than a few beyond standstill.
    step = flight.time[1] - flight.time[0]
    assert begin - 2.1 * step < spun.time[0] <= begin and end <= spun.time[-1] < end + 2.1 * step
    assert flight.flight_span == spun.flight_span == (0.0, DURATION)
    first = int(np.searchsorted(spun.time, 0.0))
    np.testing.assert_array_equal(spun.time[first : first + len(flight.time)], flight.time)
    np.testing.assert_allclose(np.diff(spun.time), step, rtol=1e-9)
    compared = gb.compare(flight, spun)
    np.testing.assert_array_equal(compared.time, flight.time)
    # The machine's histories cover all of it; what is of the flight lies within it.
    assert len(spun.axes.reference) == len(spun.time) == len(spun.displacement)
    outside = (spun.time < 0) | (spun.time > DURATION)
    assert spun.axes.not_followed[outside].all() and not spun.axes.not_followed[~outside].any()
    assert (spun.peaks.time_of_max >= 0).all() and (spun.peaks.time_of_max <= DURATION).all()


def test_it_hangs_still_at_both_ends() -> None:
    spun = gb.simulate(MODEL, machine(), duration=DURATION, estimate=False)
    hanging = gb.static(MODEL, acceleration=tuple(spun.base.a_WO_B[0]))
    np.testing.assert_allclose(np.linalg.norm(spun.base.a_WO_B[[0, -1]], axis=1), G, rtol=1e-12)
    np.testing.assert_allclose(spun.tip[0], hanging.tip, atol=1e-12)
    assert not spun.base.w_WB_B[[0, -1]].any()
    # A gentle spin-up hardly shakes the specimen: it follows the equilibrium of every instant.
    way = spun.time < -0.1
    vibration = spun.tip[way, 2] - hanging.tip[2] / G * spun.base.a_WO_B[way, 2]
    assert np.abs(vibration).max() < 0.02 * np.abs(spun.tip[:, 2]).max()


def test_idle_and_a_part_of_the_times_prepared_for_have_no_spin_up() -> None:
    idle = gb.simulate(MODEL, machine(start="idle"), duration=DURATION, estimate=False)
    assert idle.time[[0, -1]].tolist() == [0.0, DURATION]
    prepared = machine(span=(0.0, DURATION))
    begin, end = prepared.extent
    early, late = (gb.simulate(MODEL, prepared, start=start, duration=0.5, estimate=False).time for start in (0.0, 1.5))
    assert early[0] <= begin and early[-1] == 0.5
    assert late[0] == 1.5 and late[-1] >= end


def test_given_times() -> None:
    spun = gb.simulate(MODEL, machine(spin_up=2.5, spin_down=4.0), duration=DURATION, estimate=False)
    assert spun.time[0] == pytest.approx(-2.5, abs=0.02) and spun.time[-1] == pytest.approx(DURATION + 4, abs=0.02)
    assert spun.outcome == "done" and 0.0 in spun.time


def test_a_traced_machine_needs_given_times() -> None:
    import jax

    def tip(arm: Any, **options: Any) -> Any:
        return gb.simulate(MODEL, machine(arm=arm, **options), duration=DURATION, step=0.02, estimate=False).tip[220, 2]

    with pytest.raises(gb.InputError, match='give spin_up and spin_down, or start = "idle"'):
        quickly_compiled(jax.grad(tip))(3.3)
    times = {"spin_up": 3.0, "spin_down": 3.0}
    slope = (tip(3.31, **times) - tip(3.29, **times)) / 0.02
    assert quickly_compiled(jax.grad(lambda arm: tip(arm, **times)))(3.3) == pytest.approx(slope, rel=1e-3)
