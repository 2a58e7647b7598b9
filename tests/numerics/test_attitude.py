"""Attitude from body rates: constant turns are exact, a coning motion converges with the square of the interval."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gbeam.numerics import attitude


def matrices(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    return Rotation.from_quat(quaternions, scalar_first=True).as_matrix()


def test_a_constant_rate_turns_about_its_axis() -> None:
    time, rate = np.sort(np.random.default_rng(1).uniform(2, 30, 777)), np.array([0.3, -1.1, 0.7])
    built = attitude(time, np.tile(rate, (777, 1)))
    expected = Rotation.from_rotvec(rate * (time - time[0])[:, None]).as_matrix()
    np.testing.assert_allclose(matrices(built), expected, atol=1e-12)
    assert built[0].tolist() == [1, 0, 0, 0] and np.abs(np.linalg.norm(built, axis=1) - 1).max() < 1e-14
    assert np.abs(np.diff(built, axis=0)).max() < 0.5  # no jump of sign: what is drawn lies between neighbours


def test_coning_converges_with_the_square_of_the_interval() -> None:
    # R = Rz(a t) Rx(c) Rz(b t): by Euler's angles the body rates are those below.
    a, b, c = 2.0, -3.1, 0.4

    def error(count: int) -> float:
        t = np.linspace(0, 5, count)
        rates = np.stack(
            [a * np.sin(c) * np.sin(b * t), a * np.sin(c) * np.cos(b * t), a * np.cos(c) + b + 0 * t], axis=1
        )
        exact = Rotation.from_euler("ZXZ", np.stack([a * t, c + 0 * t, b * t], axis=1))
        expected = (exact[0].inv() * exact).as_matrix()
        return float(np.abs(matrices(attitude(t, rates)) - expected).max())

    errors = [error(count) for count in (201, 401, 801)]
    assert errors[2] < 1e-4
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.05)


def test_one_time_is_no_turn() -> None:
    assert attitude(np.array([3.0]), np.ones((1, 3))).tolist() == [[1, 0, 0, 0]]
