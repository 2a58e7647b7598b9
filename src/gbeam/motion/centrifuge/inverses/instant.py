"""Inverses of the three-axis centrifuge instant by instant, in closed form and exact (Zhang 2020, corrected).

An inverse maps a target (the reference load at the control point, over time) to the arm's rate and the two gimbal
angles, as series in time, so that their rates come with them. The exact one has the arm's rate and the yaw lag that
give the horizontal load its size and direction at once.

With A = a/R, ω1² = A cos δ and dω1/dt = A sin δ: sin δ (δ' + 2 sqrt(A cos δ)) = (A'/A) cos δ, docs/theory.md (8.4).
It is stable forward while the load rises and backward while it falls, so its smooth solution needs no initial value.
Where the load rises at the start or falls at the end, it is the solution that has no layer there: the machine is
yawed ahead of the record as if the load had been rising before. A spline is laid through all of it at once
(collocation, by Gauss-Newton), which is both directions in one and joins them at the turning points.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.motion.centrifuge.target.reachability import PARTED, sharp_turns, size_and_rates
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import PIECE, Grid, Normal, Spline
from gbeam.numerics.samples import true_runs
from gbeam.numerics.series import Series, arctan2, power, sin_cos, sqrt, square, where

Pose = tuple[Series, Series, Series]  # ω1, θ2, θ3


@record
class Geometry:
    """The machine as an inverse knows it."""

    arm: Any  # R, m
    gravity: float = static()  # γ, m/s²: 9.80665 if the target is specific force, else 0
    sign: Any = 1.0  # +1 or −1: which of the two mountings of the specimen in the gimbals


class Inverse(ABC):
    """Axis motion for a target.

    Each says what it aims at. `within` is the largest tracking error as a fraction of the load where the target is the
    flight's, infinite where the inverse aims at nothing. `unless` tells why the error may be larger, and what helps.
    """

    within: ClassVar[float]
    unless: ClassVar[str]

    @property
    def extent(self) -> tuple[float, float] | None:
        """First and last time of a motion that has its own beginning and end, s, or None where they are to be added."""
        return None

    @abstractmethod
    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s), with derivatives up to `order`."""


def speed(load: Series, geometry: Geometry) -> Series:
    """Rate of axis 1 whose centripetal acceleration is the horizontal load: ω1 = sqrt(H/R), H² = f² − γ²."""
    return power((square(load) - geometry.gravity**2) / geometry.arm**2, 0.25)


def across_beam(load: Series, geometry: Geometry) -> Series:
    """B2 = ±sqrt(f_y² + f_z² − γ²), the horizontal part of a load (..., 3) m/s² across the beam,
    or zero where none is.
    """
    horizontal2 = square(load[..., 1:]) - geometry.gravity**2
    bent = horizontal2.value > 0
    return where(bent, geometry.sign * sqrt(where(bent, horizontal2, 1.0)), 0.0)


def gimbals(load: Series, lag: Series | float, geometry: Geometry) -> tuple[Series, Series]:
    """Angles of axes 2 and 3, rad, at which the specimen feels a load (..., 3), m/s².

    Axis 2 lags by `lag`, rad. θ3 is zero where the load lies along the beam.
    """
    fx, fy, fz = load[..., 0], load[..., 1], load[..., 2]
    lateral_load = across_beam(load, geometry)
    has_across = lateral_load.value != 0
    xp = namespace(lateral_load.value)
    safe_across = where(has_across, lateral_load, xp.ones_like(lateral_load.value))
    gravity = Series.from_derivatives([geometry.gravity + 0.0 * lateral_load.value], lateral_load.order)
    safe_fy, safe_fz = where(has_across, fy, safe_across.value), where(has_across, fz, gravity.value)
    roll = arctan2(gravity, safe_across) - arctan2(safe_fz, safe_fy)
    return math.pi - lag - arctan2(lateral_load, fx), roll


@record
class QuasiStatic(Inverse):
    """The arm's tangential acceleration is ignored: an error of R dω1/dt square to the load."""

    within: ClassVar[float] = math.inf
    unless: ClassVar[str] = ""
    geometry: Geometry

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        load = target.series(t, order)
        return speed(load, self.geometry), *gimbals(load, 0.0, self.geometry)


@record
class Flat(Inverse):
    """Yaw by δ = atan((dω1/dt)/ω1²) keeps the load's horizontal direction. Its size is high by about δ²/2."""

    within: ClassVar[float] = math.inf
    unless: ClassVar[str] = ""
    geometry: Geometry

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        load = target.series(t, order + 1)
        rate = speed(load, self.geometry)
        lag = arctan2(rate.rate(), rate * rate)
        return rate.truncated(order), *gimbals(load.truncated(order), lag, self.geometry)


# Of the horizontal load: refined until this is reached. The third derivative of a rounded record jumps wherever a knot
# enters the kernel, and the collocation is of third order there; on a smooth load it is far better.
TRACKING = 1e-7
ACCEPTED = 2e-2  # what is still a solution, with a warning
_LEFT_OUT = 1e-2  # where the first steps miss more, a return above idle is left out
_STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4)  # s between knots
_FIRST = 2  # of these show where the load cannot be followed
_MOST = 60_000  # pieces
_NEAR, _CLOSE = 1e-6, 1e-10  # rad: largest change of the lag in a step that is taken whole, and in the last one
_POINTS = np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])
_SMOOTH = 1e-4  # weight of the third derivative at the ends: of all solutions there it picks the one without a layer


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
        load, lag = target.series(t, order), self.lag.series(t, order)[..., 0]
        horizontal = sqrt(square(load) - self.geometry.gravity**2)
        rate = sqrt(horizontal / self.geometry.arm * sin_cos(lag)[1])
        return rate, *gimbals(load, lag, self.geometry)


def exact(target: Target, geometry: Geometry) -> Exact:
    """Solve for the lag on finer and finer knots, until the load is tracked within :data:`TRACKING`.

    Raises InputError if the finest knots still miss by more than :data:`ACCEPTED`.
    """
    first, last = _times(target)
    lag: Spline | None = None
    for step in _STEPS:
        if lag is not None and (last - first) / step > _MOST:
            break
        grid = Grid(first, last, step, _POINTS)
        lag, errors = _solve(grid, target, geometry, lag)
        error = float(errors.max())
        if error <= TRACKING:
            break
    assert lag is not None
    if not error <= ACCEPTED:
        raise _refusal(target, geometry, grid, errors)
    return Exact(geometry, lag)


def unfollowable(target: Target, geometry: Geometry) -> list[tuple[float, float]]:
    """Stretches, first and last time, s, in which the load returns above idle and no smooth motion follows it.

    A target with idle can leave them out, except the one with the largest load, which is never listed.
    """
    if not target.idle > 0:
        return []
    lag: Spline | None = None
    for step in _STEPS[:_FIRST]:
        grid = Grid(*_times(target), step, _POINTS)
        lag, errors = _solve(grid, target, geometry, lag)
    bad, followed = ~(errors.ravel() <= _LEFT_OUT), ~np.asarray(target.not_followed(grid.time))
    size = np.linalg.norm(target.flight(np.clip(grid.time, *target.span)), axis=1)
    peak = int(np.argmax(size))
    stretches = []
    for run in true_runs(size > PARTED * float(target.idle)):
        has_peak = run.start <= peak < run.stop
        if bad[run].any() and followed[run].any() and not has_peak:
            stretches.append((float(grid.time[run.start]), float(grid.time[run.stop - 1])))
    return stretches


def _times(target: Target) -> tuple[float, float]:
    """Times at which the target may change, s: a corner at an end of the span is rounded within half a width."""
    return target.span[0] - float(target.half_width), target.span[1] + float(target.half_width)


def _solve(grid: Grid, target: Target, geometry: Geometry, start: Spline | None) -> tuple[Spline, Floats]:
    """Spline of the lag, rad, by Gauss-Newton from a coarser solution or None, and the tracking error at collocation
    points (pieces, points) as a share of the horizontal load.
    """
    shape = grid.pieces, _POINTS.size
    size, rate, _ = (x.reshape(shape) for x in size_and_rates(target.load, geometry.gravity, grid.time))
    a, growth = size / float(geometry.arm), rate / size
    value, slope = grid.rows(0), grid.rows(1)
    # Without a coarser solution, the slow one to first order, which is flat's.
    guess = np.arctan(growth / (2 * np.sqrt(a))).ravel() if start is None else start(grid.time)[:, 0]
    c = grid.fit(guess[:, None])[:, 0]
    bends = [(piece, _SMOOTH * grid.step**3 * grid.rows(3)[point]) for piece, point in ((0, 0), (-1, -1))]

    def state(c: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """The terms of the equation for the lag, and its residual, at collocation points."""
        windows = np.lib.stride_tricks.sliding_window_view(c, PIECE)
        lag, dlag = np.clip(windows @ value.T, -1.5, 1.5), windows @ slope.T
        sine, cosine = np.sin(lag), np.cos(lag)
        turn = 2 * np.sqrt(a * cosine)
        return sine, cosine, dlag, turn, sine * (dlag + turn) - growth * cosine

    sine, cosine, dlag, turn, residual = state(c)
    for _ in range(40):
        by_lag = cosine * (dlag + turn) - sine**2 * turn / (2 * cosine) + growth * sine
        normal = Normal(grid.pieces)
        normal.add(by_lag[..., None] * value + sine[..., None] * slope, -residual)
        for piece, bend in bends:
            normal.add_row(piece, bend, -float(bend @ (c[:PIECE] if piece == 0 else c[-PIECE:])))
        try:
            move = normal.solve(1e-13)
        except np.linalg.LinAlgError:
            return grid.spline(c[:, None]), np.full_like(residual, np.inf)
        largest = np.abs(move).max()
        # Far from the solution a whole step may leave the range of the lag; near to it rounding decides what gains.
        for share in (1.0, 0.5, 0.25, 0.1) if largest > _NEAR else (1.0,):
            tried = state(c + share * move)
            if np.sum(tried[-1] ** 2) < np.sum(residual**2) * (1 + 1e-9):
                break
        c = c + share * move
        sine, cosine, dlag, turn, residual = tried
        if largest < _CLOSE:
            break
    # |R dω1/dt − a sin δ| / a
    return grid.spline(c[:, None]), np.asarray(np.abs(residual) / turn)


def _refusal(target: Target, geometry: Geometry, grid: Grid, errors: Floats) -> InputError:
    """The error of a load that turns too sharply: it names the worst time and, if any is enough, the smoothing."""
    turns = sharp_turns(target, float(geometry.arm))
    if not turns:
        error_time = grid.time[int(np.argmax(np.where(np.isfinite(errors), errors, 0.0).ravel()))]
        problem = f"is too small for the exact inverse: no smooth motion follows the load about {error_time:.3f} s"
        return InputError("smoothing", problem, 'give more, or inverse = "planned" or "flat"')
    worst_turn = max((turn for turn, _ in turns), key=lambda turn: turn.reference / turn.possible)
    widths = [width for _, width in turns if width is not None]
    wider = f'give "{np.ceil(1e3 * max(widths)):.0f} ms" or more, or ' if len(widths) == len(turns) else "give "
    return InputError(
        "smoothing",
        f"is too small for the exact inverse: about {worst_turn.time:.3f} s the load turns by "
        f"−ä = {worst_turn.reference:.3g} m/s^4 "
        f"and the arm allows a²/R = {worst_turn.possible:.3g} m/s^4",
        f'{wider}inverse = "planned" or "flat"',
    )
