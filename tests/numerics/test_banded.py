"""Banded systems by cyclic reduction, against SciPy's Cholesky."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from gbeam.numerics.solvers.banded import solve_banded


@pytest.mark.parametrize(("n", "width"), [(2, 1), (7, 3), (8, 2), (50, 3), (1001, 6)])
def test_against_cholesky(n: int, width: int) -> None:
    random = np.random.default_rng(n)
    band, right = random.normal(size=(width + 1, n)), random.normal(size=(n, 2))
    band[0] = 2 * width + np.abs(band[0])
    expected = scipy.linalg.solveh_banded(band, right, lower=True)
    np.testing.assert_allclose(solve_banded(band, right), expected, atol=1e-13)


def test_fewer_rows_than_diagonals() -> None:
    np.testing.assert_allclose(
        solve_banded(np.array([[4.0, 4.0], [1.0, 9.0], [9.0, 9.0]]), np.array([[5.0], [5.0]])), 1
    )
