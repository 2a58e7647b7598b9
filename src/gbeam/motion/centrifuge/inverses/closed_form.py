"""Axis angles that make a given load: the inverse of the three-axis centrifuge (Zhang 2020, corrected).

An inverse maps a target (the reference load at the control point, over time) to the arm's rate and the two gimbal
angles, as series in time, so that their rates come with them. Here are those in closed form; `registry` names all.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any, ClassVar

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.series import Series, arctan2, power, sqrt, square, where

Pose = tuple[Series, Series, Series]  # ω1, θ2, θ3


@record
class Geometry:
    """The machine as an inverse knows it.

    Parameters
    ----------
    arm : float
        R, m.
    gravity : float
        γ, m/s²: 9.80665 if the target is specific force, else 0.
    sign : float
        +1 or −1: which of the two mountings of the specimen in the gimbals.
    """

    arm: Any
    gravity: float = static()
    sign: Any = 1.0


class Inverse(ABC):
    """Axis motion for a target.

    Each says what it promises: `within`, the largest tracking error as a fraction of the load where the target is not
    held (infinite where it promises nothing), and `unless`, why it may be more and what helps.
    """

    within: ClassVar[float]
    unless: ClassVar[str]

    @property
    def extent(self) -> tuple[float, float] | None:
        """First and last time of a motion that has its own beginning and end, s; None where they are to be added."""
        return None

    @abstractmethod
    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s), with derivatives up to `order`."""


def speed(load: Series, geometry: Geometry) -> Series:
    """Rate of axis 1 whose centripetal acceleration is the horizontal load: ω1 = sqrt(H/R), H² = f² − γ²."""
    return power((square(load) - geometry.gravity**2) / geometry.arm**2, 0.25)


def across_beam(load: Series, geometry: Geometry) -> Series:
    """B2 = ±sqrt(f_y² + f_z² − γ²), the horizontal load across the beam, m/s²; zero, with no rates, where it is none.

    `load` (..., 3) m/s².
    """
    horizontal2 = square(load[..., 1:]) - geometry.gravity**2
    bent = horizontal2.value > 0
    return where(bent, geometry.sign * sqrt(where(bent, horizontal2, 1.0)), 0.0)


def gimbals(load: Series, lag: Series | float, geometry: Geometry) -> tuple[Series, Series]:
    """Angles of axes 2 and 3 that put the load where the specimen wants it.

    `load` (..., 3) m/s².

    A load along the beam leaves θ3 open: it is then zero.
    """
    fx, fy, fz = load[..., 0], load[..., 1], load[..., 2]
    across = across_beam(load, geometry)
    bent = across.value != 0
    xp = namespace(across.value)
    ahead = where(bent, across, xp.ones_like(across.value))
    gravity = Series.of([geometry.gravity + 0.0 * across.value], across.order)
    roll = arctan2(gravity, ahead) - arctan2(where(bent, fz, gravity.value), where(bent, fy, ahead.value))
    return math.pi - lag - arctan2(across, fx), roll


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
    """Yaw makes up for the tangential acceleration: δ = atan((dω1/dt)/ω1²).

    The horizontal load has the reference's direction at all times; its size is high by sqrt(1 + tan²δ),
    about δ²/2.
    """

    within: ClassVar[float] = math.inf
    unless: ClassVar[str] = ""
    geometry: Geometry

    def pose(self, target: Profile, t: Any, order: int) -> Pose:
        load = target.series(t, order + 1)
        rate = speed(load, self.geometry)
        lag = arctan2(rate.rate(), rate * rate)
        return rate.truncated(order), *gimbals(load.truncated(order), lag, self.geometry)
