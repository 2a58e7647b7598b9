"""Flight: translation only."""

from typing import Any

import numpy as np
import pytest

import gbeam as gb


def test_flight_is_its_load_without_rotation() -> None:
    flight = gb.Flight(z=gb.trapezoid(98.0, jerk=40.0, start=1.0, hold=4.0))
    t = np.linspace(0, 12, 25)
    base = flight.base(t)
    np.testing.assert_allclose(base.a_WO_B, flight.acceleration(t))
    assert not np.any(base.w_WB_B) and not np.any(base.alpha_WB_B) and base.w_WB_B.shape == (25, 3)
    assert flight.base(2.0).a_WO_B.shape == (3,)
    assert flight.corners(1.0).size == 4


def test_a_flight_with_rates_turns_as_its_rates_and_their_derivatives_say() -> None:
    flight = gb.Flight(z=9.8, rates=gb.vector(x=0.3, y=gb.trapezoid(2.0, jerk=4.0, start=1.0, hold=4.0)))
    base = flight.base(np.array([0.0, 1.25, 3.0]))
    np.testing.assert_allclose(base.w_WB_B, [[0.3, 0, 0], [0.3, 1.0, 0], [0.3, 2.0, 0]])
    np.testing.assert_allclose(base.alpha_WB_B, [[0, 0, 0], [0, 4.0, 0], [0, 0, 0]])


def test_a_level_factor_scales_accelerations_and_no_rates() -> None:
    ramp = gb.trapezoid(98.0, jerk=40.0, start=1.0, hold=4.0)
    plain = gb.Flight(x=-2.0, z=ramp, rates=gb.vector(y=gb.trapezoid(2.0, jerk=4.0, start=1.0, hold=4.0)))
    scaled = gb.Flight(x=-2.0, z=ramp, rates=plain.rates, scale="125 %")
    t = np.linspace(0.0, 8.0, 33)
    one, other = plain.base(t), scaled.base(t)
    np.testing.assert_allclose(other.a_WO_B, 1.25 * one.a_WO_B, rtol=1e-15)
    np.testing.assert_array_equal(other.w_WB_B, one.w_WB_B)
    np.testing.assert_array_equal(other.alpha_WB_B, one.alpha_WB_B)
    np.testing.assert_array_equal(scaled.corners(0.1), plain.corners(0.1))
    rounded = scaled.acceleration.smoothed(0.5).derivatives(t)
    for value, before in zip(rounded, plain.acceleration.smoothed(0.5).derivatives(t), strict=True):
        np.testing.assert_allclose(value, 1.25 * before, rtol=1e-14)
    assert scaled.level_factor == 1.25 and plain.level_factor is None
    assert gb.Flight(**scaled.arguments) == scaled != plain  # the factor once, and not twice


def test_a_level_factor_can_be_differentiated() -> None:
    import jax

    load = jax.grad(lambda scale: gb.Flight(z=9.8, scale=scale).base(0.0).a_WO_B[2])(1.0)
    assert float(load) == pytest.approx(9.8)


def test_components_are_profiles_or_numbers_and_vectors_go_by_name() -> None:
    ramp = gb.trapezoid(98.0, jerk=40.0, start=1.0, hold=4.0)
    flight = gb.Flight(z=ramp, x=-2.0)
    np.testing.assert_allclose(flight.base(4.0).a_WO_B, [-2.0, 0.0, 98.0])
    same = gb.Flight(acceleration=gb.vector(x=-2.0, z=ramp))
    np.testing.assert_array_equal(same.base(1.7).a_WO_B, flight.base(1.7).a_WO_B)
    np.testing.assert_array_equal(gb.Flight(acceleration=(0.0, 0.0, 9.8)).base(0.0).a_WO_B, [0.0, 0.0, 9.8])
    assert flight.kind == "flight" and not flight.free and flight.over(0.0, 1.0) is flight


@pytest.mark.parametrize(
    ("arguments", "where", "words"),
    [
        ({}, "acceleration", "give x, y or z"),
        ({"z": 1.0, "acceleration": (0.0, 0.0, 1.0)}, "z", "beside acceleration"),
        ({"x": gb.constant([1.0, 2.0, 3.0])}, "x", "acceleration = "),
        ({"acceleration": 9.8}, "acceleration", "give a list of numbers or a Profile"),
        ({"z": "fast"}, "z", "give a number"),
        ({"z": np.nan}, "z", "finite"),
        ({"z": 1.0, "scale": 0.0}, "scale", "positive"),
    ],
)
def test_what_is_no_flight_is_refused(arguments: dict[str, Any], where: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words) as caught:
        gb.Flight(**arguments)
    assert caught.value.where == where
