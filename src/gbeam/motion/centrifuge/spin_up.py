"""How a centrifuge gets under way: it turns already, or it spins up from standstill while its target waits.

Over the spin-up the target stands still at the load that it has at the end, f₁ with the horizontal part H₁, and the
arm's rate rises as ω1 = S(s) Ω, Ω = sqrt(H₁/R), s = (t − t₀)/T; S is flat to the fourth order at both ends, so that
angles, rates, accelerations and jerks meet the inverse's. The reference on the way has the direction of f₁ (its
part along the beam and across it rise together; gravity stays) and the size p H₁:

- ``rest``: p = S². The arm's tangential acceleration R dω1/dt is ignored, as quasi-static does: axis 2 stands still.
- ``pre-yawed``: p = sqrt(S⁴ + (S'/ΩT)²) and axis 2 lags by δ = atan2(dω1/dt, ω1²), so that the load has its direction
  and size from the first instant. At standstill all of it is tangential: δ starts at 90°; docs/theory.md, section 8.4.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record, static
from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse, Pose, across_beam, speed
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.series import Series, arctan2, sqrt, square, stack, where

STARTS = ("idle", "rest", "pre-yawed")
# rad of ΩT, from which on p never falls: (ΩT)² >= −S''/2S³ everywhere, with S'' = 2520 s³ (1 − s)³ (1 − 2s).
LEAST_TURNED = 2.982


class Start(ABC):
    """What a start makes of the axis motions of an inverse and of their reference load."""

    @abstractmethod
    def pose(self, inverse: Inverse, target: Profile, t: Any, order: int) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s), with derivatives up to `order`."""

    @abstractmethod
    def load(self, target: Profile, t: Any) -> Any:
        """Reference load at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""


@record
class Turning(Start):
    """The arm turns from the first instant: nothing is changed."""

    def pose(self, inverse: Inverse, target: Profile, t: Any, order: int) -> Pose:
        """The inverse's own."""
        return inverse.pose(target, t, order)

    def load(self, target: Profile, t: Any) -> Any:
        """The target's own."""
        return target(t)


@record
class SpinUp(Start):
    """From standstill to an inverse's motion at a target that waits.

    Parameters
    ----------
    geometry : Geometry
    begin, end : float
        Of the spin-up, s; the target stands still between.
    turned : float
        ΩT, rad: what the arm would turn by at its full rate.
    yawed : bool
        Whether the lag of axis 2 makes up for the tangential acceleration.
    """

    geometry: Geometry
    begin: Any
    end: Any
    turned: Any
    yawed: bool = static()

    def __post_init__(self) -> None:
        assign(self, begin=as_array(self.begin), end=as_array(self.end), turned=as_array(self.turned))

    def pose(self, inverse: Inverse, target: Profile, t: Any, order: int) -> Pose:
        """The inverse's, its rate times S, its angles as the load on the way has them."""
        now = as_array(t)
        s = self._part(now, order)
        rise = _rise(s)
        still = inverse.pose(target, namespace(now, self.end).zeros_like(now) + self.end, 0)
        rate, yaw, roll = inverse.pose(target, now, order)
        # A plan need not stand still: its gimbals fade in. Angles are compared within half a turn.
        yaw, roll = (_faded(rise, angle, rest.value) for angle, rest in zip((yaw, roll), still[1:], strict=True))
        if self.yawed:
            # tan δ = (dω1/dt)/ω1² = S'/(ΩT S²), with the powers of s and 1 − s that both hold taken out.
            lag = math.pi / 2 - arctan2(self.turned * s**6 * _quotient(s) ** 2, 630 * (1 - s) ** 4)
            yaw = yaw - lag
        if self.geometry.gravity:
            across = across_beam(target.series(now, order), self.geometry)
            down = Series.of([self.geometry.gravity + 0.0 * across.value], order)
            roll = roll + arctan2(down, self._share(s) * across) - arctan2(down, across)
        return rise * rate, yaw, roll

    def load(self, target: Profile, t: Any) -> Any:
        """The horizontal part of the target's, p of it, with gravity."""
        now = as_array(t)
        full, share = target.series(now, 0), self._share(self._part(now, 0))
        horizontal = share * across_beam(full, self.geometry)
        gravity = self.geometry.gravity
        # Without gravity the root of a square, which has no derivative at standstill, is the size itself.
        size = sqrt(horizontal * horizontal + gravity**2) if gravity else self.geometry.sign * horizontal
        before2 = square(full[..., 1:])
        before = sqrt(where(before2.value > 0, before2, 1.0))
        return (full * stack([share, size / before, size / before])).value

    def _part(self, t: Any, order: int) -> Series:
        """s, from 0 to 1."""
        s = (Series.variable(t, order) - self.begin) / (self.end - self.begin)
        return where(s.value < 0, 0.0, where(s.value > 1, 1.0, s))

    def _share(self, s: Series) -> Series:
        """p, with s⁴ taken out of the root."""
        if not self.yawed:
            return _rise(s) ** 2
        tangential = 630 * (1 - s) ** 4 / self.turned
        return s**4 * sqrt(s**12 * _quotient(s) ** 4 + tangential**2)


def _faded(rise: Series, angle: Series, rest: Any) -> Series:
    """From an angle at rest to one that moves, by the shorter way round."""
    away = angle - rest
    xp = namespace(away.value)
    return rest + rise * (away - 2 * math.pi * xp.round(away.value / (2 * math.pi)))


def _quotient(s: Series) -> Series:
    """S over s⁵."""
    return 126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4


def _rise(s: Series) -> Series:
    """S = s⁵ (126 − 420 s + 540 s² − 315 s³ + 70 s⁴), S' = 630 s⁴ (1 − s)⁴."""
    return s**5 * _quotient(s)


def build_start(kind: str, target: Target, geometry: Geometry) -> Start:
    """Make the start of a motion.

    Parameters
    ----------
    kind : str
        One of ``STARTS``.
    target : Target
        Built with a `spin_up` unless it is idle.
    geometry : Geometry

    Raises
    ------
    InputError
        If the kind is unknown, the target has no spin-up, or a pre-yawed one so short that the load would overshoot.
    """
    if kind not in STARTS:
        raise InputError("start", f"is {kind!r}", f"choose one of {', '.join(STARTS)}")
    first, ready, width = target.span[0], target.ready, 2 * target.half_width
    if (kind == "idle") != (ready == first):
        raise InputError("spin_up", f"does not go with start = {kind}", "give both start and spin_up, or neither")
    if kind == "idle":
        return Turning()
    end = ready - width  # from there on the target's corner is being rounded
    full = speed(target.load.series(first, 0), geometry).value
    turned, yawed = full * (end - first), kind == "pre-yawed"
    if yawed and not is_traced(turned) and turned < LEAST_TURNED:
        raise InputError(
            "spin_up",
            f"is {ready - first:.3g} s, so short that a pre-yawed start would overshoot its load",
            f'give "{np.ceil(10 * (LEAST_TURNED / full + width)) / 10:g} s" or more, or start = "rest"',
        )
    return SpinUp(geometry, first, end, turned, yawed)
