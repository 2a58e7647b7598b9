"""The planned inverse: axis motions with the least tracking error over the whole record, within the machine's limits.

The three axes are quintic splines. Their coefficients minimise

    ∫ w |a_C − reference|²/g0² + ease of the motion  dt    within every limit,

where w is small while the target is held anyway and the last term, too small to be seen in the load, picks the gentlest
of equally good motions. Limits are kept between the knots too, by the hull of the splines. Every row acts on six
neighbouring coefficients of the axes, so the normal equations are banded and a minute's record takes seconds. Standing
still keeps every limit: a plan always exists, and it comes with how well it follows the load. The minimum is the one
near the plan without limits; where limits leave little of that, a motion of another kind may be better. A spin-up has
its own course, which is not planned.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import record
from gbeam.motion.bases.conditioning import STANDARD_GRAVITY
from gbeam.motion.centrifuge.inverses.closed_form import Flat, Geometry, Inverse, Pose, QuasiStatic
from gbeam.motion.centrifuge.machine.limits import Limits
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import PIECE, Grid, Normal, Spline
from gbeam.numerics.solvers.interior_point import minimise

HELD = 0.01  # weight of the tracking error while the target is held, where it is 1 otherwise
_EASE = 1e-5, 1e-7  # weights of 1 rad/s² and of 1 rad/s³ beside a tracking error of 1 g0
_COARSEST, _FINEST, _PER_WIDTH = 0.02, 0.005, 6  # s between knots; knots per width of the target's smoothing
_POINTS = np.array([1, 3, 5]) / 6  # of each piece
_PARTS = 2  # of each piece, whose hulls are kept within the limits
_POWER = 0.995  # of the arm's power is used: it is looked at in the points only
_ACROSS = 3 * PIECE  # coefficients that one piece depends on
_UPPER = np.triu_indices(_ACROSS)  # pairs of them, in which products of rows are symmetric

Floats = NDArray[np.float64]


@record
class Planned(Inverse):
    """ω1, θ2 and θ3 as splines, solved for in advance for one target."""

    within: ClassVar[float] = 0.01
    unless: ClassVar[str] = "no motion near by does better"
    axes: Spline

    @property
    def extent(self) -> tuple[float, float]:
        """First and last time of the plan, s."""
        first, pieces = float(self.axes.start), len(self.axes.coefficients) - PIECE + 1
        return first, first + pieces * float(self.axes.step)

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""
        axes = self.axes.series(t, order)
        return axes[..., 0], axes[..., 1], axes[..., 2]


def planned(target: Target, geometry: Geometry, limits: Limits) -> Planned:
    """Plan the axes, starting from those of the flat inverse."""
    first, last = (float(end) for end in target.span)
    step = float(np.clip(2 * target.half_width / _PER_WIDTH, _FINEST, _COARSEST))
    grid = Grid(first, last, step, _POINTS)
    starts = [inverse.pose(target.load, grid.time, 0) for inverse in (Flat(geometry), QuasiStatic(geometry))]
    reference, not_followed = target.load(grid.time), target.not_followed(grid.time)
    weight = np.sqrt(np.where(not_followed, HELD, 1.0))
    # Without limits first, and of several starts the best: far from what the arm can do, flat's is a poor one.
    free = Tracking(grid, geometry, Limits(), reference, weight)
    tried = [
        minimise(free, grid.fit(np.column_stack([rate.value, *(np.unwrap(angle.value) for angle in angles)])))
        for rate, *angles in starts
    ]
    c, _ = min(tried, key=lambda each: each[1])
    within = Tracking(grid, geometry, limits, reference, weight)
    if within.most(c) > 1:
        c, _ = minimise(within, c)
        # What a search that ended early still exceeds: the same motion about the same angles, smaller.
        middle = np.mean(c, axis=0) * [0, 1, 1]
        c = middle + (c - middle) / max(within.most(c), 1.0)
    return Planned(grid.spline(c))


class Tracking:
    """The cost of a motion and the shares of the limits that it uses; a ``Problem`` of the solver.

    The load depends on four states: the arm's rate and acceleration and the angles of the gimbals. Each is the product
    of a row and the coefficients around it, the same rows in every piece.
    """

    def __init__(self, grid: Grid, geometry: Geometry, limits: Limits, reference: Floats, weight: Floats) -> None:
        self.grid, self.geometry, self.reference, self.weight = grid, geometry, reference, weight
        orders = np.stack([grid.rows(order) for order in range(4)])
        state = np.stack([_row(orders[k], axis) for k, axis in ((0, 0), (1, 0), (0, 1), (0, 2))], axis=1)
        self.state = state.reshape(-1, _ACROSS)  # (points · states, 18)
        self.products = np.einsum("psI,ptJ->IJpst", state, state)[_UPPER].reshape(len(_UPPER[0]), -1)
        # The spline of axis 1 is that of its rate, those of axes 2 and 3 are those of their angles.
        rates = [(q, axis, q + (axis > 0)) for q in range(3) for axis in range(3)]
        ease = np.concatenate([_EASE[q - 1] * _row(orders[k], axis) for q, axis, k in rates if q > 0])
        self.ease = ease.T @ ease
        allowed, hulls, self.hull_products = np.asarray(limits.axes), [np.empty((0, _ACROSS))], []
        for axis in range(3):  # a row of a hull is of one axis, and so are its products
            of_axis = [
                _row(grid.hull(k, _PARTS), axis) / allowed[q, axis]
                for q, other, k in rates
                if other == axis and allowed[q, axis] < np.inf
            ]
            rows = np.concatenate([np.empty((0, _ACROSS)), *of_axis])
            of_both = np.flatnonzero((_UPPER[0] % 3 == axis) & (_UPPER[1] % 3 == axis))
            first = sum(len(each) for each in hulls)
            pairs = rows[:, _UPPER[0][of_both]] * rows[:, _UPPER[1][of_both]]
            self.hull_products.append((slice(first, first + len(rows)), of_both, pairs.T))
            hulls.append(rows)
        self.hull = np.concatenate(hulls)
        self.per_power = float(limits.inertia / limits.power) / _POWER  # zero where there is no such limit

    def cost(self, c: Floats) -> float:
        """Half the sum of squares."""
        near = self.grid.windows(c)
        residual = self.residual(self._states(near))
        return float(np.sum(residual**2) + np.sum(near @ self.ease * near)) / 2

    def shares(self, c: Floats) -> Floats:
        """Those of the hulls, then those of the arm's power."""
        near = self.grid.windows(c)
        state, of_hull = self._states(near), (near @ self.hull.T).ravel()
        return np.append(of_hull, self.per_power * state[:, 0] * state[:, 1]) if self.per_power else of_hull

    def most(self, c: Floats) -> float:
        """Largest share of a limit that a motion uses."""
        return float(np.max(np.abs(self.shares(c)), initial=0.0))

    def linearise(self, c: Floats) -> None:
        """Take the derivatives of the residuals and of the power with respect to the states."""
        self.near = self.grid.windows(c)
        state = self._states(self.near)
        residual, slope = self.residual(state), self.derivatives(state)
        across = slope.swapaxes(1, 2)
        self.square, self.slope = across @ slope, (across @ residual[..., None])[..., 0]
        self.power = self.per_power * np.stack([state[:, 1], state[:, 0], *np.zeros((2, len(state)))], axis=1)

    def step(self, weight: Floats, pull: Floats, damping: float) -> Floats:
        """One solution of the normal equations; the damping is relative to the largest curvature of the load."""
        pieces, first = self.grid.pieces, pull.size - len(self.power) if self.per_power else pull.size
        square, slope = self.square, self.slope
        if self.per_power:
            square = square + weight[first:, None, None] * self.power[:, :, None] * self.power[:, None, :]
            slope = slope + pull[first:, None] * self.power
        products = self.products @ square.reshape(pieces, -1).T + self.ease[_UPPER][:, None]
        of_hulls = weight[:first].reshape(pieces, -1).T
        for rows, pairs, each in self.hull_products:
            products[pairs] += each @ of_hulls[rows]
        side = (
            slope.reshape(pieces, -1) @ self.state
            + self.near @ self.ease
            + pull[:first].reshape(pieces, -1) @ self.hull
        )
        normal = Normal(pieces, 3)
        normal.add_products(products, -side.T)
        return normal.solve_shifted(damping * float(self.square.max())).reshape(-1, 3)

    def change(self, move: Floats) -> Floats:
        """Change of the shares, to first order."""
        near = self.grid.windows(move)
        of_hull = (near @ self.hull.T).ravel()
        return np.append(of_hull, np.sum(self.power * self._states(near), axis=1)) if self.per_power else of_hull

    def residual(self, state: Floats) -> Floats:
        """Weighted tracking error, (times, 3), in g0."""
        radial, tangential, sin2, cos2, sin3, cos3 = self._parts(state)
        across = tangential * cos2 - radial * sin2
        load = np.stack(
            [
                radial * cos2 + tangential * sin2,
                across * cos3 + self.geometry.gravity * sin3,
                self.geometry.gravity * cos3 - across * sin3,
            ],
            axis=-1,
        )
        return (self.weight / STANDARD_GRAVITY)[:, None] * (load - self.reference)

    def derivatives(self, state: Floats) -> Floats:
        """Its derivatives with respect to the states, (times, 3, 4): of the load of `control_point_load`."""
        arm, gravity = float(self.geometry.arm), self.geometry.gravity
        radial, tangential, sin2, cos2, sin3, cos3 = self._parts(state)
        along, across = radial * cos2 + tangential * sin2, tangential * cos2 - radial * sin2
        none, by_rate = np.zeros_like(along), -2 * arm * state[:, 0]
        # By ω1, dω1/dt and θ2 of what is along the beam and across it; θ3 turns what is across it.
        d_along = np.stack([by_rate * cos2, arm * sin2, across, none])
        d_across = np.stack([-by_rate * sin2, arm * cos2, -along, none])
        turned = across * sin3 - gravity * cos3, across * cos3 + gravity * sin3
        slope = np.stack([d_along, d_across * cos3, -d_across * sin3])
        slope[1, 3], slope[2, 3] = -turned[0], -turned[1]
        return (self.weight / STANDARD_GRAVITY)[:, None, None] * slope.transpose(2, 0, 1)

    def _parts(self, state: Floats) -> tuple[Floats, ...]:
        """Radial and tangential acceleration of C, sines and cosines of θ2 and θ3."""
        arm, (rate1, acceleration1, angle2, angle3) = float(self.geometry.arm), state.T
        return (
            -arm * rate1**2, arm * acceleration1, np.sin(angle2), np.cos(angle2), np.sin(angle3), np.cos(angle3),
        )  # fmt: skip

    def _states(self, near: Floats) -> Floats:
        """States at the points, (times, 4)."""
        return np.asarray((near @ self.state.T).reshape(-1, 4))


def _row(weights: Floats, axis: int) -> Floats:
    """Weights (m, 6) of one axis as rows (m, 18) that act on the coefficients of all three around a piece."""
    rows = np.zeros((len(weights), PIECE, 3))
    rows[:, :, axis] = weights
    return rows.reshape(-1, _ACROSS)
