"""Protocol of profiles: a quantity prescribed over time, with its derivatives; its smoothing by a Hann kernel."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cache, partial
from math import factorial, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_jax, namespace
from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats
from gbeam.guards.arguments import typed, typed_methods
from gbeam.guards.checks import positive
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.guards.quantities import Seconds, Times
from gbeam.numerics.series import Series, compose, where

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary


_FOR_EVER = 1e12  # s: knots no nearer than a profile needs them
TOGETHER = 1_000_000  # knots or nodes of the windows around some times: what more would take comes piece by piece
STEPS_PER_EVENT = 4  # a rounded corner or a pulse of so many steps is resolved


@typed_methods
class Profile(ABC):
    """A scalar or vector given over time, with its time derivatives in closed form.

    NumPy arrays in, NumPy arrays out. JAX arrays and tracers pass, in the times as in the profile's own values, which
    are the leaves of a pytree. So profiles can be traced, mapped and differentiated with respect to them.
    """

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        typed_methods(cls)

    @abstractmethod
    def series(self, t: Times, order: int) -> Series:
        """Value and time derivatives up to `order` at times `t` (s): of the shape of `t`, with a last 3 for a vector.

        Where a derivative jumps, it is the one from the right.
        """

    def __call__(self, t: Times) -> Any:
        """Value at times `t` (s, any shape): of the shape of `t`, with a trailing 3 for a vector."""
        return self.series(t, 0).value

    def derivatives(self, t: Times, order: int = 1) -> tuple[Any, ...]:
        """Value and time derivatives up to `order` at times `t` (s), each like the value."""
        return self.series(t, order).derivatives()

    def integral(self, t: Times) -> Any | None:
        """Integral over time up to times `t` (s), but for a constant, or None where it has no closed form here."""
        return None

    @property
    @abstractmethod
    def breaks(self) -> Any:
        """Times (s, ascending) at which a derivative jumps, shape (b,), or empty if the third is continuous."""

    def corners(self, step: Seconds) -> Floats:
        """Times (s, ascending) that steps of length `step` (s) should not pass unseen. Breaks are among them."""
        return np.asarray(self.breaks, dtype=np.float64)

    @abstractmethod
    def knots(self, step: Seconds) -> Floats:
        """Times (s, ascending) between which the profile is straight, or which are `step` apart at most."""

    @property
    def record(self) -> RecordSummary | None:
        """The flight's record that it is, perhaps with its corners rounded, or None of any other profile."""
        return None

    @property
    def extent(self) -> tuple[float, float] | None:
        """First and last time of what it prescribes, s, whatever rounds its corners, or None if it is constant."""
        times = self.knots(_FOR_EVER)
        return (float(times[0]), float(times[-1])) if times.size > 1 else None

    def smoothed(self, width: Times) -> Profile:
        """The profile convolved with the Hann kernel (1 + cos 2πt/W)/W on abs(t) < W/2, W = `width` s.

        By quadrature, but for profiles that know a better way.
        """

        return Convolved(self, width)


@typed
def smoothed(profile: Profile, width: Times) -> Profile:
    """Round the corners of a profile: its convolution with a Hann kernel, three times differentiable.

    Parameters
    ----------
    profile : Profile
    width : float
        Full width W of the kernel (1 + cos 2πt/W)/W, s.

    Returns
    -------
    Profile
        Of the same unit and shape; equal to `profile` where that is straight within W/2 either side.

    Raises
    ------
    InputError
        If the width is not positive and finite.

    Examples
    --------
    >>> ramp = gb.smoothed(gb.trapezoid(50.0, jerk=25.0, hold=2.0), width=0.2)
    >>> print(f"{ramp.derivatives(0.0, 0)[0]:.4f}")
    0.3717
    """
    return profile.smoothed(positive("smoothing", width, "s"))


def rounded_corners(corners: Any, width: float, step: float) -> Floats:
    """Corners, s, that steps must not miss if a kernel rounds them, at least a quarter of its `width` apart.

    There are none if steps of length `step` resolve the width.
    """
    spacing, times = float(width) / STEPS_PER_EVENT, np.asarray(corners, dtype=np.float64)
    if spacing >= step or not times.size:
        return times[:0]
    return np.asarray(times[0] + spacing * np.unique(np.round((times - times[0]) / spacing)))


def sampled(start: float, end: float, step: float) -> Floats:
    """Evenly spaced times from `start` to `end`, s, no further apart than `step`; InputError if they are too many."""
    count = np.ceil((end - start) / step)
    fix = f"give {KNOTS * step:.3g} s or less, or smooth over more time"
    refuse_more("", f"knots over {end - start:.4g} s", count, KNOTS, 4000.0, fix)
    return np.linspace(start, end, int(count) + 1)


class Rounded(Profile):
    """A profile convolved with a kernel of some width, s, whose times are those of the sharp one."""

    width: Any

    @property
    @abstractmethod
    def sharp(self) -> Profile:
        """The profile that is rounded."""

    @property
    def breaks(self) -> Any:
        """None: the third derivative is continuous."""
        return self.sharp.breaks[:0]

    def corners(self, step: Seconds) -> Floats:
        """Corners of the sharp profile, s, where steps are long beside the width."""
        return rounded_corners(self.sharp.corners(step), self.width, step)

    def knots(self, step: Seconds) -> Floats:
        """Times, s, no further apart than `step` within half a width of the sharp profile's knots."""
        half, inner = float(self.width) / 2, self.sharp.knots(step)
        return sampled(float(inner[0]) - half, float(inner[-1]) + half, step)

    @property
    def record(self) -> RecordSummary | None:
        return self.sharp.record

    @property
    def extent(self) -> tuple[float, float] | None:
        return self.sharp.extent


TURN = 2 * pi


def hann(order: int, x: Any) -> Any:
    """Return the `order`-th derivative of the rounded ramp of unit width at `x`.

    The rounded ramp is max(x, 0) convolved with the Hann kernel k(x) = 1 + cos 2πx on abs(x) < 1/2, whose integral is
    one: zero below −1/2, x above 1/2, three times continuously differentiable. Order 1 is the rounded step x + 1/2 +
    sin(2πx)/2π, order 2 the kernel itself, order 3 its continuous derivative.
    """
    x = as_array(x)
    return _differentiable()(order, x) if is_jax(x) else hann_orders(order, order, x)[0]


def hann_orders(first: int, last: int, x: Any) -> list[Any]:
    """The derivatives of orders `first` to `last` at `x`, which share their sine and cosine."""
    if is_jax(x):
        return [hann(order, x) for order in range(first, last + 1)]  # its compiler shares them
    return _orders(np, first, last, x)


def _orders(xp: Any, first: int, last: int, x: Any) -> list[Any]:
    """Derivatives of the rounded ramp as :func:`hann_orders`, by the array library `xp`."""
    u = xp.clip(x, -0.5, 0.5)
    orders = range(first, last + 1)
    # Orders 0 and 2 need no sine, order 1 no cosine.
    # At the ends, where a half turn is rounded, the sine is nothing.
    sine = xp.where(xp.abs(u) < 0.5, xp.sin(TURN * u), 0.0) if 1 in orders or last > 2 else 0.0
    cosine = xp.cos(TURN * u) if (first, last) != (1, 1) else 0.0
    inside = xp.abs(x) < 0.5 if last > 2 else True
    values = []
    for order in orders:
        match order:
            case 0:
                value = (u + 0.5) ** 2 / 2 - (1 + cosine) / TURN**2 + xp.maximum(x - 0.5, 0.0)
            case 1:
                value = u + 0.5 + sine / TURN
            case 2:
                value = 1 + cosine
            case _:
                sign = 1.0 if order % 4 in (1, 2) else -1.0
                value = xp.where(inside, sign * TURN ** (order - 2) * (cosine, sine)[order % 2], 0.0)
        values.append(value)
    return values


@cache
def _differentiable() -> Any:
    """`hann` for JAX: the derivative of one order is the next."""
    import jax
    import jax.numpy as jnp

    import gbeam.arrays.jax_setup  # noqa: F401

    @partial(jax.custom_jvp, nondiff_argnums=(0,))
    def ramp(order: int, x: Any) -> Any:
        return _orders(jnp, order, order, x)[0]

    @ramp.defjvp
    def _(order: int, primals: Any, tangents: Any) -> Any:
        (x,), (dx,) = primals, tangents
        return ramp(order, x), ramp(order + 1, x) * dx

    return ramp


def soft_floor(value: Any, floor: Any, band: Any) -> Any:
    """Return a three times differentiable max(value, floor)."""
    x = (value - floor) / band
    ramp = compose(hann_orders(0, x.order, x.value), x) if isinstance(x, Series) else hann(0, x)
    return ramp * band + floor


def soft_step(value: Series, middle: Any, band: Any) -> Series:
    """Return a twice differentiable step from 0 to 1."""
    x = (value - middle) / band
    # Beyond half a unit the integral of the kernel no longer rises; its rounding there is no step.
    return where(x.value <= -0.5, 0.0, where(x.value >= 0.5, 1.0, compose(hann_orders(1, 1 + x.order, x.value), x)))


# On one panel the integrand is a smooth curve times one period of a cosine: 20 points leave only rounding.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(20)


@record
class Convolved(Rounded):
    """A profile convolved with the Hann kernel of width W.

    The panels end at the profile's breaks, wherever these lie in the window of abs(σ − t) < W/2, so that each
    integrand is smooth. Their other ends, and so the nodes, move with t: a node is a series of first order in time,
    the integrand one of any order, and the derivatives are as accurate as the value.
    """

    profile: Profile  # analytic between its breaks, with whose number the cost grows
    width: Times  # W

    def __post_init__(self) -> None:
        assign(self, width=as_array(self.width))

    def series(self, t: Times, order: int) -> Series:
        """Values and derivatives at times `t`, s, by Gauss's rule on panels between the breaks in each window."""
        time, breaks, width = as_array(t), self.profile.breaks, self.width
        xp = namespace(time, breaks, width)
        nodes = (breaks.size + 1) * _POINTS.size
        if xp is np and time.ndim == 1 and time.size > 1 and time.size * nodes > TOGETHER:
            return Series.in_pieces(
                lambda piece: self.series(piece, order), time, min(time.size, 1 + time.size * nodes // TOGETHER)
            )
        low, high = time[..., None] - width / 2, time[..., None] + width / 2
        # Panels end at breaks, which stand still, and at the ends of the window, which move with t: at speed one.
        one, is_inside = xp.ones_like(low), (breaks > low) & (breaks < high)
        node, weight = _panels(xp, xp.concatenate([low, xp.clip(breaks, low, high), high], axis=-1))
        speed, widening = _panels(xp, xp.concatenate([one, xp.where(is_inside, 0.0, 1.0), one], axis=-1))
        inner = self.profile.series(node, order)
        axes = inner.value.ndim - node.ndim
        values = Series(tuple(append_axes(speed**k, axes) * c for k, c in enumerate(inner.coefficients)))
        orders = hann_orders(2, 2 + order, (time[..., None] - node) / width)
        kernel = Series(tuple(((1 - speed) / width) ** k * h / factorial(k) for k, h in enumerate(orders)))
        weighted = Series.from_derivatives([weight / width, widening / width], order) * kernel
        return (weighted.map(lambda c: append_axes(c, axes)) * values).map(lambda c: c.sum(axis=time.ndim))

    @property
    def sharp(self) -> Profile:
        return self.profile


def _panels(xp: Any, ends: Any) -> tuple[Any, Any]:
    """Gauss's points and weights of the panels between ends (..., p + 1), along one last axis. Linear in the ends."""
    middle, half = (ends[..., 1:] + ends[..., :-1]) / 2, xp.diff(ends) / 2
    points = middle[..., None] + half[..., None] * _POINTS
    shape = (*ends.shape[:-1], points.shape[-2] * points.shape[-1])
    return points.reshape(shape), (half[..., None] * _WEIGHTS).reshape(shape)


def append_axes(array: Any, axes: int) -> Any:
    """Append `axes` trailing axes of length one."""
    return array.reshape(array.shape + (1,) * axes)
