"""The axes of a plan as splines of which only those are allowed that begin and end in a steady state."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from gbeam.numerics.bspline import DEGREE, Grid

AXES = 3
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
