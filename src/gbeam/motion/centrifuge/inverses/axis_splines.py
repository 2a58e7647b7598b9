"""Splines of the axes, the distance of the load that they make from the flight's, which is the cost of a plan, and the
machine's limits kept by them.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import scipy.sparse

from gbeam.arrays.types import Floats
from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion.centrifuge.inverses.instant import Geometry
from gbeam.motion.centrifuge.inverses.spin_up import Ramp
from gbeam.motion.centrifuge.limits import QUANTITIES, Limits
from gbeam.motion.centrifuge.target.target import Target
from gbeam.numerics.bspline import DEGREE, PIECE, Grid

AXES = 3
NEAR = AXES * PIECE  # coefficients that act on one piece
RATE, YAW, ROLL = range(AXES)  # of these quantities the splines are: ω1 rad/s, θ2 rad, θ3 rad
ON_WAY = 0.01  # weight of the squared error before the flight and after it
BELOW_IDLE = 0.1  # weight of the squared error while the flight's load is below idle, where it is 1 otherwise
EASE = 1e-4, 1e-6  # g0: what 1 rad/s² and 1 rad/s³ of any axis cost as a tracking error
_PAIRS = np.tril_indices(4)  # of states


class AxisSplines:
    """ω1, θ2 and θ3 as splines on one grid. The arm's rate at both ends is an unknown unless that is a `standstill`.

    The first five coefficients of each are one number, and so are the last five: values are what they are, and their
    first four derivatives are zero. The unknowns x are those numbers and all the others between, axis after axis at
    each place, so that everything that depends on a few neighbours is banded.
    """

    def __init__(self, grid: Grid, standstill: bool) -> None:
        """Number the unknowns, and lay out the sparse matrices: where each pair of coefficients is stored.

        At a `standstill` the arm's rate at both ends is zero, and no unknown.
        """
        self.grid = grid
        place = np.clip(np.arange(grid.size), DEGREE - 1, grid.size - DEGREE) - (DEGREE - 1)
        number = np.arange(AXES * (place[-1] + 1)).reshape(-1, AXES)
        if standstill:
            number = np.arange(-1, AXES * (place[-1] + 1) - 1).reshape(-1, AXES)
            number[-1] -= 1
            number[-1, RATE] = -1
        self.number = number[place]  # of the unknown that is each coefficient, (grid.size, 3); −1 where it is zero
        self.size = int(self.number.max()) + 1
        first, last = np.clip(np.arange(self.size) + np.array([[1 - NEAR], [NEAR]]), 0, self.size)
        starts = np.append(0, np.cumsum(last - first))  # of the columns of a matrix on x
        rows = np.arange(starts[-1]) - np.repeat(starts[:-1] - first, last - first)
        self._banded = rows, starts
        padded = np.append(self.number.ravel(), np.full(NEAR, -1))
        pair = np.lib.stride_tricks.sliding_window_view(padded, NEAR)[:-1].T, padded[:-NEAR]  # (later, earlier) unknown
        used = (pair[0] >= 0) & (pair[1] >= 0)
        self._places = [np.where(used, starts[c] + r - first[c], starts[-1]).ravel() for r, c in (pair, pair[::-1])]

    def expand_rows(self, rows: Any, axis: int) -> Any:
        """Rows (m, grid.size) that act on the coefficients of one axis as rows (m, size) that act on x."""
        number = self.number[:, axis]
        used = np.flatnonzero(number >= 0)
        chosen = (np.ones(used.size), (used, number[used]))
        return rows @ scipy.sparse.csr_array(chosen, shape=(self.grid.size, self.size))

    def derivative(self, axis: int, order: int) -> Any:
        """Rows (times, size) that give a time derivative of one axis's quantity at the grid's times."""
        return self.expand_rows(self.grid.matrix(order), axis)

    def coefficients(self, x: Floats) -> Floats:
        """Coefficients (grid.size, 3) of the splines."""
        return np.asarray(np.append(x, 0.0)[self.number])

    def unknowns(self, coefficients: Floats) -> Floats:
        """The unknowns x of coefficients (grid.size, 3). Where several are one unknown, the outermost counts."""
        x = np.zeros(self.size + 1)
        half = self.grid.size // 2
        x[self.number[half - 1 :: -1]] = coefficients[half - 1 :: -1]
        x[self.number[half:]] = coefficients[half:]
        return x[:-1]

    def assembled(self, pieces: Floats) -> Any:
        """Sum matrices of single pieces into the sparse symmetric matrix (size, size) for x.

        Each piece's matrix couples the 18 coefficients that act on it. `pieces` (171, pieces) holds the lower
        triangles.
        """
        band = np.zeros((NEAR, AXES * self.grid.size))  # row d couples every coefficient with the d-th after it
        for i, j, values in zip(*np.tril_indices(NEAR), pieces, strict=True):
            band[i - j, j : j + AXES * self.grid.pieces : AXES] += values
        rows, starts = self._banded
        data = np.bincount(self._places[0], band.ravel(), starts[-1] + 1)
        band[0] = 0.0  # the diagonal is its own mirror image
        data += np.bincount(self._places[1], band.ravel(), starts[-1] + 1)
        return scipy.sparse.csc_array((data[:-1], rows, starts), shape=(self.size, self.size))


_USED = 1 - 1e-5  # of a limit: a solution may exceed what it is given by its tolerance
_SLOW = 0.1  # of the largest rate: slower ones have its tangent


def idle_rate(target: Target, geometry: Geometry) -> float:
    """Rate of axis 1 at which the arm alone makes the idle load, rad/s, or zero where there is no idle."""
    horizontal2 = max(float(target.idle) ** 2 - float(geometry.gravity) ** 2, 0.0)
    return float((horizontal2 / float(geometry.arm) ** 2) ** 0.25)


class Tracking:
    """Half the integral over time of

        w |a_C − flight's own load|²/g0² + sum over the axes of (EASE · acceleration)² + (EASE · jerk)²,

    where before the flight's first time and after its last the load is that of spin-up and spin-down by themselves.

    The load depends on four states: ω1, dω1/dt, θ2 and θ3. Each is a row of the unknowns at every time of the grid.
    """

    def __init__(
        self, splines: AxisSplines, geometry: Geometry, target: Target, ramps: tuple[Ramp, Ramp] | None = None
    ) -> None:
        """Compute the flight's load at the knots' times, its weights, and all that does not depend on the unknowns."""
        grid = splines.grid
        self.splines, self.arm, self.gravity = splines, float(geometry.arm), float(geometry.gravity)
        first, last = (float(end) for end in target.span)
        self.flight = np.asarray(target.flight(np.clip(grid.time, first, last)))
        before, after = grid.time < first, grid.time > last
        for ramp, outside in zip(ramps or (), (before, after), strict=False):
            self.flight[outside] = ramp.load(grid.time[outside], self.arm)
        spacing = grid.step / grid.points.size
        short = np.maximum(float(target.idle) - np.linalg.norm(self.flight, axis=1), 0.0)
        short[before | after] = 0.0
        weight = np.where(before | after, ON_WAY, np.where(short > 0, BELOW_IDLE, 1.0))
        self.weight = np.sqrt(spacing * weight) / STANDARD_GRAVITY
        self.bound = float(np.sum((self.weight * short) ** 2)) / 2  # what idle costs, whatever the axes do
        states = (RATE, 0), (RATE, 1), (YAW, 0), (ROLL, 0)
        self.states = scipy.sparse.vstack([splines.derivative(*state) for state in states], format="csr")
        # Weights of a piece's coefficients in its states, (points, 4, 18).
        piece_weights = np.stack([_expand_weights(grid.rows(order), axis) for axis, order in states], axis=1)
        # Lower triangles (171, points · 10) that turn second derivatives by the states into those by the coefficients.
        by_pair = np.einsum("qsi,qtj->ijqst", piece_weights, piece_weights)[np.tril_indices(NEAR)]
        by_pair = by_pair + by_pair.swapaxes(2, 3)
        by_pair[:, :, range(4), range(4)] /= 2
        self.by_pair = by_pair[:, :, *_PAIRS].reshape(len(by_pair), -1)
        # The spline of axis 1 is that of its rate, those of axes 2 and 3 are those of their angles.
        eased = np.concatenate(
            [
                np.sqrt(spacing) * EASE[k] * _expand_weights(grid.rows(k + 1 + (axis != RATE)), axis)
                for k in range(len(EASE))
                for axis in range(AXES)
            ]
        )
        self.eased = (eased.T @ eased)[np.tril_indices(NEAR)][:, None]
        self.ease = splines.assembled(np.broadcast_to(self.eased, (self.eased.size, grid.pieces)))

    def gentler(self, factor: float) -> Tracking:
        """The cost with `EASE` multiplied by a factor."""
        copied = copy.copy(self)
        copied.ease, copied.eased = factor**2 * self.ease, factor**2 * self.eased
        return copied

    def cost(self, x: Floats) -> float:
        """The cost of the unknowns."""
        error, _ = self.error((self.states @ x).reshape(4, -1), 0)
        return (float(np.sum(error**2)) + float(x @ (self.ease @ x))) / 2

    def model(self, x: Floats) -> tuple[Any, Floats]:
        """Slope of the cost, and a positive semidefinite matrix in place of its second derivatives.

        At every time the second derivatives by the states are replaced by their absolute value, which has the absolute
        eigenvalues. Where the flight's load is small, turning the machine's load is a saddle of the cost. Gauss and
        Newton's products of first derivatives alone would take it for a valley.
        """
        error, slope, second = self.error((self.states @ x).reshape(4, -1), 2)
        eigenvalues, vectors = np.linalg.eigh(second)
        second = (vectors * np.abs(eigenvalues)[:, None]) @ vectors.swapaxes(1, 2)
        by_states = np.einsum("kjt,kt->jt", slope, error).ravel()
        pieces = second[:, *_PAIRS].reshape(self.splines.grid.pieces, -1)
        hessian = self.splines.assembled(self.by_pair @ pieces.T + self.eased)
        return hessian, self.states.T @ by_states + self.ease @ x

    def error(self, state: Floats, order: int) -> tuple[Floats, ...]:
        """Weighted tracking error (3, times), g0, of states (4, times).

        Of order 0 the load, m/s², comes with it. Of order 2 its slope (3, 4, times) and the second derivatives (times,
        4, 4) of half its square by the states come with it.
        """
        arm, gravity, (rate, acceleration, yaw, roll) = self.arm, self.gravity, state
        radial, tangential = -arm * rate**2, arm * acceleration
        sin2, cos2, sin3, cos3 = np.sin(yaw), np.cos(yaw), np.sin(roll), np.cos(roll)
        # `control_point_load`: what is along the beam and across it; the roll turns what is across it.
        axial, lateral = radial * cos2 + tangential * sin2, tangential * cos2 - radial * sin2
        load = np.stack([axial, lateral * cos3 + gravity * sin3, gravity * cos3 - lateral * sin3])
        error = self.weight * (load - self.flight.T)
        if order == 0:
            return error, load
        # First derivatives by the states, and Gauss and Newton's part of the second ones.
        zero, by_rate = 0.0 * axial, -2 * arm * rate
        d_along = np.stack([by_rate * cos2, arm * sin2, lateral, zero])
        d_across = np.stack([-by_rate * sin2, arm * cos2, -axial, zero])
        slope = np.stack([d_along, d_across * cos3, -d_across * sin3])
        slope[1, 3], slope[2, 3] = load[2], -load[1]
        slope *= self.weight
        second = np.einsum("kit,kjt->tij", slope, slope)
        # Σ error ∂²error/∂state², by the parts along the beam, across it, and across it turned by a right angle.
        by_along, by_across, by_turned = self.weight * np.stack(
            [error[0], error[1] * cos3 - error[2] * sin3, -error[1] * sin3 - error[2] * cos3]
        )
        curvature = {
            (0, 0): 2 * arm * (sin2 * by_across - cos2 * by_along),
            (0, 2): -by_rate * (sin2 * by_along + cos2 * by_across),
            (1, 2): arm * (cos2 * by_along - sin2 * by_across),
            (2, 2): -axial * by_along - lateral * by_across,
            (0, 3): d_across[0] * by_turned,
            (1, 3): d_across[1] * by_turned,
            (2, 3): d_across[2] * by_turned,
            (3, 3): -self.weight * (error[1] * load[1] + error[2] * load[2]),
        }
        for (i, j), value in curvature.items():
            second[:, i, j] += value
            if i != j:
                second[:, j, i] += value
        return error, slope, second


def _expand_weights(rows: Floats, axis: int) -> Floats:
    """Weights (m, 6) of one axis's coefficients on a piece as weights (m, 18) of all axes'."""
    weights = np.zeros((len(rows), NEAR))
    weights[:, axis::AXES] = rows
    return weights


class KeptLimits:
    """Rows of the unknowns with lower and upper limits.

    A derivative of a spline lies between its coefficients, which are differences of the spline's own over the step: the
    limits of these are kept between the knots too. The arm's power J ω1 |dω1/dt| <= P is not linear. Its tangent at a
    rate Ω, |dω1/dt| <= (P/J) (2 − ω1/Ω)/Ω, is within it at every other rate, because P/(J ω1) is convex. With one Ω for
    a piece it holds on all of the piece where it holds for the hull.
    """

    def __init__(self, splines: AxisSplines, geometry: Geometry, limits: Limits, target: Target) -> None:
        """Write limits of rate, acceleration and jerk as linear constraints on the splines' coefficients."""
        grid, allowed = splines.grid, np.asarray(limits.axes)
        self.idle = idle_rate(target, geometry)
        rows, lower, upper = [], [], []
        coefficients = scipy.sparse.eye_array(grid.size, format="csr")
        for axis in range(AXES):
            for quantity in range(len(QUANTITIES)):
                order = quantity + (axis != RATE)  # the spline of axis 1 is that of its rate
                limit = allowed[quantity, axis]
                if order == 0:
                    rows.append(splines.expand_rows(coefficients, axis))
                    lower.append(self._least_coefficients(grid, target))
                    upper.append(np.full(grid.size, limit * _USED))
                elif limit < np.inf:
                    rows.append(splines.expand_rows(_differences(grid, order), axis) / limit)
                    upper.append(np.full(grid.size - order, _USED))
                    lower.append(-upper[-1])
        matrix = scipy.sparse.vstack(rows, format="csr")
        used = np.diff(matrix.indptr) > 0  # at standstill there is nothing to limit
        self.rows, self.lower, self.upper = matrix[used], np.concatenate(lower)[used], np.concatenate(upper)[used]
        self.power = _USED * float(limits.power / limits.inertia) if np.isfinite(limits.power) else np.inf
        if self.power < np.inf:
            self.rate, self.acceleration = (splines.expand_rows(grid.hull(order), RATE) for order in (0, 1))

    def _least_coefficients(self, grid: Grid, target: Target) -> Floats:
        """Least coefficients of ω1: those that act during the flight are at idle, and the arm never turns back."""
        first, last = ((float(end) - grid.start) / grid.step for end in target.span)
        least_load = np.zeros(grid.size)
        begin, end = max(int(np.floor(first)), 0), min(int(np.ceil(last)), grid.pieces)
        least_load[begin : end + DEGREE] = self.idle / _USED
        return least_load

    def linearise(self, x: Floats) -> tuple[Any, Floats, Floats]:
        """Matrix (m, size) and lower and upper limits (m,) of the linear constraints on the unknowns.

        The power's limit |rate · acceleration| <= P is not linear. Its rows are tangents at `x`.
        """
        if self.power == np.inf:
            return self.rows, self.lower, self.upper
        # The largest rate of each piece holds for all of it.
        rate = np.repeat(np.max((self.rate @ x).reshape(-1, PIECE), axis=1), PIECE)
        rate = np.maximum(rate, _SLOW * rate.max())
        braking = scipy.sparse.diags_array(rate / self.power) @ self.acceleration
        arm_rate = scipy.sparse.diags_array(1 / rate) @ self.rate
        rows = scipy.sparse.vstack([self.rows, arm_rate + braking, arm_rate - braking], format="csr")
        count = 2 * rate.size
        return rows, np.append(self.lower, np.full(count, -np.inf)), np.append(self.upper, np.full(count, 2.0))


def _differences(grid: Grid, order: int) -> Any:
    """Rows (size − order, size) that give the coefficients of a spline's time derivative of an order."""
    rows = scipy.sparse.eye_array(grid.size, format="csr")
    for _ in range(order):
        rows = (rows[1:] - rows[:-1]) / grid.step
    return rows
