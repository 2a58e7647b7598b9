"""Hann smoothing of a curved profile, by Gauss-Legendre panels split where a derivative jumps."""

from __future__ import annotations

from math import factorial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, record
from gbeam.motion.profiles.hann import hann_orders
from gbeam.motion.profiles.profile import TOGETHER, Profile, rounded_corners, sampled
from gbeam.numerics.series import Series

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary

# On one panel the integrand is a smooth curve times one period of a cosine: 20 points leave only rounding.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(20)


@record
class Convolved(Profile):
    """A profile convolved with the Hann kernel of width W.

    The panels end at the profile's breaks, wherever these lie in the window of abs(σ − t) < W/2, so that each
    integrand is smooth. Their other ends, and so the nodes, move with t: a node is a series of first order in time,
    the integrand one of any order, and the derivatives are as accurate as the value.

    Parameters
    ----------
    profile : Profile
        Analytic between its breaks, and with few of them: the cost grows with their number.
    width : float
        W, s.
    """

    profile: Profile
    width: Any

    def __post_init__(self) -> None:
        assign(self, width=as_array(self.width))

    def series(self, t: Any, order: int) -> Series:
        """Value and derivatives at times `t` (s)."""
        now, breaks, width = as_array(t), self.profile.breaks, self.width
        xp = namespace(now, breaks, width)
        nodes = (breaks.size + 1) * _POINTS.size
        if xp is np and now.ndim == 1 and now.size > 1 and now.size * nodes > TOGETHER:
            return Series.in_pieces(
                lambda some: self.series(some, order), now, min(now.size, 1 + now.size * nodes // TOGETHER)
            )
        low, high = now[..., None] - width / 2, now[..., None] + width / 2
        one, fixed = xp.ones_like(low), (breaks > low) & (breaks < high)
        at, weight = _panels(xp, xp.concatenate([low, xp.clip(breaks, low, high), high], axis=-1))
        speed, widening = _panels(xp, xp.concatenate([one, xp.where(fixed, 0.0, 1.0), one], axis=-1))
        inner = self.profile.series(at, order)
        axes = inner.value.ndim - at.ndim
        values = Series(tuple(beside(speed**k, axes) * c for k, c in enumerate(inner.coefficients)))
        orders = hann_orders(2, 2 + order, (now[..., None] - at) / width)
        kernel = Series(tuple(((1 - speed) / width) ** k * h / factorial(k) for k, h in enumerate(orders)))
        weighted = Series.of([weight / width, widening / width], order) * kernel
        return (weighted.each(lambda c: beside(c, axes)) * values).each(lambda c: c.sum(axis=now.ndim))

    @property
    def breaks(self) -> Any:
        """None: the third derivative is continuous."""
        return self.profile.breaks[:0]

    def corners(self, step: float) -> NDArray[np.float64]:
        """Those of the profile, s, where steps are long beside the width."""
        return rounded_corners(self.profile.corners(step), self.width, step)

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times, s, no further apart than `step` within half a width of the profile's knots."""
        half = float(self.width) / 2
        inner = self.profile.knots(step)
        return sampled(inner[0] - half, inner[-1] + half, step)

    @property
    def record(self) -> RecordSummary | None:
        """That of the profile."""
        return self.profile.record

    @property
    def extent(self) -> tuple[float, float] | None:
        """That of the profile, s."""
        return self.profile.extent

    def smoothed(self, width: Any) -> Profile:
        """Smoothed once more."""
        return Convolved(self, width)


def _panels(xp: Any, ends: Any) -> tuple[Any, Any]:
    """Gauss's points and weights of the panels between ends (..., p + 1), along one last axis; linear in the ends."""
    middle, half = (ends[..., 1:] + ends[..., :-1]) / 2, xp.diff(ends) / 2
    points = middle[..., None] + half[..., None] * _POINTS
    shape = (*ends.shape[:-1], points.shape[-2] * points.shape[-1])
    return points.reshape(shape), (half[..., None] * _WEIGHTS).reshape(shape)


def beside(array: Any, axes: int) -> Any:
    """Append `axes` trailing axes of length one."""
    return array.reshape(array.shape + (1,) * axes)
