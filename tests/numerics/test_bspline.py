"""Quintic splines: what they reproduce, what their hulls hold, the same spline on finer knots."""

import numpy as np
import pytest

from gbeam.numerics import Grid

RANDOM = np.random.default_rng(1)


def test_spline_reproduces_quintics_and_their_derivatives() -> None:
    grid = Grid(1.0, 3.0, 0.11, np.array([0.1, 0.5, 0.8]))
    polynomial = np.polynomial.Polynomial([1, -2, 0.5, 3, -1, 0.2])
    c = grid.fit(polynomial(grid.time)[:, None])
    for order in range(4):
        values = grid.matrix(order) @ c[:, 0]
        np.testing.assert_allclose(
            values, (polynomial.deriv(order) if order else polynomial)(grid.time), rtol=10.0 ** (order - 7)
        )
    t = np.array([1.0, 1.7, 3.0])
    np.testing.assert_allclose(grid.spline(c)(t)[:, 0], polynomial(t), rtol=1e-8)


@pytest.mark.parametrize("order", range(4))
def test_a_hull_holds_the_derivative_and_meets_it_at_the_ends_of_a_piece(order: int) -> None:
    grid = Grid(0.0, 2.0, 0.1, np.linspace(0, 1, 50))
    c = RANDOM.normal(size=grid.size)
    values = (grid.matrix(order) @ c).reshape(grid.pieces, -1)
    hull = (grid.hull(order) @ c).reshape(grid.pieces, -1)
    size = np.abs(values).max()
    assert (hull.min(axis=1) <= values.min(axis=1) + 1e-12 * size).all()
    assert (hull.max(axis=1) >= values.max(axis=1) - 1e-12 * size).all()
    np.testing.assert_allclose(hull[:, [0, -1]], values[:, [0, -1]], atol=1e-10 * size)


def test_the_hull_of_a_sum_of_derivatives_is_the_sum_of_their_hulls() -> None:
    grid = Grid(0.0, 1.0, 0.25, np.linspace(0, 1, 50))
    c = RANDOM.normal(size=grid.size)
    values = ((3 * grid.matrix(0) - 0.2 * grid.matrix(1)) @ c).reshape(grid.pieces, -1)
    hull = ((3 * grid.hull(0) - 0.2 * grid.hull(1)) @ c).reshape(grid.pieces, -1)
    assert (hull.min(axis=1) <= values.min(axis=1)).all() and (hull.max(axis=1) >= values.max(axis=1)).all()


def test_on_finer_knots_the_spline_is_the_same() -> None:
    grid = Grid(-1.3, 2.0, 0.3, np.array([0.5]))
    c = RANDOM.normal(size=(grid.size, 2))
    finer, halved = grid.refined(c), grid.halved()
    assert halved.pieces == 2 * grid.pieces and finer.shape == (halved.size, 2)
    t = np.linspace(-1.3, 2.0, 200)
    np.testing.assert_allclose(halved.spline(finer)(t), grid.spline(c)(t), atol=1e-13)
    assert finer.min() >= c.min() and finer.max() <= c.max()
