"""The exact inverse: the arm's rate and the yaw lag that give the horizontal load its size and direction at once.

With A = a/R, ω1² = A cos δ and dω1/dt = A sin δ, theory.md A1 (9): sin δ (δ' + 2 sqrt(A cos δ)) = (A'/A) cos δ.
It is stable forward while the load rises and backward while it falls, so its smooth solution needs no initial value;
where the load rises at the start or falls at the end, it is the solution that has no layer there: the machine is
yawed ahead of the record as if the load had been rising before. A spline is laid through all of it at once
(collocation, by Gauss-Newton), which is both directions in one and joins them at the turning points.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import record
from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse, Pose, gimbals
from gbeam.motion.centrifuge.target.reachability import sharp_turns, size_and_rates
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import Grid, Normal, Spline
from gbeam.numerics.series import sin_cos, sqrt, square

# Of the horizontal load: refined until this is reached. The third derivative of a rounded record jumps wherever a knot
# enters the kernel, and the collocation is of third order there; on a smooth load it is far better.
TRACKING = 1e-7
ACCEPTED = 1e-4  # what is still a solution, with a warning
_STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4)  # s between knots
_MOST = 60_000  # pieces
_POINTS = np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])
_SMOOTH = 1e-4  # weight of the third derivative at the ends: of all solutions there it picks the one without a layer

Floats = NDArray[np.float64]


@record
class Exact(Inverse):
    """The lag δ as a spline, the arm's rate sqrt(A cos δ)."""

    within: ClassVar[float] = TRACKING
    unless: ClassVar[str] = (
        "the load turns faster there than the finest knots of the solution resolve; a wider smoothing helps"
    )
    geometry: Geometry
    lag: Spline

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""
        load, lag = target.series(t, order), self.lag.series(t, order)[..., 0]
        horizontal = sqrt(square(load) - self.geometry.gravity**2)
        rate = sqrt(horizontal / self.geometry.arm * sin_cos(lag)[1])
        return rate, *gimbals(load, lag, self.geometry)


def exact(target: Target, geometry: Geometry) -> Exact:
    """Solve for the lag.

    Raises
    ------
    InputError
        If the load turns too sharply for the arm, with the smoothing that it needs.
    """
    first, last = (float(end) for end in target.span)
    lag, error, grid = None, np.inf, None
    for step in _STEPS:
        if grid is not None and (last - first) / step > _MOST:
            break
        grid = Grid(first, last, step, _POINTS)
        lag, errors = _solve(grid, target, geometry)
        error = float(errors.max())
        if error <= TRACKING:
            break
    assert lag is not None and grid is not None
    if not error <= ACCEPTED:
        raise _refusal(target, geometry, grid, errors)
    return Exact(geometry, grid.spline(lag[:, None]))


def _solve(grid: Grid, target: Target, geometry: Geometry) -> tuple[Floats, Floats]:
    """Coefficients of the lag, and the tracking error at the collocation points over the horizontal load."""
    size, rate, _ = size_and_rates(target.load, geometry.gravity, grid.time)
    a, growth = size / float(geometry.arm), rate / size
    value, slope = grid.weights(0), grid.weights(1)
    # The slow solution to first order, which is flat's.
    start = np.arctan(growth / (2 * np.sqrt(a)))
    c = grid.fit(start[:, None])[:, 0]
    near = grid.first[:, None] + np.arange(value.shape[1])
    ends, bend = np.array([0, -1]), _SMOOTH * grid.step**3 * grid.weights(3)

    def state(c: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        lag, dlag = np.sum(value * c[near], axis=1), np.sum(slope * c[near], axis=1)
        lag = np.clip(lag, -1.5, 1.5)
        turn = 2 * np.sqrt(a * np.cos(lag))
        return lag, dlag, turn, np.sin(lag) * (dlag + turn) - growth * np.cos(lag)

    def error(lag: Floats, residual: Floats) -> Floats:
        return np.asarray(np.abs(residual) / (2 * np.sqrt(a * np.cos(lag))))  # |R dω1/dt − a sin δ| / a

    lag, dlag, turn, residual = state(c)
    for _ in range(40):
        by_lag = np.cos(lag) * (dlag + turn) - np.sin(lag) ** 2 * turn / (2 * np.cos(lag)) + growth * np.sin(lag)
        rows = by_lag[:, None] * value + np.sin(lag)[:, None] * slope
        normal = Normal(grid.size, 1)
        normal.add(grid.first, rows[:, None, :], -residual[:, None])
        bent = np.sum(bend[ends] * c[near[ends]], axis=1)
        normal.add(grid.first[ends], bend[ends][:, None, :], -bent[:, None])
        try:
            move = normal.solve(1e-13)
        except np.linalg.LinAlgError:
            return c, np.full_like(residual, np.inf)
        # Far from the solution a whole step may leave the range of the lag.
        for part in (1.0, 0.5, 0.25, 0.1):
            new = state(c + part * move)
            if np.sum(new[3] ** 2) < np.sum(residual**2) * (1 + 1e-9) + 1e-20:
                break
        c = c + part * move
        lag, dlag, turn, residual = new
        if np.abs(move).max() < 1e-12:
            break
    return c, error(lag, residual)


def _refusal(target: Target, geometry: Geometry, grid: Grid, errors: Floats) -> InputError:
    """Name the place and the smoothing that would do."""
    turns = sharp_turns(target, float(geometry.arm))
    if not turns:
        at = grid.time[int(np.argmax(np.where(np.isfinite(errors), errors, 0.0)))]
        problem = f"is too small for the exact inverse: no smooth motion follows the load about {at:.3f} s"
        return InputError("smoothing", problem, 'give more, or inverse = "planned" or "flat"')
    worst = max((turn for turn, _ in turns), key=lambda turn: turn.reference / turn.possible)
    widths = [width for _, width in turns if width is not None]
    wider = f'give "{np.ceil(1e3 * max(widths)):.0f} ms" or more, or ' if len(widths) == len(turns) else "give "
    return InputError(
        "smoothing",
        f"is too small for the exact inverse: about {worst.time:.3f} s the load turns by "
        f"−ä = {worst.reference:.3g} m/s^4 "
        f"and the arm allows a²/R = {worst.possible:.3g} m/s^4",
        f'{wider}inverse = "planned" or "flat"',
    )
