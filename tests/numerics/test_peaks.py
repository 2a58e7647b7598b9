"""Peaks between samples: polynomials come back exactly, oscillations at the order of the interpolation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gbeam.numerics import length_peaks, maxima, near_maxima, quintic_hermite, seven_point, turning_points, vector_peaks

OMEGA, PHASE = np.array([1.0, 1.7]), np.array([-1.0, -2.0])


def wave(t: np.ndarray, derivative: int = 0) -> np.ndarray:
    """Two oscillations of amplitude one, (t, 2), or a derivative of them."""
    return OMEGA**derivative * np.sin(np.asarray(t)[..., None] * OMEGA + PHASE + derivative * np.pi / 2)


def by_derivatives(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sizes = np.abs(wave(t))
    times, between = quintic_hermite(t, wave(t), wave(t, 1), wave(t, 2), near_maxima(t, sizes))
    return maxima(t, sizes, times, np.abs(between))


def by_samples(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    sizes = np.abs(wave(t))
    times, between = seven_point(t, wave(t), near_maxima(t, sizes))
    return maxima(t, sizes, times, np.abs(between))


@pytest.mark.parametrize(("peaks", "order"), [(by_derivatives, 6), (by_samples, 7)])
def test_peaks_of_oscillations_at_the_order_of_the_interpolation(
    peaks: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], order: int
) -> None:
    errors = []
    for step in (0.3, 0.15):
        worst = np.zeros(2)
        for shift in np.linspace(0, 1, 9):  # of the samples against the peaks
            value, time = peaks((np.arange(80) + shift) * step)
            worst = np.maximum(worst, np.abs(value - 1))
            np.testing.assert_allclose(np.diagonal(wave(time, 1)), 0, atol=0.01)
        errors.append(worst.max())
    # Halving the step ends at what the parabola through three of the evaluated points leaves.
    assert errors[0] < 1e-5 and errors[1] < max(errors[0] / 2 ** (order - 1), 1e-7)


def test_a_polynomial_is_its_own_interpolation() -> None:
    """Of fifth degree with derivatives, of fourth without: there the sixth must change less than the fourth."""
    rng = np.random.default_rng(1)
    t, at = np.cumsum(rng.uniform(0.5, 1.5, 20)), np.arange(1, 19)
    around = np.stack([t[at - 1], t[at], t[at + 1]], axis=1)
    for degree in (5, 4):
        p = np.polynomial.Polynomial(rng.normal(size=degree + 1), domain=[t[0], t[-1]])
        if degree == 5:
            times, answer = quintic_hermite(t, *(d(t)[:, None] for d in (p, p.deriv(), p.deriv(2))), at)
        else:
            times, answer = seven_point(t, p(t)[:, None], at)
        np.testing.assert_allclose(answer[..., 0], p(times), atol=1e-9 * np.abs(p(t)).max())
        np.testing.assert_allclose(times[:, [0, 8, 16]], around)


@pytest.mark.parametrize(
    "samples", [[0, 0, 0, 0, 1, 1, 1, 1, 1], [0, 1, 2, 3, 4, 4, 4, 4, 4], [0, 0, 0, 0, 1, 0, 0, 0, 0]]
)
def test_jumps_corners_and_spikes_are_not_exceeded(samples: list[float]) -> None:
    values, t = np.array(samples, dtype=float)[:, None], np.arange(9.0)
    times, between = seven_point(t, values, near_maxima(t, values))
    value, when = maxima(t, values, times, between)
    assert value[0] == values.max() and when[0] == np.argmax(values)


@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_too_few_samples_are_what_they_are(count: int) -> None:
    t = np.arange(float(count))
    values = np.sin(t)[:, None]
    value, when = maxima(t, values, *seven_point(t, values, near_maxima(t, values)))
    assert value[0] == values.max() and when[0] == t[values[:, 0].argmax()]
    assert turning_points(t, values[:, 0])[[0, -1]].tolist() == values[[0, -1], 0].tolist()


def test_turning_points_lie_between_samples() -> None:
    t = np.arange(0, 60, 0.35)
    answer = turning_points(t, np.sin(t) + 2)
    np.testing.assert_allclose(answer[1:-1], 2 + (-1.0) ** np.arange(len(answer) - 2), atol=1e-4)
    assert answer[0] == 2.0 and answer[-1] == np.sin(t[-1]) + 2
    assert turning_points(t, np.ones_like(t)).tolist() == [1.0, 1.0]


def test_few_windows_of_a_long_vibration() -> None:
    """A million samples need a handful of polynomials."""
    t = np.arange(100_000) * 0.15
    assert len(near_maxima(t, np.sin(t)[:, None])) <= 130


def test_several_runs_have_each_the_peaks_that_they_have_alone() -> None:
    """To the last digit; of one without a turn inside, too, and where more turns are near the highest than are kept."""
    rng = np.random.default_rng(2)
    t = np.cumsum(rng.uniform(0.1, 0.2, 700))
    phase, shares = rng.uniform(0, 6, (4, 1, 3)), np.array([0.0, 1.0, 1.0, 7.0])[:, None, None]
    angle = shares * t[:, None] + phase
    runs = [np.sin(angle) + 0.1 * (shares == 0) * t[:, None], shares * np.cos(angle), -(shares**2) * np.sin(angle)]
    sizes = np.abs(runs[0])
    at = near_maxima(t, sizes)
    times, between = quintic_hermite(t, runs[0], runs[1], runs[2], at)
    together = maxima(t, sizes, times, np.abs(between), at)
    for k in range(4):
        by_itself = near_maxima(t, sizes[k])
        np.testing.assert_array_equal(by_itself, at[at // len(t) == k] - k * len(t))
        times, between = quintic_hermite(t, *(each[k] for each in runs), by_itself)
        for ours, alone in zip(together, maxima(t, sizes[k], times, np.abs(between)), strict=True):
            np.testing.assert_array_equal(ours[k], alone)


RATE = 2 * np.pi / 0.73  # of a vibration with 0.73 steps to a period


@pytest.mark.parametrize("angle", [RATE, 2 * np.arctan(RATE / 2)], ids=["sampled", "by steps of Newmark's"])
def test_what_vibrates_within_steps_does_not_exceed_its_samples(angle: float) -> None:
    """A thousandth of a slow history, whose largest sample is 3e-7 too small; its velocity says nine times as much."""
    t = np.arange(400.0)
    slow = [0.01**k * np.sin(0.01 * t + k * np.pi / 2) for k in range(3)]
    quick = [1e-3 * RATE**k * np.cos(angle * t + k * np.pi / 2) for k in range(3)]
    for parts, peak, tolerance in ((slow, 1.0, 2e-7), ([a + b for a, b in zip(slow, quick, strict=True)], None, 2e-5)):
        q, qd, qdd = (each[:, None] for each in parts)
        value, _ = maxima(t, q, *quintic_hermite(t, q, qd, qdd, near_maxima(t, q)))
        assert value[0] == pytest.approx(peak or q.max(), abs=tolerance)


def test_lengths_of_vectors_peak_between_samples_in_each_run() -> None:
    time = np.arange(60) * 0.1
    grown = 1 + 0.2 * np.sin(time - np.array([[0.93], [1.47]]))  # largest a quarter of a turn after its phase
    vectors = grown[..., None] * np.stack([np.cos(3 * time), np.sin(3 * time), 0 * time], axis=-1)
    largest, when = length_peaks(time, vectors)
    np.testing.assert_allclose(largest, 1.2, rtol=1e-7)
    np.testing.assert_allclose(when, np.array([0.93, 1.47]) + np.pi / 2, atol=1e-4)
    both, times = vector_peaks(time, vectors)
    np.testing.assert_array_equal(both[:, 3], largest)
    np.testing.assert_array_equal(times[:, 3], when)
