"""Lowest modes by block Lanczos beside those of dense matrices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh

from gbeam.numerics import lowest_modes


def matrices(copies: int, massless: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of equal chains apart from each other, whose frequencies stand `copies` times in the list."""
    rng = np.random.default_rng(5)
    n = 40
    chain = np.diag(2.0 + rng.random(n)) - np.diag(np.ones(n - 1), 1) - np.diag(np.ones(n - 1), -1)
    mass = 1 + rng.random(n)
    mass[:massless] = 0.0
    return block_diag(*[1e6 * chain] * copies), block_diag(*[np.diag(mass)] * copies)


@pytest.mark.parametrize(("copies", "massless"), [(1, 0), (5, 0), (2, 3)])
def test_modes_are_those_of_dense_matrices(copies: int, massless: int) -> None:
    """Also five equal ones, of which a space begun with one vector knows one, and unknowns without mass."""
    stiffness, mass = matrices(copies, massless)
    start = np.random.default_rng(0).standard_normal((len(mass), 6))
    inverse, vectors = lowest_modes(lambda b: np.linalg.solve(stiffness, b), mass, start, 10)
    expected = eigh(mass, stiffness, eigvals_only=True)[::-1][:10]
    np.testing.assert_allclose(inverse, expected, rtol=1e-13)
    np.testing.assert_allclose(vectors.T @ mass @ vectors, np.eye(10), atol=1e-8)
    np.testing.assert_allclose(stiffness @ vectors * inverse, mass @ vectors, atol=1e-8)


def test_a_space_that_ends_early_gives_what_there_is() -> None:
    stiffness, mass = matrices(1, massless=37)
    start = np.random.default_rng(0).standard_normal((len(mass), 2))
    inverse, _ = lowest_modes(lambda b: np.linalg.solve(stiffness, b), mass, start, 5)
    np.testing.assert_allclose(inverse, eigh(mass, stiffness, eigvals_only=True)[::-1][:3], rtol=1e-12)
