"""The smooth-step slew, 2009 (43), and the sine pulse, 2009 (44), sharp and smoothed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import gbeam as gb
from gbeam.motion import Profile

WIDTH = 0.3
STEP, SINE = gb.SmoothStep(level=3.0, duration=2.0, start=0.5), gb.Sine(amplitude=5.0, duration=1.5)
T = np.linspace(-0.5, 3.0, 15)


def test_smooth_step_is_equation_43() -> None:
    t = np.linspace(0, 40, 81)
    early = 3 / 30 * (t - 30 / (2 * np.pi) * np.sin(2 * np.pi * t / 30))
    np.testing.assert_allclose(gb.SmoothStep(3.0, 30.0)(t), np.where(t < 30, early, 3.0), atol=1e-14)
    _, slope = gb.SmoothStep(3.0, 30.0).derivatives(t)
    np.testing.assert_allclose(slope, np.where(t < 30, 0.1 * (1 - np.cos(2 * np.pi * t / 30)), 0.0), atol=1e-14)


def test_a_smooth_step_begins_at_nothing() -> None:
    """Its rounding was a load of 4e-17 N, and a table of displacements and moments by it."""
    assert gb.SmoothStep(2.0, 0.1)(0.0) == 0 and gb.SmoothStep(2.0, 0.1)(0.1) == 2.0


def test_sine_is_equation_44() -> None:
    t = np.linspace(-2, 12, 57)
    inside = (t >= 0) & (t <= 10)
    np.testing.assert_allclose(gb.Sine(200.0, 10.0)(t), np.where(inside, 200 * np.sin(np.pi * t / 5), 0), atol=1e-12)


@pytest.mark.parametrize("profile", [STEP, SINE], ids=["smooth-step", "sine"])
def test_smoothing_equals_the_convolution(profile: Profile) -> None:
    rounded = gb.smoothed(profile, WIDTH)
    for t in T:
        corners = [float(b) for b in profile.breaks if abs(float(b) - t) < WIDTH / 2]
        expected = quad(
            lambda s, t=t: float(profile(s)) * (1 + np.cos(2 * np.pi * (t - s) / WIDTH)) / WIDTH,
            t - WIDTH / 2, t + WIDTH / 2, points=corners or None, epsabs=1e-12,
        )[0]  # fmt: skip
        assert float(rounded(t)) == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("profile", [STEP, SINE], ids=["smooth-step", "sine"])
def test_derivatives_of_the_smoothed_are_exact_to_the_third(profile: Profile) -> None:
    rounded = gb.smoothed(profile, WIDTH)
    exact, before, after = (rounded.derivatives(T + side, 3) for side in (0.0, -1e-5, 1e-5))
    for order in (1, 2, 3):
        finite = (after[order - 1] - before[order - 1]) / 2e-5
        np.testing.assert_allclose(exact[order], finite, atol=2e-6 * (1 + np.abs(exact[order]).max()))


@pytest.mark.parametrize("kind", [gb.SmoothStep, gb.Sine])
def test_refusals(kind: type) -> None:
    for arguments, where in (((1.0, 0.0), "duration"), ((1.0, 1.0, np.nan), "start")):
        with pytest.raises(gb.InputError) as caught:
            kind(*arguments)
        assert caught.value.where == where


def test_integral_of_the_smooth_step() -> None:
    """Half a level times the duration over the slew, the level times the time after; in between, by quadrature."""
    step = gb.SmoothStep(level=3.0, duration=30.0, start=2.0)
    times = np.array([0.0, 2.0, 9.0, 20.0, 32.0, 40.0])
    expected = [quad(lambda t: float(step(t)), 0.0, time, points=[2.0, 32.0])[0] for time in times]
    np.testing.assert_allclose(step.integral(times), expected, rtol=1e-12, atol=1e-12)
    assert step.integral(40.0) == pytest.approx(3.0 * (15.0 + 8.0), rel=1e-14)


def test_integral_of_a_spline() -> None:
    """Before, on every piece and after it, beside quadrature."""
    spline = gb.SplineProfile(3.0, np.repeat([1.0, -2.0, 0.5, 4.0, -1.0], [5, 1, 2, 1, 5]), 2.0)
    ends = [2.0 + each / 3 for each in range(10)]
    for time in (0.0, 2.0, 2.1, 3.0, 4.4, 5.0, 7.0):
        expected = sum(quad(spline, a, b)[0] for a, b in pairwise([e for e in ends if e < time] + [time]))
        whole = spline.integral(np.array(time)) - spline.integral(np.array(2.0))
        assert whole == pytest.approx(expected if time > 2 else time - 2.0, abs=1e-13)
