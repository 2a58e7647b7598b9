"""Uniform quintic B-splines: four times continuously differentiable, each piece of six coefficients."""

from __future__ import annotations

from math import comb, factorial
from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record
from gbeam.arrays.types import Floats
from gbeam.numerics.series import Series

DEGREE = 5
PIECE = DEGREE + 1  # coefficients that one piece depends on


def _matrix() -> Floats:
    """Row k: coefficient of xᵏ in each of the six basis functions over one piece, 0 <= x < 1.

    From B(u) = Σ_j (−1)^j C(6, j) (u − j)₊⁵ / 5!, basis i being B(x + 5 − i).
    """
    matrix = np.zeros((PIECE, PIECE))
    for i in range(PIECE):
        for j in range(PIECE - i):
            for k in range(PIECE):
                offset = DEGREE - i - j
                matrix[k, i] += (-1) ** j * comb(PIECE, j) * comb(DEGREE, k) * offset ** (DEGREE - k)
    return matrix / factorial(DEGREE)


_BASIS = _matrix()
_INTEGRALS = _BASIS.T @ (1 / np.arange(1, PIECE + 1))  # integrals of the six basis functions over one piece
# [k, j]: weights of xᵏ in the j-th Taylor coefficient at x, for each of the six basis functions.
_TAYLOR = np.array(
    [[comb(k + j, j) * _BASIS[k + j] if k + j < PIECE else np.zeros(PIECE) for j in range(PIECE)] for k in range(PIECE)]
)
# Row i: the i-th coefficient in Bernstein's polynomials of the fifth degree, from those of the powers of x.
_BERNSTEIN = np.array([[comb(i, k) / comb(DEGREE, k) for k in range(PIECE)] for i in range(PIECE)])
_HALVED = np.array([comb(PIECE, j) for j in range(PIECE + 1)]) / 2**DEGREE  # B(u) in those of half the width
_ROUNDING = 1e-9  # of a piece


@record
class Spline:
    """k quintic splines, uniform knots from `start`, `step` s apart. The last piece goes on beyond the end."""

    start: Any
    step: Any
    coefficients: Any  # (pieces + 5, k)

    def __call__(self, t: Any) -> Any:
        """Values at times `t` (s, any shape), (..., k)."""
        return self.series(t, 0).value

    def series(self, t: Any, order: int) -> Series:
        """Values and time derivatives up to `order` at times `t` (s, any shape), (..., k)."""
        xp, piece, powers = self._locate(t)
        # One product for all times and orders, then one for each time.
        flat = _TAYLOR[:, : order + 1].reshape(PIECE, -1)
        weights = xp.reshape(xp.stack(powers, axis=-1) @ flat, (*piece.shape, order + 1, PIECE))
        taylor = weights @ self._local_coefficients(piece)
        return Series(tuple(taylor[..., j, :] / self.step**j for j in range(order + 1)))

    def integral(self, t: Any) -> Any:
        """Integrals from the start to times `t` (s, any shape), (..., k)."""
        xp, piece, powers = self._locate(t)
        weights = xp.stack([power * powers[1] / (k + 1) for k, power in enumerate(powers)], axis=-1) @ _BASIS
        piece_integrals = xp.einsum(
            "i,pik->pk", _INTEGRALS, self._local_coefficients(np.arange(len(self.coefficients) - DEGREE))
        )
        integral_before = xp.cumsum(piece_integrals, axis=0) - piece_integrals
        return self.step * (
            integral_before[piece] + (weights[..., None, :] @ self._local_coefficients(piece))[..., 0, :]
        )

    def _locate(self, t: Any) -> tuple[Any, Any, list[Any]]:
        """Namespace, the pieces (...) where times lie, and powers 0 to 5 of the place in the piece, from 0 to 1."""
        u = (as_array(t) - self.start) / self.step
        xp = namespace(u, self.coefficients)
        piece = xp.clip(xp.floor(u).astype(int), 0, len(self.coefficients) - PIECE)
        powers = [xp.ones_like(u)]
        for _ in range(DEGREE):
            powers.append(powers[-1] * (u - piece))
        return xp, piece, powers

    def _local_coefficients(self, piece: Any) -> Any:
        """Coefficients (..., 6, k) on which pieces depend."""
        return namespace(self.coefficients, piece).asarray(self.coefficients)[piece[..., None] + np.arange(PIECE)]


class Grid:
    """Knots over a span, s, and the weights that give a spline and its rates at points, 0 to 1, within its pieces."""

    def __init__(self, first: float, last: float, step: float, points: Floats) -> None:
        self.pieces = max(int(np.ceil((last - first) / step - _ROUNDING)), 1)
        self.start, self.end, self.step = first, last, (last - first) / self.pieces
        self.size = self.pieces + DEGREE
        self.points = points
        self.time = (first + self.step * (np.arange(self.pieces)[:, None] + points)).ravel()

    def rows(self, order: int) -> Floats:
        """Weights (points, 6) of the `order`-th time derivative at the points of any piece."""
        return np.asarray(self.points[:, None] ** np.arange(PIECE) @ self._powers(order))

    def matrix(self, order: int) -> Any:
        """Basis at every time, a sparse matrix (times, size)."""
        return self._repeat_rows(self.rows(order))

    def hull(self, order: int) -> Any:
        """Weights of six numbers a piece between which the derivative lies there, sparse (6 · pieces, size).

        They are its Bernstein coefficients of the fifth degree, whatever the order: a sum of derivatives lies between
        the sums of them.
        """
        return self._repeat_rows(_BERNSTEIN @ self._powers(order))

    def _powers(self, order: int) -> Floats:
        """Row k: coefficient of xᵏ in the derivative over one piece of each of the six basis functions there."""
        powers = np.zeros((PIECE, PIECE))
        for k in range(PIECE - order):
            powers[k] = factorial(k + order) / factorial(k) * _BASIS[k + order] / self.step**order
        return powers

    def _repeat_rows(self, rows: Floats) -> Any:
        """Repeat rows (m, 6) on every piece, sparse (m · pieces, size)."""
        import scipy.sparse

        count = len(rows) * self.pieces
        columns = np.repeat(np.arange(self.pieces), len(rows))[:, None] + np.arange(PIECE)
        parts = np.tile(rows.ravel(), self.pieces), columns.ravel(), PIECE * np.arange(count + 1)
        return scipy.sparse.csr_array(parts, shape=(count, self.size))

    def spline(self, coefficients: Floats) -> Spline:
        """The spline of these coefficients."""
        return Spline(np.asarray(self.start), np.asarray(self.step), np.asarray(coefficients))

    def fit(self, values: Floats) -> Floats:
        """Coefficients (n, k) of the least-squares fit to values (times, k)."""
        rows = np.broadcast_to(self.rows(0), (self.pieces, self.points.size, PIECE))
        columns = []
        for column in values.T:
            normal = Normal(self.pieces)
            normal.add(rows, column.reshape(self.pieces, -1))
            columns.append(normal.solve(1e-14))
        return np.stack(columns, axis=1)

    def halved(self) -> Grid:
        """The grid with a knot in the middle of every piece."""
        return Grid(self.start, self.end, self.step / 2, self.points)

    def refined(self, coefficients: Floats) -> Floats:
        """Coefficients (halved().size, k) of the same splines (size, k) on the halved grid: means of the old ones."""
        spread = np.zeros((2 * self.size + 1, coefficients.shape[1]))
        spread[1::2] = coefficients
        windows = np.lib.stride_tricks.sliding_window_view(spread, PIECE + 1, axis=0)
        return np.asarray(windows @ _HALVED)


class Normal:
    """Normal equations of a linear least-squares problem whose rows each act on six neighbouring coefficients."""

    def __init__(self, pieces: int) -> None:
        self.pieces = pieces
        self.band = np.zeros((PIECE, pieces + DEGREE))  # lower form of scipy.linalg.solveh_banded
        self.right = np.zeros(pieces + DEGREE)

    def add(self, rows: Floats, values: Floats) -> None:
        """Add rows (pieces, m, 6) with right-hand sides (pieces, m)."""
        for i in range(PIECE):
            self.right[i : i + self.pieces] += np.einsum("pm,pm->p", rows[:, :, i], values)
            for j in range(i, PIECE):
                self.band[j - i, i : i + self.pieces] += np.einsum("pm,pm->p", rows[:, :, i], rows[:, :, j])

    def add_row(self, piece: int, row: Floats, value: float) -> None:
        """Add one row (6,) on a piece, counted from the end where negative."""
        first = piece % self.pieces
        self.right[first : first + PIECE] += row * value
        for d in range(PIECE):
            self.band[d, first : first + PIECE - d] += row[: PIECE - d] * row[d:]

    def solve(self, damping: float) -> Floats:
        """Solve with `damping` times the largest diagonal entry added to the diagonal."""
        import scipy.linalg  # only those who solve need it

        band = self.band.copy()
        band[0] += damping * float(band[0].max())
        return np.asarray(scipy.linalg.solveh_banded(band, self.right, lower=True, check_finite=False))
