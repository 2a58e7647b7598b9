"""The symmetric eigenproblem, and small oscillations about an equilibrium."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

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


Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

ZERO = 1e-11  # of the largest eigenvalue: a smaller one is rounding about zero
# Of a mode's frequency: a base that speeds up, once frozen, feeds or drains a mode by 1e-7, and means nothing by it.
FLUTTER = 1e-6
UNSYMMETRIC = 1e-9  # of K: above it the loads follow the beam


def growth_limit(value: Complex, largest: float) -> Floats:
    """Real part above which each of some eigenvalues counts as one that grows, 1/s; `largest` is that of all."""
    return np.maximum(np.where(value.imag != 0, FLUTTER * np.abs(value), 0.0), ZERO * largest)


def eigenvalues(
    mass: Floats, velocity: Floats, stiffness: Floats, *, gyroscopic: bool = True
) -> tuple[Complex, Complex]:
    """Eigenvalues λ and modes of M ÿ + C ẏ + K y = 0.

    `mass`, `velocity`, `stiffness` (n, n).
    """
    damping = velocity if gyroscopic else (velocity + velocity.T) / 2
    # In modes of the symmetric part, each scaled by its own frequency, all blocks are of the size of the frequencies:
    # the raw companion matrix loses half the digits of the low ones.
    square, basis = symmetric_modes(symmetric(stiffness), symmetric(mass))
    reference = np.sqrt(np.abs(square).max())
    scale = np.maximum(np.sqrt(np.abs(square)), 1e-6 * reference)
    k, c = basis.T @ stiffness @ basis, basis.T @ damping @ basis
    n = len(square)
    moving = np.abs(k).max(axis=0) > 1e-13 * reference**2
    a = np.block([[np.zeros((n, n)), np.diag(scale)], [-k / scale, -c]])
    keep = np.concatenate([moving, np.ones(n, dtype=bool)])
    value, vector = np.linalg.eig(a[np.ix_(keep, keep)])
    # The velocities hold a mode also where its coordinate was dropped.
    mode = basis @ vector[-n:]
    weight = np.sqrt(np.einsum("ik,ij,jk->k", mode.conj(), mass, mode).real)
    return value, mode / weight


def unsymmetric(stiffness: Floats) -> bool:
    """Whether a stiffness (n, n) is that of loads that follow the beam, and feed it or take from it."""
    return bool(np.abs(stiffness - stiffness.T).max() > UNSYMMETRIC * np.abs(stiffness).max())


def stability_margin(mass: Floats, velocity: Floats, stiffness: Floats) -> float:
    """Positive while nothing grows, rad²/s²: by K's lowest eigenvalue, or, where K is unsymmetric, by all of them."""
    if not unsymmetric(stiffness):
        return float(symmetric_modes(symmetric(stiffness), symmetric(mass))[0][0])
    value, _ = eigenvalues(mass, velocity, stiffness)
    return float((growth_limit(value, np.abs(value).max()) - value.real).min())


def matched(alike: Floats) -> tuple[NDArray[np.intp], Floats]:
    """For each row of MACs (k, l) the column that it resembles most, each of them once, −1 for none; and their MAC."""
    rows, columns = np.arange(len(alike)), alike.argmax(axis=1)
    if len(set(columns)) < len(columns):  # two want the same one
        from scipy.optimize import linear_sum_assignment

        rows, columns = linear_sum_assignment(-alike)
    match, value = np.full(len(alike), -1), np.full(len(alike), np.nan)
    match[rows], value[rows] = columns, alike[rows, columns]
    return match, value


def growth_rate(mass: Floats, velocity: Floats, stiffness: Floats) -> float:
    """Real part of the eigenvalue that grows fastest, 1/s; zero where none grows."""
    value, _ = eigenvalues(mass, velocity, stiffness)
    return float(value.real.max(where=value.real > growth_limit(value, np.abs(value).max()), initial=0.0))


def mac(first: Complex, second: Complex, mass: Floats) -> Floats:
    """Modal assurance criteria |φᴴMψ|²/(φᴴMφ ψᴴMψ) of modes in rows, (k, l)."""
    left, right = (np.einsum("ki,ij,kj->k", x.conj(), mass, x).real for x in (first, second))
    return np.abs(first.conj() @ mass @ second.T) ** 2 / np.outer(left, right)
