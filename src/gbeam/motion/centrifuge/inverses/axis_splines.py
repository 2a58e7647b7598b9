"""The axes of a plan as splines of which only those are allowed that begin and end in a steady state."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from gbeam.numerics.bspline import DEGREE, PIECE, Grid

AXES = 3
NEAR = AXES * PIECE  # coefficients that act on one piece
RATE, YAW, ROLL = range(AXES)  # of these quantities the splines are: ω1 rad/s, θ2 rad, θ3 rad

Floats = NDArray[np.float64]


class AxisSplines:
    """ω1, θ2 and θ3 as splines on one grid.

    The first five coefficients of each are one number, and so are the last five: values are what they are, and their
    first four derivatives are zero. The unknowns x are those numbers and all the others between, axis after axis at
    each place, so that everything that depends on a few neighbours is banded.

    Parameters
    ----------
    grid : Grid
    standstill : bool
        Whether the arm begins and ends at rest; else it turns at a rate that is an unknown.
    """

    def __init__(self, grid: Grid, standstill: bool) -> None:
        self.grid = grid
        place = np.clip(np.arange(grid.size), DEGREE - 1, grid.size - DEGREE) - (DEGREE - 1)
        number = np.arange(AXES * (place[-1] + 1)).reshape(-1, AXES)
        if standstill:
            number = np.arange(-1, AXES * (place[-1] + 1) - 1).reshape(-1, AXES)
            number[-1] -= 1
            number[-1, RATE] = -1
        self.number = number[place]  # of the unknown that each coefficient is, (grid.size, 3); -1: it is zero
        self.size = int(self.number.max()) + 1
        first, last = np.clip(np.arange(self.size) + np.array([[1 - NEAR], [NEAR]]), 0, self.size)
        starts = np.append(0, np.cumsum(last - first))  # of the columns of a matrix on x
        rows = np.arange(starts[-1]) - np.repeat(starts[:-1] - first, last - first)
        self._banded = rows, starts
        every = np.append(self.number.ravel(), np.full(NEAR, -1))
        ends = np.lib.stride_tricks.sliding_window_view(every, NEAR)[:-1].T, every[:-NEAR]
        used = (ends[0] >= 0) & (ends[1] >= 0)
        self._places = [np.where(used, starts[c] + r - first[c], starts[-1]).ravel() for r, c in (ends, ends[::-1])]

    def on_unknowns(self, rows: Any, axis: int) -> Any:
        """Rows (m, grid.size) that act on the coefficients of one axis as rows (m, size) that act on x."""
        number = self.number[:, axis]
        used = np.flatnonzero(number >= 0)
        chosen = (np.ones(used.size), (used, number[used]))
        return rows @ scipy.sparse.csr_array(chosen, shape=(self.grid.size, self.size))

    def derivative(self, axis: int, order: int) -> Any:
        """Rows (times, size) that give a time derivative of one axis's quantity at the grid's times."""
        return self.on_unknowns(self.grid.matrix(order), axis)

    def coefficients(self, x: Floats) -> Floats:
        """Coefficients (grid.size, 3) of the splines."""
        return np.asarray(np.append(x, 0.0)[self.number])

    def unknowns(self, coefficients: Floats) -> Floats:
        """The unknowns x of coefficients (grid.size, 3); those of the outermost knots count at the ends."""
        x = np.zeros(self.size + 1)
        half = self.grid.size // 2
        x[self.number[half - 1 :: -1]] = coefficients[half - 1 :: -1]
        x[self.number[half:]] = coefficients[half:]
        return x[:-1]

    def assembled(self, pieces: Floats) -> Any:
        """A symmetric matrix on x, sparse (size, size), as a sum of matrices that act on a piece's coefficients each.

        `pieces` (171, pieces).
        """
        band = np.zeros((NEAR, AXES * self.grid.size))  # row d couples every coefficient with the d-th after it
        for i, j, values in zip(*np.tril_indices(NEAR), pieces, strict=True):
            band[i - j, j : j + AXES * self.grid.pieces : AXES] += values
        rows, starts = self._banded
        data = np.bincount(self._places[0], band.ravel(), starts[-1] + 1)
        band[0] = 0.0  # the diagonal is its own mirror image
        data += np.bincount(self._places[1], band.ravel(), starts[-1] + 1)
        return scipy.sparse.csc_array((data[:-1], rows, starts), shape=(self.size, self.size))
