"""The planned inverse: axis motions from standstill to standstill with the least tracking error within all limits.

The three axes are quintic splines. Their coefficients minimise

    ∫ w |a_C − flight's own load|²/g0² + ease of the motion  dt    within every limit,

where w is small while the flight's load is below idle, and smaller before the flight and after it, where the load is
that of a plain spin-up and spin-down; the last term, too small to be seen in the load, picks the gentlest of equally
good motions. The limits are those of the axes and of the arm's power at all times, idle as a least rate of the arm
during the flight, and rest at both ends. The minimum is the one near the quasi-static motion, by a sequence of
quadratic programs, on finer and finer knots.
"""

from __future__ import annotations

import copy
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from gbeam.arrays.tree import record
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.motion.centrifuge.inverses.axis_splines import AXES, NEAR, RATE, ROLL, YAW, AxisSplines
from gbeam.motion.centrifuge.inverses.instant import Geometry, Inverse, Pose, QuasiStatic
from gbeam.motion.centrifuge.inverses.spin_up import Ramp, build_ramps
from gbeam.motion.centrifuge.limits import Ends, Limits
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import PIECE, Grid, Spline

ON_WAY = 0.01  # weight of the squared error before the flight and after it
BELOW_IDLE = 0.1  # weight of the squared error while the flight's load is below idle, where it is 1 otherwise
EASE = 1e-4, 1e-6  # g0: what 1 rad/s² and 1 rad/s³ of any axis cost as a tracking error
_PAIRS = np.tril_indices(4)  # of states

Floats = NDArray[np.float64]


class Tracking:
    """Half the integral over time of

        w |a_C − flight's own load|²/g0² + sum over the axes of (EASE · acceleration)² + (EASE · jerk)²,

    where before the flight's first time and after its last the load is that of spin-up and spin-down by themselves.

    The load depends on four states: ω1, dω1/dt, θ2 and θ3; each is a row of the unknowns at every time of the grid.
    """

    def __init__(
        self, splines: AxisSplines, geometry: Geometry, target: Target, ramps: tuple[Ramp, Ramp] | None = None
    ) -> None:
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
        near = np.stack([_on_axis(grid.rows(order), axis) for axis, order in states], axis=1)
        # The lower triangles of what the states' second derivatives are by the coefficients, (171, points · 10).
        by_pair = np.einsum("qsi,qtj->ijqst", near, near)[np.tril_indices(NEAR)]
        by_pair = by_pair + by_pair.swapaxes(2, 3)
        by_pair[:, :, range(4), range(4)] /= 2
        self.by_pair = by_pair[:, :, *_PAIRS].reshape(len(by_pair), -1)
        # The spline of axis 1 is that of its rate, those of axes 2 and 3 are those of their angles.
        eased = np.concatenate(
            [
                np.sqrt(spacing) * EASE[k] * _on_axis(grid.rows(k + 1 + (axis != RATE)), axis)
                for k in range(len(EASE))
                for axis in range(AXES)
            ]
        )
        self.eased = (eased.T @ eased)[np.tril_indices(NEAR)][:, None]
        self.ease = splines.assembled(np.broadcast_to(self.eased, (self.eased.size, grid.pieces)))

    def gentler(self, factor: float) -> Tracking:
        """Cost with a larger EASE."""
        other = copy.copy(self)
        other.ease, other.eased = factor**2 * self.ease, factor**2 * self.eased
        return other

    def cost(self, x: Floats) -> float:
        """The cost of the unknowns."""
        error, _ = self.error((self.states @ x).reshape(4, -1), 0)
        return (float(np.sum(error**2)) + float(x @ (self.ease @ x))) / 2

    def model(self, x: Floats) -> tuple[Any, Floats]:
        """A positive semidefinite matrix near the cost's second derivatives, and its slope.

        At every time the second derivatives by the states are replaced by their absolute value, that of their
        eigenvalues: where the flight's load is small, what turns the machine's is a saddle, which the products of
        the first derivatives alone (Gauss and Newton's) take for a valley.
        """
        error, slope, second = self.error((self.states @ x).reshape(4, -1), 2)
        size, vectors = np.linalg.eigh(second)
        second = (vectors * np.abs(size)[:, None]) @ vectors.swapaxes(1, 2)
        by_states = np.einsum("kjt,kt->jt", slope, error).ravel()
        pieces = second[:, *_PAIRS].reshape(self.splines.grid.pieces, -1)
        hessian = self.splines.assembled(self.by_pair @ pieces.T + self.eased)
        return hessian, self.states.T @ by_states + self.ease @ x

    def error(self, state: Floats, order: int) -> tuple[Floats, ...]:
        """Weighted tracking error in g0 and what follows from it, of states (4, times)."""
        arm, gravity, (rate, acceleration, yaw, roll) = self.arm, self.gravity, state
        radial, tangential = -arm * rate**2, arm * acceleration
        sin2, cos2, sin3, cos3 = np.sin(yaw), np.cos(yaw), np.sin(roll), np.cos(roll)
        # `control_point_load`: what is along the beam and across it; the roll turns what is across it.
        along, across = radial * cos2 + tangential * sin2, tangential * cos2 - radial * sin2
        load = np.stack([along, across * cos3 + gravity * sin3, gravity * cos3 - across * sin3])
        error = self.weight * (load - self.flight.T)
        if order == 0:
            return error, load
        none, by_rate = 0.0 * along, -2 * arm * rate
        d_along = np.stack([by_rate * cos2, arm * sin2, across, none])
        d_across = np.stack([-by_rate * sin2, arm * cos2, -along, none])
        slope = np.stack([d_along, d_across * cos3, -d_across * sin3])
        slope[1, 3], slope[2, 3] = load[2], -load[1]
        slope *= self.weight
        second = np.einsum("kit,kjt->tij", slope, slope)
        # Σ error ∂²error/∂state², by the parts along the beam, across it, and across it turned by a right angle.
        by_along, by_across, by_turned = self.weight * np.stack(
            [error[0], error[1] * cos3 - error[2] * sin3, -error[1] * sin3 - error[2] * cos3]
        )
        bent = {
            (0, 0): 2 * arm * (sin2 * by_across - cos2 * by_along),
            (0, 2): -by_rate * (sin2 * by_along + cos2 * by_across),
            (1, 2): arm * (cos2 * by_along - sin2 * by_across),
            (2, 2): -along * by_along - across * by_across,
            (0, 3): d_across[0] * by_turned,
            (1, 3): d_across[1] * by_turned,
            (2, 3): d_across[2] * by_turned,
            (3, 3): -self.weight * (error[1] * load[1] + error[2] * load[2]),
        }
        for (i, j), value in bent.items():
            second[:, i, j] += value
            if i != j:
                second[:, j, i] += value
        return error, slope, second


def _on_axis(rows: Floats, axis: int) -> Floats:
    """Weights (m, 6) of one axis's coefficients on a piece as weights (m, 18) of all axes'."""
    weights = np.zeros((len(rows), NEAR))
    weights[:, axis::AXES] = rows
    return weights


_COARSE, _FINE, _FINEST = 0.08, 0.02, 0.005  # s between knots: at first; at most; at least
_GAIN = 0.15  # of the cost above its bound, that finer knots must bring to go on
_GENTLER = 100.0, 10.0, 1.0  # times the ease: the search begins with gentle motions, whose minima are fewer
_PER_RAMP = 12  # pieces of a spin-up, at least
_POINTS = np.array([1, 3, 5]) / 6  # of each piece


@record
class Planned(Inverse):
    """ω1, θ2 and θ3 as splines, solved for in advance for one target."""

    within: ClassVar[float] = 0.01
    unless: ClassVar[str] = "no motion near by does better"
    axes: Spline

    @property
    def extent(self) -> tuple[float, float]:
        """First and last time of the plan, s: before and after, the machine stays in the state that it has there."""
        first, pieces = float(self.axes.start), len(self.axes.coefficients) - PIECE + 1
        return first, first + pieces * float(self.axes.step)

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        axes = self.axes.series(t, order)
        return axes[..., 0], axes[..., 1], axes[..., 2]


@lru_cache(maxsize=4)  # keyed by values: equal machines of a study wait once
def planned(target: Target, geometry: Geometry, limits: Limits, ends: Ends) -> Planned:
    """Plan the axes.

    With `ends.start` ``idle`` the motion begins and ends at the flight's first and last time, with the arm turning at a
    constant rate and the gimbals at rest. Otherwise all is at rest at both ends; with ``pre-yawed`` the search begins
    from another motion.
    """
    # scipy.sparse and the solver take longer to import than most commands to run
    from gbeam.motion.centrifuge.inverses.axis_splines import AxisSplines, KeptLimits, idle_rate
    from gbeam.numerics.minimise import minimise, nearest_within

    idle, fastest = idle_rate(target, geometry), float(limits.axes[0, 0])
    if idle > fastest:
        problem = f"needs {idle:.3g} rad/s of axis 1, whose rate is limited to {fastest:.3g} rad/s"
        raise InputError("idle", problem, "give less, or a machine with a longer arm or a faster axis 1")
    ramps = build_ramps(target, QuasiStatic(geometry), geometry, limits, ends)
    begin, end = target.span if ramps is None else (float(ramp.still) for ramp in ramps)
    lasts = {"spin_up": target.span[0] - begin, "": target.span[1] - target.span[0], "spin_down": end - target.span[1]}
    fix = f"give {KNOTS * _FINE:g} s or less altogether"
    refuse_more(max(lasts, key=lambda name: lasts[name]), "knots", (end - begin) / _FINE, KNOTS, 4000.0, fix)
    step = _COARSE if ramps is None else min(_COARSE, *(ramp.length / _PER_RAMP for ramp in ramps))
    grid = Grid(float(begin), float(end), step, _POINTS)
    c, best, within = grid.fit(_guess(grid.time, target, geometry, ramps)), np.inf, False
    while True:
        splines = AxisSplines(grid, standstill=ramps is not None)
        kept = KeptLimits(splines, geometry, limits, target)
        x = splines.unknowns(c)
        near = x if within else nearest_within(kept, x)
        if near is not None:
            tracking, x = Tracking(splines, geometry, target, ramps), near
            for factor in (1.0,) if within else _GENTLER:
                x, cost = minimise(tracking.gentler(factor), kept, x)
            c, gain, best, within = splines.coefficients(x), best - cost, cost, True
            if grid.step <= _FINE and gain <= _GAIN * (cost - tracking.bound):
                break
        if grid.step / 2 < _FINEST:
            break
        c, grid = grid.refined(c), grid.halved()
    if not within:
        raise _refusal(limits, ends, ramps)
    return Planned(grid.spline(c))


def _guess(time: Floats, target: Target, geometry: Geometry, ramps: tuple[Ramp, Ramp] | None) -> Floats:
    """The quasi-static motion of the target, from standstill to standstill, (times, 3)."""
    pose = [part.value for part in QuasiStatic(geometry).pose(target.load, np.clip(time, *target.span), 0)]
    for ramp in ramps or ():
        on_way = (time - ramp.steady) * (ramp.still - ramp.steady) > 0
        for values, part in zip(pose, ramp.pose(time[on_way], 0), strict=True):
            values[on_way] = part.value
    rate, *angles = pose
    return np.column_stack([rate, *(np.unwrap(angle) for angle in angles)])


def _refusal(limits: Limits, ends: Ends, ramps: tuple[Ramp, Ramp] | None) -> InputError:
    """Name the time that is too short for the limits."""
    for name, ramp in zip(("spin_up", "spin_down"), ramps or (), strict=False):
        duration, more = getattr(ends, name), ramp.lengthened(limits).length - ramp.length
        if duration is not None and more > 0:
            problem = f"is {duration:.3g} s: within the limits of axis 1 that is too short for the arm to reach idle"
            return InputError(
                name, problem, f'give "{np.ceil(10 * (duration + more)) / 10:g} s" or more, or leave it out'
            )
    return InputError("limits", "leave no motion that keeps idle during the flight", "give less idle, or wider limits")
