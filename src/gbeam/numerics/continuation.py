"""Curves of equilibria as a parameter varies, followed by arc length beyond limit points (Riks 1979; Crisfield 1981).

The equations are r(y, v) = 0 for coordinates y and a parameter v. Length along a curve is that of y alone, in a metric
W. Where v turns back the curve has a limit point: K = ∂r/∂y is singular there, but K with ∂r/∂v beside it and the
curve's direction below is not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError

ITERATIONS = 24  # of Newton's method at a point
CLOSE = 1e-8  # of the curve's size: a smaller correction is none
SHRINKS = 0.2  # of a correction: where the next is larger than that, the slopes are computed anew
SHORTEST = 1e-6  # of the first step
LOCATED = 1e-7  # of a step: tolerance of a point that is searched for


class CurvePoint(NamedTuple):
    """Point of a curve: y (n,) and v, their derivatives by the length along the curve, this length, and K and ∂r/∂v."""

    y: Floats
    value: float
    course: Floats
    rate: float
    length: float
    slopes: tuple[Floats, Floats]


@dataclass(frozen=True)
class Curve:
    """Equations r(y, v) = 0 (n,), their `slopes` K (n, n) and ∂r/∂v (n,), and the metric W (n, n) of coordinates.

    `reach` is a value of the parameter that counts as large. A step along the tangent that ends farther from the curve
    than a share `bent` of its size is shortened.
    """

    residual: Callable[[Floats, float], Floats]
    slopes: Callable[[Floats, float], tuple[Floats, Floats]]
    metric: Floats
    reach: float
    bent: float

    def begin(self, y: Floats, value: float, *, forward: bool = True) -> CurvePoint:
        """Point at coordinates y, a solution, from which the parameter grows, or falls where not `forward`."""
        k, pull = self.slopes(y, value)
        try:
            course: Floats = np.asarray(np.linalg.solve(k, -pull), dtype=float)
        except np.linalg.LinAlgError:
            raise ComputationError("no equilibrium", "something is free to move: hold it") from None
        size = self._size(course)
        if not size > 0:
            raise ComputationError(
                "not converged", "what grows moves nothing: critical-speed says where stability is lost"
            )
        sign = 1.0 if forward else -1.0
        return CurvePoint(y, value, sign * course / size, sign / size, 0.0, (k, pull))

    def ahead(self, point: CurvePoint, step: float) -> CurvePoint | None:
        """Point of the curve in the plane across its tangent a step ahead; None where there is none nearby."""
        across = self.metric @ point.course
        y, value = point.y + step * point.course, point.value + step * point.rate
        slopes, before = point.slopes, np.inf
        for _ in range(ITERATIONS):
            gap = across @ (y - point.y) - step
            change = _solved(slopes, across, -np.append(self.residual(y, value), gap))
            if not np.isfinite(change).all():
                return None
            size = self._size(change[:-1]) / step
            if size > SHRINKS * before:
                slopes, before = self.slopes(y, value), np.inf
                continue
            y, value, before = y + change[:-1], value + float(change[-1]), size
            if size <= CLOSE and abs(change[-1]) <= CLOSE * self.reach:
                return self._passed(point, across, y, value)
        return None

    def _passed(self, point: CurvePoint, across: Floats, y: Floats, value: float) -> CurvePoint:
        """Point at coordinates of the curve, behind another one."""
        slopes = self.slopes(y, value)
        tangent = _solved(slopes, across, np.append(0 * y, 1.0))
        size = self._size(tangent[:-1])
        length = point.length + self._size(y - point.y)
        return CurvePoint(y, value, tangent[:-1] / size, float(tangent[-1]) / size, length, slopes)

    def follow(self, first: CurvePoint, step: float) -> Iterator[CurvePoint]:
        """Points of the curve from the first on, as far apart as its bends let them be; ComputationError where it
        ends.
        """
        point, shortest = first, SHORTEST * step
        yield first
        while True:
            following = self.ahead(point, step)
            departure = np.inf
            if following is not None:
                aside = self._size(following.y - point.y - step * point.course)
                extent = self._size(following.y - first.y)
                departure = aside / extent + abs(following.value - point.value - step * point.rate) / self.reach
            if following is not None and departure <= self.bent:
                point = following
                yield point
            elif step <= shortest:
                raise ComputationError("not converged", f"the curve was not followed beyond {point.value:.4g}")
            # The departure grows with the square of the step.
            step *= float(np.clip(np.sqrt(self.bent / 2 / max(departure, 1e-12)), 0.25, 2.0))

    def interpolated(
        self, point: CurvePoint, following: CurvePoint, measure: Callable[[CurvePoint], float]
    ) -> CurvePoint:
        """Point between two at which a measure is zero, whose signs at the two differ, on the cubic through both.

        At a branch point equations are singular also with the curve's direction below, and a correction is lost.
        """
        from scipy.interpolate import CubicHermiteSpline
        from scipy.optimize import brentq

        ends = point, following
        values, slopes = (
            np.stack([np.append(end.y, end.value) for end in ends]),
            np.stack([np.append(end.course, end.rate) for end in ends]),
        )
        cubic = CubicHermiteSpline([end.length for end in ends], values, slopes)
        course = cubic.derivative()

        def at(length: float) -> CurvePoint:
            """Point of the cubic."""
            both, slope = cubic(length), course(length)
            return CurvePoint(both[:-1], float(both[-1]), slope[:-1], float(slope[-1]), length, point.slopes)

        return at(brentq(lambda length: measure(at(length)), point.length, following.length, rtol=LOCATED))

    def between(self, point: CurvePoint, following: CurvePoint, measure: Callable[[CurvePoint], float]) -> CurvePoint:
        """Point between two at which a measure is zero, whose signs at the two differ, by Brent's method."""
        from scipy.optimize import brentq

        span = float(self.metric @ point.course @ (following.y - point.y))
        ends = {0.0: point, span: following}

        def measured(step: float) -> float:
            """The measure a step ahead of the first point."""
            tried = ends.get(step) or self.ahead(point, step)
            if tried is None:
                raise ComputationError("not converged", f"the curve was lost near {point.value:.4g}")
            return measure(tried)

        step = brentq(measured, 0.0, span, xtol=LOCATED * span, rtol=LOCATED)
        return self.ahead(point, step) or following

    def _size(self, y: Floats) -> float:
        """Length of a vector of coordinates (n,)."""
        return float(np.sqrt(y @ self.metric @ y))


def _solved(slopes: tuple[Floats, Floats], across: Floats, right: Floats) -> Floats:
    """Solution (n + 1,) of K and ∂r/∂v with the row `across` (n,) below; NaN where they are singular."""
    k, pull = slopes
    try:
        solution: Floats = np.linalg.solve(np.block([[k, pull[:, None]], [across, np.zeros(1)]]), right)
    except np.linalg.LinAlgError:
        return np.nan * right
    return solution
