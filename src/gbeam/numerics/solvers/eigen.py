"""The symmetric eigenproblem K φ = ω² M φ, and whether it has negative eigenvalues."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace

Array = Any


def symmetric_modes(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    """Eigenvalues (n,), ascending, and eigenvectors (n, n) in columns, of unit length in M."""
    xp = namespace(stiffness, mass)
    scale = xp.linalg.inv(xp.linalg.cholesky(mass))
    value, vector = xp.linalg.eigh(scale @ stiffness @ scale.T)
    return value, scale.T @ vector


def positive_definite(matrices: Array) -> bool:
    """Whether the symmetric parts of all matrices (..., n, n) are, by factors: a tenth of what eigenvalues cost."""
    try:
        np.linalg.cholesky(matrices + np.swapaxes(matrices, -1, -2))
    except np.linalg.LinAlgError:
        return False
    return True


def symmetric(matrices: Array) -> Array:
    """The symmetric parts of matrices (..., n, n)."""
    return (matrices + namespace(matrices).swapaxes(matrices, -1, -2)) / 2
