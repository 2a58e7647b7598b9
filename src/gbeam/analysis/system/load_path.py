"""Equilibria of a system as its loads grow, followed by arc length, and their critical points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.histories import histories
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.rest import held_tree, steady_state
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.tree.system import System
from gbeam.numerics.continuation import Curve, CurvePoint
from gbeam.results.equilibrium import BRANCH_POINT, LIMIT_POINT

FIRST = 0.1  # of the loads that are asked for: the first step, if all goes on as it begins
MOST = 400  # points of a path
END = 1e-9  # of a path, which is as good as none
BENT = 0.01  # share of a path's size by which a step along its tangent may end beside it: it is drawn by straight lines


@dataclass(frozen=True)
class Loading:
    """A system under what is varied of its drives, times a factor, all frozen, from where it rests without that.

    What is varied acts on the bodies in proportion to the factor, where it is above zero.
    """

    system: System
    drive: Drive
    varied: Callable[[Drive, float], Drive]
    start: SteadySystem

    @classmethod
    def of(cls, system: System, drive: Drive, varied: Callable[[Drive, float], Drive]) -> Loading:
        """System under its drives; ComputationError if it does not rest without what is varied."""
        start = steady_state(system, varied(drive, 0.0), held=True)
        if start.accelerated:
            names = " and ".join(motion.coordinate for motion in start.accelerated)
            raise ComputationError("no equilibrium", f"{names} is accelerated: hold it")
        return cls(system, drive, varied, start)

    def point(self, y: Floats, factor: float) -> Point:
        """Point at rest at coordinates y (n,) under loads times a factor."""
        still = np.zeros(len(y))
        tree = held_tree(self.system, self.drive)
        return Point(tree, y, still, still, self.varied(self.drive, factor).inputs(self.system))

    def curve(self, reach: float, bent: float) -> Curve:
        """Curve of its equilibria; lengths are those of the masses' motions."""

        def residual(y: Floats, factor: float) -> Floats:
            """Residual (n,) at rest."""
            point = self.point(y, factor)
            return point.tree(point.y, point.yd, point.ydd, point.inputs)

        def slopes(y: Floats, factor: float) -> tuple[Floats, Floats]:
            """K (n, n), and the derivative (n,) of the residual by the factor."""
            sign = 1.0 if factor >= 0 else -1.0
            remaining, k, _, _ = self.point(y, factor).slopes()
            return k, sign * (residual(y, factor + sign) - remaining)

        return Curve(residual, slopes, self.start.point.slopes()[3], reach, bent)

    def state(self, at: CurvePoint) -> SteadySystem:
        """Steady state at a point of its path."""
        return SteadySystem(self.system, self.varied(self.drive, at.value), self.point(at.y, at.value))

    def places(self, at: Sequence[CurvePoint]) -> Floats:
        """Places (s, p, 3) of the system's points along its path, m, ground axes."""
        places = []
        for one in at:
            point = self.point(one.y, one.value)
            rows = point.y[None], point.yd[None], point.ydd[None]
            places.append(histories(self.system, *rows, point.driven(), inertial=False)[0]["place"][0])
        return np.stack(places)

    def moved(self, at: Sequence[CurvePoint]) -> Floats:
        """Displacements (s, p, 3) of its points along its path from where it rests without loads, m, ground axes."""
        places = self.places(at)
        return places - places[0]


@dataclass(frozen=True)
class FollowedPath:
    """A path that was followed: its points, displacements (s, p, 3) m along it, and the kinds and indices of the points
    where stability is lost or regained.
    """

    loading: Loading
    points: tuple[CurvePoint, ...]
    moved: Floats
    stable: tuple[bool, ...]
    critical: tuple[tuple[str, int], ...]
    ended: str = ""  # why it ends before what was asked for


def follow(
    loading: Loading,
    upper: float,
    left: Callable[[CurvePoint], float],
    report: Callable[[CurvePoint], None],
    bent: float = BENT,
    *,
    beyond: bool = False,
) -> FollowedPath:
    """Follow a path of equilibria until nothing is `left` of it, which falls to zero at its end, or a step `beyond`."""
    curve = loading.curve(upper, bent)
    first = curve.begin(loading.start.point.y, 0.0)
    points, margins, critical, ended = [first], [loading.state(first).margin], list[tuple[str, int]](), ""
    steps = curve.follow(first, FIRST * upper / first.rate)
    next(steps)
    while left(points[-1]) > END:
        if len(points) == MOST:
            ended = f"the path has {MOST} points, and ends at a factor of {points[-1].value:.4g}"
            break
        try:
            following = next(steps)
        except ComputationError:
            ended = f"no equilibrium was found beyond a factor of {points[-1].value:.4g}"
            break
        before = points[-1]
        if left(following) < 0 and not beyond:
            following = curve.between(before, following, left)
        margin = loading.state(following).margin
        critical_point = None
        if before.rate * following.rate < 0:
            critical_point = LIMIT_POINT, curve.between(before, following, lambda at: at.rate)
        elif margins[-1] * margin < 0:
            critical_point = BRANCH_POINT, curve.interpolated(before, following, lambda at: loading.state(at).margin)
        if critical_point is not None:
            kind, at = critical_point
            critical.append((kind, len(points)))
            points.append(at)
            margins.append(0.0)
        points.append(following)
        margins.append(margin)
        report(following)
    stable = tuple(margin > 0 for margin in margins)
    return FollowedPath(loading, tuple(points), loading.moved(points), stable, tuple(critical), ended)
