"""Uniform quintic B-splines: four times continuously differentiable, each piece of six coefficients."""

from __future__ import annotations

from math import comb, factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record
from gbeam.numerics.series import Series

DEGREE = 5
PIECE = DEGREE + 1  # coefficients that one piece depends on

Floats = NDArray[np.float64]


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


@record
class Spline:
    """k quintic splines with uniform knots from `start`, `step` s apart; its last piece goes on beyond the end.

    Parameters
    ----------
    start, step : float
        s.
    coefficients : array, shape (pieces + 5, k)
    """

    start: Any
    step: Any
    coefficients: Any

    def __call__(self, t: Any) -> Any:
        """Values at times `t` (s, any shape), (..., k)."""
        return self.series(t, 0).value

    def series(self, t: Any, order: int) -> Series:
        """Values and time derivatives up to `order` at times `t` (s, any shape), (..., k)."""
        u = (as_array(t) - self.start) / self.step
        xp = namespace(u, self.coefficients)
        coefficients = xp.asarray(self.coefficients)
        piece = xp.clip(xp.floor(u).astype(int), 0, coefficients.shape[0] - PIECE)
        near = coefficients[piece[..., None] + np.arange(PIECE)]
        powers = [xp.ones_like(u)]
        for _ in range(DEGREE):
            powers.append(powers[-1] * (u - piece))
        taylor = []
        for j in range(order + 1):
            rows = [comb(m, j) * powers[m - j] if m >= j else 0.0 * u for m in range(PIECE)]
            weights = (xp.stack(rows, axis=-1) @ _BASIS) / self.step**j
            taylor.append((weights[..., None] * near).sum(axis=-2))
        return Series(tuple(taylor))


class Grid:
    """Knots over a span, and the weights that give a spline and its rates at points within its pieces.

    Parameters
    ----------
    first, last : float
        s.
    step : float
        Largest distance of the knots, s.
    points : array
        Places within every piece, 0 to 1.
    """

    def __init__(self, first: float, last: float, step: float, points: Floats) -> None:
        self.pieces = max(int(np.ceil((last - first) / step)), 1)
        self.start, self.step = first, (last - first) / self.pieces
        self.size = self.pieces + DEGREE
        self.points = points
        self.time = (first + self.step * (np.arange(self.pieces)[:, None] + points)).ravel()
        self.first = np.repeat(np.arange(self.pieces), points.size)  # first coefficient that acts there

    def rows(self, order: int) -> Floats:
        """Weights (points, 6) of the `order`-th time derivative at the points of any piece."""
        k = np.arange(order, PIECE)
        factor = np.array([factorial(int(n)) / factorial(int(n) - order) for n in k])
        return np.asarray((factor * self.points[:, None] ** (k - order)) @ _BASIS[order:] / self.step**order)

    def weights(self, order: int) -> Floats:
        """The same for every time, (times, 6)."""
        return np.tile(self.rows(order), (self.pieces, 1))

    def windows(self, c: Floats) -> Floats:
        """Coefficients (size, k) piece by piece, (pieces, 6·k)."""
        pieces = np.lib.stride_tricks.sliding_window_view(c, PIECE, axis=0)
        return pieces.swapaxes(1, 2).reshape(self.pieces, -1)

    def hull(self, order: int, parts: int) -> Floats:
        """Weights (m, 6) of numbers between which the `order`-th time derivative lies on a piece.

        They are its Bernstein coefficients on each of `parts` equal parts of a piece.
        """
        degree, rows = DEGREE - order, []
        powers = np.array([factorial(k + order) / factorial(k) for k in range(degree + 1)])[:, None] * _BASIS[order:]
        for part in range(parts):
            # Powers of x = (part + u)/parts in powers of u, then in Bernstein polynomials of u.
            shifted = [
                sum(comb(n, j) * part ** (n - j) / parts**n * powers[n] for n in range(j, degree + 1))
                for j in range(degree + 1)
            ]
            rows += [sum(comb(i, j) / comb(degree, j) * shifted[j] for j in range(i + 1)) for i in range(degree + 1)]
        return np.stack(rows) / self.step**order

    def spline(self, coefficients: Floats) -> Spline:
        """The spline of these coefficients."""
        return Spline(np.asarray(self.start), np.asarray(self.step), np.asarray(coefficients))

    def fit(self, values: Floats) -> Floats:
        """Coefficients (n, k) of the least-squares fit to values (times, k)."""
        rows = np.broadcast_to(self.rows(0), (self.pieces, self.points.size, PIECE))
        columns = []
        for column in values.T:
            normal = Normal(self.pieces, 1)
            normal.add(rows, column.reshape(self.pieces, -1))
            columns.append(normal.solve(1e-14))
        return np.stack(columns, axis=1)


class Normal:
    """Normal equations of a linear least-squares problem whose rows each act on six neighbouring coefficients.

    Parameters
    ----------
    pieces : int
        Of the splines.
    functions : int
        How many splines are sought at once; unknowns run through them first.
    """

    def __init__(self, pieces: int, functions: int) -> None:
        self.pieces, self.functions, self.block = pieces, functions, PIECE * functions
        size = (pieces + DEGREE) * functions
        self.band = np.zeros((self.block, size))  # lower form of scipy.linalg.solveh_banded
        self.right = np.zeros(size)

    def add(self, rows: Floats, values: Floats) -> None:
        """Add rows (pieces, m, 6·functions) with right-hand sides (pieces, m)."""
        columns = np.ascontiguousarray(np.moveaxis(rows, -1, 0))
        pairs = zip(*np.triu_indices(self.block), strict=True)
        products = np.stack([np.einsum("pm,pm->p", columns[i], columns[j]) for i, j in pairs])
        self.add_products(products, np.einsum("ipm,pm->ip", columns, values))

    def add_products(self, square: Floats, side: Floats) -> None:
        """Add products of rows already made: the upper half of RᵀR, row by row, (·, pieces), and Rᵀv (·, pieces)."""
        pairs = ((i, j) for i in range(self.block) for j in range(i, self.block))
        for (i, j), product in zip(pairs, square, strict=True):
            self.band[j - i, self._at(i)] += product
        for i in range(self.block):
            self.right[self._at(i)] += side[i]

    def add_row(self, piece: int, row: Floats, value: float) -> None:
        """Add one row (6·functions,) on a piece, counted from the end where negative."""
        first = (piece % self.pieces) * self.functions
        self.right[first : first + self.block] += row * value
        for d in range(self.block):
            self.band[d, first : first + self.block - d] += row[: self.block - d] * row[d:]

    def _at(self, i: int) -> slice:
        """Where the `i`-th coefficient of every piece stands."""
        return slice(i, i + self.functions * (self.pieces - 1) + 1, self.functions)

    def solve(self, damping: float) -> Floats:
        """Solve with `damping` times the largest diagonal entry added to the diagonal."""
        return self.solve_shifted(damping * float(self.band[0].max()))

    def solve_shifted(self, shift: float) -> Floats:
        """Solve with `shift` added to the diagonal."""
        import scipy.linalg  # only those who solve need it

        band = self.band.copy()
        band[0] += shift
        return np.asarray(scipy.linalg.solveh_banded(band, self.right, lower=True, check_finite=False))
