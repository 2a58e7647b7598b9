"""Curves of equilibria followed by arc length, on curves that are known."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, takewhile

import numpy as np
import pytest

from gbeam.numerics import Curve

Floats = np.ndarray


def turning(bent: float) -> Curve:
    """v = y₁³ − 3 y₁ with y₂ = y₁²: limits at y₁ = ∓1."""

    def residual(y: Floats, value: float) -> Floats:
        return np.array([y[0] ** 3 - 3 * y[0] - value, y[1] - y[0] ** 2])

    def slopes(y: Floats, value: float) -> tuple[Floats, Floats]:
        return np.array([[3 * y[0] ** 2 - 3, 0.0], [-2 * y[0], 1.0]]), np.array([-1.0, 0.0])

    return Curve(residual, slopes, np.eye(2), 4.0, bent)


def followed(bent: float) -> list:
    curve = turning(bent)
    first = curve.begin(np.array([-2.0, 4.0]), -2.0)
    return list(takewhile(lambda point: point.value < 10.0, curve.follow(first, 0.05)))


def chord(points: list) -> float:
    """Largest distance of the middle of a chord from the curve, in y₂."""
    y = np.array([point.y for point in points])
    middle = (y[1:] + y[:-1]) / 2
    return float(np.abs(middle[:, 1] - middle[:, 0] ** 2).max())


def test_it_passes_limit_points_and_stays_on_the_curve() -> None:
    points = followed(0.01)
    for point in points:
        assert point.value == pytest.approx(point.y[0] ** 3 - 3 * point.y[0], abs=1e-8)
        assert np.linalg.norm(point.course) == pytest.approx(1.0)
    rates = np.sign([point.rate for point in points])
    assert list(rates[np.flatnonzero(np.diff(rates, prepend=0))]) == [1, -1, 1]


def test_steps_that_may_bend_less_leave_chords_closer_to_the_curve() -> None:
    coarse, fine = followed(0.04), followed(0.01)
    assert len(fine) > 1.5 * len(coarse)
    assert chord(fine) < chord(coarse) / 2


@pytest.mark.parametrize("find", [Curve.between, Curve.interpolated])
def test_a_limit_point_is_found_between_two_points(find: Callable) -> None:
    curve, points = turning(0.01), followed(0.01)
    pairs = [pair for pair in pairwise(points) if pair[0].rate * pair[1].rate < 0]
    limits = [find(curve, *pair, lambda point: point.rate) for pair in pairs]
    assert [point.value for point in limits] == pytest.approx([2.0, -2.0], abs=1e-3)


def test_it_may_begin_to_the_other_side() -> None:
    back = turning(0.01).begin(np.array([-2.0, 4.0]), -2.0, forward=False)
    assert back.rate < 0 and back.course[0] < 0
