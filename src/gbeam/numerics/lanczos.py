"""Lowest modes of a large structure, by Lanczos' iteration with blocks: solving for many right-hand sides costs little
more than for one, and a block finds as many equal frequencies as it has columns.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gbeam.numerics.eigen import Floats

CLOSE = 1e-8  # of an inverse eigenvalue: residual of a mode that has converged; its value errs by the square
NONE = 1e-12  # of its length: what is left of a vector that is in the space already
SAME = 1e-13  # of the largest eigenvalue of the products of unit vectors: two that are one


def lowest_modes(solve: Callable[[Floats], Floats], mass: Any, start: Floats, modes: int) -> tuple[Floats, Floats]:
    """Inverse eigenvalues (m,), the largest in size first, and vectors (n, m) of unit modal mass; fewer than `modes`
    where no more motions move mass.

    `solve` applies the inverse of the stiffness, and `start` (n, b) begins the space. All of its vectors are kept
    orthogonal (Golub and Underwood 1977, The block Lanczos method for computing eigenvalues).
    """
    basis: list[Floats] = []
    flexibility, value = np.zeros((0, 0)), np.zeros(0)
    vector, residual = flexibility, value
    new = _beside(start, basis, mass)
    while new.shape[1] and not (len(value) == modes and (residual < CLOSE * np.abs(value)).all()):
        basis.append(new)
        step = solve(mass @ new)
        across = _products(basis, mass @ step)
        flexibility = np.block([[flexibility, across[: len(flexibility)]], [across.T]])
        new = _beside(step, basis, mass)
        value, vector = np.linalg.eigh(flexibility)
        lowest = np.argsort(-np.abs(value), kind="stable")[:modes]
        value, vector = value[lowest], vector[:, lowest]
        residual = np.linalg.norm(new.T @ (mass @ step) @ vector[-step.shape[1] :], axis=0)
    # Once more by the stiffness: without what has no mass, of which products with the mass do not know.
    return value, solve(mass @ _combined(basis, vector)) / value if basis else vector


def _beside(vectors: Floats, basis: list[Floats], mass: Any) -> Floats:
    """Span of what vectors (n, b) have beside a basis, orthonormal in the mass, (n, l)."""
    whole = np.sqrt(np.maximum(np.einsum("ij,ij->j", vectors, mass @ vectors), 0.0))
    for _ in range(3):  # twice is enough, and once more for what was small
        if basis:
            vectors = vectors - _combined(basis, _products(basis, mass @ vectors))
        products = vectors.T @ (mass @ vectors)
        size = np.sqrt(np.maximum(np.diagonal(products), 0.0))
        some = size > NONE * whole
        size, products = size[some], products[np.ix_(some, some)]
        value, vector = np.linalg.eigh(products / np.outer(size, size))
        kept = value > SAME * value.max(initial=0.0)
        vectors = vectors[:, some] / size @ (vector[:, kept] / np.sqrt(value[kept]))
        whole = np.zeros(vectors.shape[1])
    return vectors


def _products(basis: list[Floats], weighed: Floats) -> Floats:
    return np.concatenate([each.T @ weighed for each in basis])


def _combined(basis: list[Floats], factors: Floats) -> Floats:
    """Sum of the basis with such factors, of which no copy is made: it is large."""
    total = np.zeros((len(basis[0]), factors.shape[1]))
    first = 0
    for each in basis:
        total += each @ factors[first : first + each.shape[1]]
        first += each.shape[1]
    return total
