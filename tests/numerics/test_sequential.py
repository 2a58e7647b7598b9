"""Quadratic programs against an independent solver of bounded least squares; their sequence on curved limits."""

from typing import Any

import numpy as np
import pytest
import scipy.optimize
import scipy.sparse

from gbeam.numerics import minimise, nearest_point, solve_quadratic

RANDOM = np.random.default_rng(7)


@pytest.mark.parametrize("bound", [0.05, 0.2, 50.0])
def test_bounded_least_squares(bound: float) -> None:
    rows, values = RANDOM.normal(size=(60, 20)), RANDOM.normal(size=60)
    # The limits from above, then those from below, in another order and from one side only.
    limits = scipy.sparse.csr_array(np.concatenate([np.eye(20), -np.eye(20)[::-1]]))
    lower, upper = np.full(40, -np.inf), np.full(40, bound)
    lower[:10] = -bound
    x = solve_quadratic(scipy.sparse.csr_array(rows.T @ rows), -rows.T @ values, limits, lower, upper)
    best = scipy.optimize.lsq_linear(rows, values, (-bound, bound), tol=1e-12)
    assert x is not None and np.abs(x).max() <= bound * (1 + 1e-6)
    np.testing.assert_allclose(x, best.x, atol=1e-5 * bound)
    assert bound > 1 or np.abs(best.x).max() > 0.999 * bound  # the tighter ones bind


def test_where_limits_contradict_there_is_no_solution() -> None:
    rows = scipy.sparse.csr_array([[1.0, 0.0], [1.0, 0.0]])
    nothing = solve_quadratic(scipy.sparse.eye_array(2), np.zeros(2), rows, np.array([-1.0, 2.0]), np.array([1.0, 3.0]))
    assert nothing is None


class Rosenbrock:
    """½ ((1 − x)² + 100 (y − x²)²), with the products of its first derivatives for second ones."""

    bound = 0.0

    def cost(self, x: np.ndarray) -> float:
        return float((1 - x[0]) ** 2 + 100 * (x[1] - x[0] ** 2) ** 2) / 2

    def model(self, x: np.ndarray) -> tuple[Any, np.ndarray]:
        slope = np.array([[-1.0, 0.0], [-20 * x[0], 10.0]])
        return scipy.sparse.csr_array(slope.T @ slope), slope.T @ np.array([1 - x[0], 10 * (x[1] - x[0] ** 2)])


class Hyperbola:
    """x y <= 1 of positive numbers by its tangents, y <= (2 − x/a)/a, like the power of an arm."""

    def linearise(self, x: np.ndarray) -> tuple[Any, np.ndarray, np.ndarray]:
        rows = scipy.sparse.csr_array([[1 / x[0], x[0]], [1.0, 0.0]])
        return rows, np.array([-np.inf, 0.1]), np.array([2.0, 10.0])


class Halfplane:
    def linearise(self, x: np.ndarray) -> tuple[Any, np.ndarray, np.ndarray]:
        return scipy.sparse.csr_array([[1.0, 1.0]]), np.array([-np.inf]), np.array([1.0])


def test_a_curved_cost_within_a_limit() -> None:
    cost = Rosenbrock()
    x, value = minimise(cost, Halfplane(), np.array([-1.2, 1.0]))
    best = scipy.optimize.minimize_scalar(lambda u: cost.cost(np.array([u, 1 - u])), bounds=(0, 1), method="bounded")
    assert x.sum() == pytest.approx(1, abs=1e-6) and value == pytest.approx(best.fun, rel=1e-3) == cost.cost(x)


def test_a_curved_limit_is_kept_by_every_step() -> None:
    class Distance:
        bound = 0.0

        def cost(self, x: np.ndarray) -> float:
            assert x[0] * x[1] <= 1 + 1e-6
            return float(np.sum((x - 1.5) ** 2)) / 2

        def model(self, x: np.ndarray) -> tuple[Any, np.ndarray]:
            return scipy.sparse.eye_array(2), x - 1.5

    # The point of x y = 1 nearest to (1.5, 1.5) is (1, 1).
    x, value = minimise(Distance(), Hyperbola(), np.array([3.0, 0.2]))
    np.testing.assert_allclose(x, 1, atol=0.02)
    assert value == pytest.approx(0.25, rel=1e-3)


def test_the_nearest_point_within_limits_is_the_foot_of_the_perpendicular() -> None:
    x = nearest_point(Halfplane(), np.array([2.0, 1.0]))
    np.testing.assert_allclose(x, [1.0, 0.0], atol=1e-6)
