"""Course of a centrifuge from standstill to standstill: its target, and the inverse, by name, solved for it: by
planning all axes as splines, or instant by instant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any, ClassVar, NamedTuple

import numpy as np

from gbeam.arrays.namespace import as_array, is_jax, is_traced, namespace
from gbeam.arrays.tree import record, static
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.motion.centrifuge.inverses.instant import Flat, Geometry, Inverse, Pose, QuasiStatic, exact, unfollowable
from gbeam.motion.centrifuge.inverses.spin_up import Ramp, build_ramps
from gbeam.motion.centrifuge.limits import Ends, Limits
from gbeam.motion.centrifuge.target.build import build_target
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import PIECE, Grid, Spline
from gbeam.numerics.series import where

_COARSE, _FINE, _FINEST = 0.08, 0.02, 0.005  # s between knots: at first; at most; at least
_GAIN = 0.15  # of the cost above its bound, that finer knots must bring to go on
_GENTLER = 100.0, 10.0, 1.0  # times the ease: the search begins with gentle motions, whose minima are fewer
_PER_RAMP = 12  # pieces of a spin-up, or of a run without, at least
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
def planned(target: Target, geometry: Geometry, limits: Limits, ends: Ends, ease: float = 1.0) -> Planned:
    """Plan the motion of the axes as splines. Their knots are refined while that lowers the tracking error.

    Gentle motion counts `ease` times its usual weight.

    With `ends.start` ``idle`` the motion begins and ends at the flight's first and last time, with the arm turning at a
    constant rate and the gimbals at rest. Otherwise all is at rest at both ends; with ``pre-yawed`` the search begins
    from another motion.
    """
    # scipy.sparse and the solver take longer to import than most commands to run
    from gbeam.motion.centrifuge.inverses.axis_splines import AxisSplines, KeptLimits, Tracking, idle_rate
    from gbeam.numerics.minimise import minimise, nearest_point

    idle, fastest = idle_rate(target, geometry), float(limits.axes[0, 0])
    if idle > fastest:
        problem = f"needs {idle:.3g} rad/s of axis 1, whose rate is limited to {fastest:.3g} rad/s"
        raise InputError("idle", problem, "give less, or a machine with a longer arm or a faster axis 1")
    ramps = build_ramps(target, QuasiStatic(geometry), geometry, limits, ends)
    begin, end = target.span if ramps is None else (float(ramp.still) for ramp in ramps)
    first, last = target.span
    durations = {"spin_up": first - begin, "": last - first, "spin_down": end - last}
    fix = f"give {KNOTS * _FINE:g} s or less altogether"
    longest = max(durations, key=lambda name: durations[name])
    refuse_more(longest, "knots", (end - begin) / _FINE, KNOTS, 4000.0, fix)
    lengths = [end - begin] if ramps is None else [ramp.length for ramp in ramps]
    step = min(_COARSE, *(length / _PER_RAMP for length in lengths))
    grid = Grid(float(begin), float(end), step, _POINTS)
    c = grid.fit(_guess(grid.time, target, geometry, ramps))
    smallest_error, within_limits = np.inf, False
    while True:
        splines = AxisSplines(grid, standstill=ramps is not None)
        kept_limits = KeptLimits(splines, geometry, limits, target)
        x = splines.unknowns(c)
        feasible = x if within_limits else nearest_point(kept_limits, x)
        if feasible is not None:
            tracking, x = Tracking(splines, geometry, target, ramps), feasible
            for factor in (1.0,) if within_limits else _GENTLER:
                x, cost = minimise(tracking.gentler(factor * ease), kept_limits, x)
            c, gain, smallest_error, within_limits = splines.coefficients(x), smallest_error - cost, cost, True
            if grid.step <= _FINE and gain <= _GAIN * (cost - tracking.bound):
                break
        if grid.step / 2 < _FINEST:
            break
        c, grid = grid.refined(c), grid.halved()
    if not within_limits:
        raise _refusal(limits, ends, ramps)
    return Planned(grid.spline(c))


LESS = 0.1  # of the ease, with which a plan is sought again to tell what its ease makes of a miss


@lru_cache(maxsize=4)
def replan(plan: Planned, target: Target, geometry: Geometry, limits: Limits, ends: Ends, ease: float) -> Planned:
    """Plan again with :data:`LESS` times the weight of gentle motion, from `plan` and on its knots."""
    from gbeam.motion.centrifuge.inverses.axis_splines import AxisSplines, KeptLimits, Tracking
    from gbeam.numerics.minimise import minimise

    ramps = build_ramps(target, QuasiStatic(geometry), geometry, limits, ends)
    grid = Grid(*plan.extent, float(plan.axes.step), _POINTS)
    splines = AxisSplines(grid, standstill=ramps is not None)
    tracking = Tracking(splines, geometry, target, ramps).gentler(LESS * ease)
    unknowns = splines.unknowns(np.asarray(plan.axes.coefficients))
    unknowns, _ = minimise(tracking, KeptLimits(splines, geometry, limits, target), unknowns)
    return Planned(grid.spline(splines.coefficients(unknowns)))


def _guess(time: Floats, target: Target, geometry: Geometry, ramps: tuple[Ramp, Ramp] | None) -> Floats:
    """First guess of a plan (times, 3): the rate of axis 1, rad/s, and the angles of axes 2 and 3, rad, without jumps.

    During the flight they are those of the target's quasi-static motion, before and after it those of the ramps.
    """
    pose = [part.value for part in QuasiStatic(geometry).pose(target.load, np.clip(time, *target.span), 0)]
    for ramp in ramps or ():
        during_ramp = (time - ramp.steady) * (ramp.still - ramp.steady) > 0
        for values, part in zip(pose, ramp.pose(time[during_ramp], 0), strict=True):
            values[during_ramp] = part.value
    rate, *angles = pose
    return np.column_stack([rate, *(np.unwrap(angle) for angle in angles)])


def _refusal(limits: Limits, ends: Ends, ramps: tuple[Ramp, Ramp] | None) -> InputError:
    """The error of a plan that cannot keep the limits: it names the ramp that is too short, or else the limits."""
    for name, ramp in zip(("spin_up", "spin_down"), ramps or (), strict=False):
        duration = getattr(ends, name)
        lacking = ramp.lengthened(limits).length - ramp.length
        if duration is not None and lacking > 0:
            enough = np.ceil(10 * (duration + lacking)) / 10
            problem = f"is {duration:.3g} s: within the limits of axis 1 that is too short for the arm to reach idle"
            return InputError(name, problem, f'give "{enough:g} s" or more, or leave it out')
    return InputError("limits", "leave no motion that keeps idle during the flight", "give less idle, or wider limits")


class Method(NamedTuple):
    """Method by which an inverse is built."""

    # an inverse that plans its own ends says so by its extent
    build: Callable[[Target, Geometry, Limits, Ends, float], Inverse]
    follows_corners: bool  # of a load that does not turn
    solved: bool  # numerically, and so it needs numbers
    # stretches, s, that it cannot follow
    leaves_out: Callable[[Target, Geometry], list[tuple[float, float]]] | None = None
    plans: bool = False  # for any load within the limits, which takes a second: it is done where the motion is needed


INVERSES: dict[str, Method] = {
    "quasi-static": Method(lambda target, geometry, *_: QuasiStatic(geometry), True, False),
    "flat": Method(lambda target, geometry, *_: Flat(geometry), False, False),
    "exact": Method(lambda target, geometry, *_: exact(target, geometry), False, True, unfollowable),
    "planned": Method(planned, True, True, plans=True),
}


@record
class Course:
    """The target over a span, the inverse that :meth:`solved` finds for it, and the spin-up and spin-down."""

    target: Target
    geometry: Geometry
    start: str = static()
    solution: Inverse | None = None
    ramps: tuple[Ramp, Ramp] | None = None

    @property
    def inverse(self) -> Inverse:
        """The inverse solved for the target."""
        assert self.solution is not None
        return self.solution

    def solved(self, inverse: str, limits: Limits, ends: Ends, ease: float = 1.0) -> Course:
        """Course with the axis motions, and how they begin and end."""
        solution = INVERSES[inverse].build(self.target, self.geometry, limits, ends, ease)
        plans_ends = solution.extent is not None
        ramps = None if plans_ends else build_ramps(self.target, solution, self.geometry, limits, ends)
        return replace(self, solution=solution, ramps=ramps)

    @property
    def extent(self) -> tuple[Any, Any]:
        """First and last time of the motion, s: of standstill, or of the flight where the machine begins at idle."""
        if self.ramps is None:
            return self.target.span if self.inverse.extent is None else self.inverse.extent
        ends = tuple(ramp.still for ramp in self.ramps)
        begin, end = ends if is_traced(*ends) else map(float, ends)
        return begin, end

    def derivatives(self, t: Any, order: int) -> tuple[tuple[Any, ...], ...]:
        """Series of the rate of axis 1 and of the angles of axes 2 and 3 at times `t` (s), each up to `order`."""
        return tuple(series.derivatives() for series in self._pose(as_array(t), order))

    def _pose(self, t: Any, order: int) -> Pose:
        """Pose of the axes at times `t`, s: during the ramps that of the ramps, in between that of the inverse."""
        inverse, load = self.inverse, self.target.load
        if self.ramps is None:
            if inverse.extent is not None:  # a plan, which stands still beyond its ends
                t = namespace(t).clip(t, *inverse.extent)
            return inverse.pose(load, t, order)
        first, last = (ramp.steady for ramp in self.ramps)
        ramp_times = list(zip(self.ramps, (t < first, t > last), strict=True))
        for ramp, during_ramp in ramp_times:
            if not is_jax(during_ramp) and np.all(during_ramp):  # what the target costs is spared
                return ramp.pose(t, order)
        pose = inverse.pose(load, namespace(t, first, last).clip(t, first, last), order)
        for ramp, during_ramp in ramp_times:
            if is_jax(during_ramp) or np.any(during_ramp):
                ramp_pose = ramp.pose(t, order)
                rate, yaw, roll = (where(during_ramp, a, b) for a, b in zip(ramp_pose, pose, strict=True))
                pose = rate, yaw, roll
        return pose

    def reference(self, t: Any) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3).

        During the ramps it is the load at the flight's first or last time, with its horizontal part reduced to what the
        arm's rate makes.
        """
        times = as_array(t)
        load = self.target.load(times)
        first, last = self.target.span if self.ramps is None else (ramp.steady for ramp in self.ramps)
        outside = (times < first) | (times > last)
        if self.start == "idle" or not (is_jax(outside) or np.any(outside)):
            return load
        (rate, acceleration), *_ = self.derivatives(times, 1)
        return namespace(load, rate).where(outside[..., None], self._reduced(load, rate, acceleration), load)

    def _reduced(self, load: Any, rate: Any, acceleration: Any) -> Any:
        """Reduce the horizontal part of a load (..., 3) to what the arm makes at its rate and acceleration.

        The vertical part is gravity, which stays. The part across the beam keeps its direction.
        """
        xp = namespace(load, rate)
        gravity, across_squared = self.geometry.gravity, xp.sum(load[..., 1:] ** 2, axis=-1)
        horizontal = self.geometry.arm * xp.hypot(rate**2, acceleration if self.start == "pre-yawed" else 0.0)
        horizontal_share = horizontal / xp.sqrt(across_squared + load[..., 0] ** 2 - gravity**2)
        has_across = across_squared > 0
        new_across = xp.sqrt(xp.maximum(across_squared - gravity**2, 0.0) * horizontal_share**2 + gravity**2)
        across_share = xp.where(has_across, new_across / xp.sqrt(xp.where(has_across, across_squared, 1.0)), 0.0)
        return load * xp.stack([horizontal_share, across_share, across_share], axis=-1)


def prepare(
    load: Profile,
    geometry: Geometry,
    limits: Limits,
    *,
    inverse: str,
    ends: Ends,
    idle: Any | None,
    smoothing: Any | None,
    clip: bool,
    span: tuple[float, float],
) -> Course:
    """Build the target of a load over a span, s, and solve for the axis motions, unless they are planned later."""
    build = partial(
        build_target, load, span=span, idle=idle, smoothing=smoothing, gravity=geometry.gravity > 0, arm=geometry.arm,
        clip=clip,
    )  # fmt: skip
    target = build()
    method = INVERSES[inverse]
    if not target.rounded and not method.plans and (target.turns or not method.follows_corners):
        raise InputError("smoothing", f"is missing: {inverse} cannot follow this load's corners", 'give "60 ms" or so')
    if method.solved and is_traced(target.load(span[0]), geometry.arm):
        fix = 'choose "flat" or "quasi-static", or prepare the machine of numbers: over(start, end)'
        raise InputError("inverse", f"is {inverse}, solved for numerically, and JAX traces the machine", fix)
    left_out: list[tuple[float, float]] = []
    # What cannot be followed is left out of the target, until a target is followed everywhere.
    while method.leaves_out is not None and (stretches := method.leaves_out(target, geometry)):
        left_out += stretches
        target = build(leave_out=left_out)
    course = Course(target, geometry, ends.start)
    return course if method.plans else course.solved(inverse, limits, ends)
