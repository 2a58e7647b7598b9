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

from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import record
from gbeam.errors import InputError
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.motion.centrifuge.inverses.instant import Geometry, Inverse, Pose, QuasiStatic
from gbeam.motion.centrifuge.inverses.spin_up import Ramp, build_ramps
from gbeam.motion.centrifuge.limits import Ends, Limits
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.bspline import PIECE, Grid, Spline

Floats = NDArray[np.float64]

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
    from gbeam.motion.centrifuge.inverses.axis_splines import AxisSplines, KeptLimits, Tracking, idle_rate
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
