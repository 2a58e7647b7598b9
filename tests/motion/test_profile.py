"""Sums and stacks of profiles."""

import numpy as np
import pytest

import gbeam as gb

T = np.linspace(-1, 6, 29)
RAMP, SINE = gb.trapezoid(2.0, jerk=1.0, start=0.0, hold=1.0), gb.Sine(3.0, 2.0, start=1.0)


def test_sum_adds_and_smooths_part_by_part() -> None:
    both = gb.Sum((RAMP, SINE))
    np.testing.assert_allclose(both(T), RAMP(T) + SINE(T))
    np.testing.assert_allclose(gb.smoothed(both, 0.2)(T), gb.smoothed(RAMP, 0.2)(T) + gb.smoothed(SINE, 0.2)(T))
    np.testing.assert_allclose(both.breaks, [0, 1, 2, 3, 3, 5])
    assert np.all(np.diff(both.knots(0.1)) > 0) and both.knots(0.1)[0] == 0
    with pytest.raises(gb.InputError, match="one profile or more"):
        gb.Sum(())


def test_stack_fills_in_zeros() -> None:
    load = gb.vector(x=SINE, z=gb.Sum((RAMP, gb.constant(1.0))))
    np.testing.assert_allclose(load(T), np.stack([SINE(T), 0 * T, RAMP(T) + 1], axis=-1))
    assert load(0.3).shape == (3,)
    np.testing.assert_allclose(gb.smoothed(load, 0.2)(T)[:, 0], gb.smoothed(SINE, 0.2)(T))


def test_smoothing_twice_commutes() -> None:
    step = gb.SmoothStep(1.0, 2.0)
    once, again = gb.smoothed(gb.smoothed(step, 0.2), 0.5)(T), gb.smoothed(gb.smoothed(step, 0.5), 0.2)(T)
    np.testing.assert_allclose(once, again, atol=1e-9)
    flat = gb.smoothed(gb.smoothed(RAMP, 0.2), 0.5)
    np.testing.assert_allclose(flat(T), gb.smoothed(gb.smoothed(RAMP, 0.5), 0.2)(T), atol=1e-6)
