"""What a plan keeps at all times: limits of the axes, the arm's power, idle; linear in the unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from gbeam.motion.centrifuge.inverses.axis_splines import AXES, RATE, AxisSplines
from gbeam.motion.centrifuge.inverses.closed_form import Geometry
from gbeam.motion.centrifuge.machine.limits import QUANTITIES, Limits
from gbeam.motion.centrifuge.target.target import Target
from gbeam.numerics.bspline import DEGREE, PIECE, Grid

_USED = 1 - 1e-5  # of a limit: a solution may exceed what it is given by its tolerance
_SLOW = 0.1  # of the largest rate: slower ones have its tangent

Floats = NDArray[np.float64]


def idle_rate(target: Target, geometry: Geometry) -> float:
    """Rate of axis 1 at which the arm alone makes the idle load, rad/s; zero where there is no idle."""
    horizontal2 = max(float(target.idle) ** 2 - float(geometry.gravity) ** 2, 0.0)
    return float((horizontal2 / float(geometry.arm) ** 2) ** 0.25)


class KeptLimits:
    """Rows of the unknowns with lower and upper limits.

    A derivative of a spline lies between its coefficients, which are differences of the spline's own over the step: the
    limits of these are kept between the knots too. The arm's power J ω1 |dω1/dt| <= P is not linear; its tangent at a
    rate Ω, |dω1/dt| <= (P/J) (2 − ω1/Ω)/Ω, is within it at every other rate, because P/(J ω1) is convex. With one Ω for
    a piece it holds on all of the piece where it holds for the hull.
    """

    def __init__(self, splines: AxisSplines, geometry: Geometry, limits: Limits, target: Target) -> None:
        grid, allowed = splines.grid, np.asarray(limits.axes)
        self.idle = idle_rate(target, geometry)
        rows, lower, upper = [], [], []
        coefficients = scipy.sparse.eye_array(grid.size, format="csr")
        for axis in range(AXES):
            for quantity in range(len(QUANTITIES)):
                order = quantity + (axis != RATE)  # the spline of axis 1 is that of its rate
                limit = allowed[quantity, axis]
                if order == 0:
                    rows.append(splines.on_unknowns(coefficients, axis))
                    lower.append(self._least(grid, target))
                    upper.append(np.full(grid.size, limit * _USED))
                elif limit < np.inf:
                    rows.append(splines.on_unknowns(_differences(grid, order), axis) / limit)
                    upper.append(np.full(grid.size - order, _USED))
                    lower.append(-upper[-1])
        matrix = scipy.sparse.vstack(rows, format="csr")
        used = np.diff(matrix.indptr) > 0  # at standstill there is nothing to limit
        self.rows, self.lower, self.upper = matrix[used], np.concatenate(lower)[used], np.concatenate(upper)[used]
        self.power = _USED * float(limits.power / limits.inertia) if np.isfinite(limits.power) else np.inf
        if self.power < np.inf:
            self.rate, self.acceleration = (splines.on_unknowns(grid.hull(order), RATE) for order in (0, 1))

    def _least(self, grid: Grid, target: Target) -> Floats:
        """Least coefficients of ω1: those that act during the flight are at idle, and the arm never turns back."""
        first, last = ((float(end) - grid.start) / grid.step for end in target.span)
        least = np.zeros(grid.size)
        begin, end = max(int(np.floor(first)), 0), min(int(np.ceil(last)), grid.pieces)
        least[begin : end + DEGREE] = self.idle / _USED
        return least

    def at(self, x: Floats) -> tuple[Any, Floats, Floats]:
        """Rows, lower and upper limits; those of the power as its tangents at x."""
        if self.power == np.inf:
            return self.rows, self.lower, self.upper
        rate = np.repeat(np.max((self.rate @ x).reshape(-1, PIECE), axis=1), PIECE)
        rate = np.maximum(rate, _SLOW * rate.max())
        braking = scipy.sparse.diags_array(rate / self.power) @ self.acceleration
        turning = scipy.sparse.diags_array(1 / rate) @ self.rate
        rows = scipy.sparse.vstack([self.rows, turning + braking, turning - braking], format="csr")
        count = 2 * rate.size
        return rows, np.append(self.lower, np.full(count, -np.inf)), np.append(self.upper, np.full(count, 2.0))


def _differences(grid: Grid, order: int) -> Any:
    """Rows (size − order, size) that give the coefficients of a time derivative."""
    rows = scipy.sparse.eye_array(grid.size, format="csr")
    for _ in range(order):
        rows = (rows[1:] - rows[:-1]) / grid.step
    return rows
