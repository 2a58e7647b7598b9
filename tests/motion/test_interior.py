"""The interior-point method against an independent solver of bounded least squares, and on a curved limit."""

import numpy as np
import pytest
import scipy.optimize

from gbeam.numerics.solvers.interior_point import minimise

RANDOM = np.random.default_rng(7)


class Bounded:
    """½ |R c − r|² with abs(c) <= bound; dense, to be read against the banded one of the plan."""

    def __init__(self, rows: np.ndarray, values: np.ndarray, bound: float) -> None:
        self.rows, self.values, self.bound = rows, values, bound

    def cost(self, c: np.ndarray) -> float:
        return float(np.sum((self.rows @ c[:, 0] - self.values) ** 2)) / 2

    def shares(self, c: np.ndarray) -> np.ndarray:
        return c[:, 0] / self.bound

    def linearise(self, c: np.ndarray) -> None:
        self.slope = self.rows.T @ (self.rows @ c[:, 0] - self.values)

    def step(self, weight: np.ndarray, pull: np.ndarray, damping: float) -> np.ndarray:
        matrix = self.rows.T @ self.rows + np.diag(weight / self.bound**2 + damping)
        return np.linalg.solve(matrix, -self.slope - pull / self.bound)[:, None]

    def change(self, move: np.ndarray) -> np.ndarray:
        return move[:, 0] / self.bound


@pytest.mark.parametrize("bound", [0.05, 0.2, 50.0])
@pytest.mark.parametrize("start", [0.0, 3.0])  # within the tighter bounds and beyond
def test_bounded_least_squares(bound: float, start: float) -> None:
    rows, values = RANDOM.normal(size=(60, 20)), RANDOM.normal(size=60)
    problem = Bounded(rows, values, bound)
    c, cost = minimise(problem, np.full((20, 1), start))
    best = scipy.optimize.lsq_linear(rows, values, (-bound, bound), tol=1e-12)
    assert np.abs(c).max() <= bound
    assert best.cost <= cost * (1 + 1e-9) and cost <= best.cost * (1 + 2e-3)
    assert bound > 1 or np.abs(best.x).max() > 0.999 * bound  # the tighter ones bind


class Hyperbola(Bounded):
    """The same with abs(c0 c1) <= bound, like the power of an arm."""

    def shares(self, c: np.ndarray) -> np.ndarray:
        return c[:1, 0] * c[1:2, 0] / self.bound

    def linearise(self, c: np.ndarray) -> None:
        super().linearise(c)
        self.row = np.array([c[1, 0], c[0, 0]]) / self.bound

    def step(self, weight: np.ndarray, pull: np.ndarray, damping: float) -> np.ndarray:
        matrix = self.rows.T @ self.rows + weight * np.outer(self.row, self.row) + damping * np.eye(2)
        return np.linalg.solve(matrix, -self.slope - pull * self.row)[:, None]

    def change(self, move: np.ndarray) -> np.ndarray:
        return self.row @ move


def test_a_curved_limit() -> None:
    # The point of c0 c1 = 1 nearest to (2, 2) is (1, 1).
    c, cost = minimise(Hyperbola(np.eye(2), np.array([2.0, 2.0]), 1.0), np.array([[2.0], [2.1]]))
    np.testing.assert_allclose(c[:, 0], 1, atol=0.02)  # the cost is flat along the hyperbola
    assert c[0, 0] * c[1, 0] <= 1 and cost == pytest.approx(1, rel=2e-3)
