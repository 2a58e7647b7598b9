"""What a centrifuge does and what it cannot: frozen records of its axes, its limits and its commands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Flags, Floats, Part


@dataclass(frozen=True)
class LimitUse:
    """How much of one of its limits a machine uses.

    Parameters
    ----------
    axis : str
        axis 1, axis 2, axis 3 or arm.
    quantity : str
        rate, acceleration, jerk or power.
    unit : str
        Of `used` and `allowed`.
    used : float
        Largest size.
    allowed : float
        Infinite where no limit is given.
    time : float
        When it is used, s.
    """

    axis: str
    quantity: str
    unit: str
    used: float
    allowed: float
    time: float

    @property
    def share(self) -> float:
        """Used over allowed; zero where no limit is given."""
        return self.used / self.allowed

    @property
    def exceeded(self) -> bool:
        """Whether more is used than allowed, beyond rounding."""
        return self.share > 1 + 1e-9

    def __str__(self) -> str:
        return (
            f"{self.axis} {self.quantity} {self.used:.4g} of {self.allowed:.4g} {self.unit} ({self.share:.0%}) "
            f"at {self.time:.3f} s"
        )


@dataclass(frozen=True)
class Shortfall:
    """A stretch of time in which a machine cannot make the load of the flight.

    Parameters
    ----------
    start, end : float
        s.
    reason : str
        below idle, below gravity, across below gravity, too sharp for the arm.
    time : float
        When it is worst, s.
    reference, possible : float
        At that time: the flight's load, and the nearest that the machine can make.
    unit : str
        Of both; m/s^4 where the load's second derivative is what cannot be made.
    remedy : str
        The smallest change that would make it reachable.
    """

    start: float
    end: float
    reason: str
    time: float
    reference: float
    possible: float
    unit: str
    remedy: str

    def __str__(self) -> str:
        if self.unit == "m/s^4":  # it may yet be made: axis 2 pays for it
            return f"corner at {self.time:.2f} s too sharp for the arm: axis 2 jerks; {self.remedy}"
        return (
            f"{self.start:.3f} to {self.end:.3f} s: {self.reason}, {self.reference:.3g} {self.unit} "
            f"at {self.time:.3f} s where {self.possible:.3g} {self.unit} can be made; {self.remedy}"
        )


@dataclass(frozen=True, repr=False, eq=False)
class AxesResult(Part):
    """A three-axis centrifuge over time.

    Parameters
    ----------
    angle, rate, acceleration : (t, 3)
        Of axes 1, 2, 3; rad, rad/s, rad/s².
    reference, actual : (t, 3)
        Load at the control point, base axes, m/s²: the target, and what the axes make.
    not_followed : (t,) bool
        Where the target is not the flight's load, spin-up and spin-down among them.
    episodes : tuple of (start s, end s, reason)
        The stretches of the flight's time in which it is not.
    limits : tuple of LimitUse
        Rate, acceleration and jerk of every axis, used and allowed.
    shortfalls : tuple of Shortfall
        Where the machine cannot make the flight's load, by how much, and what would help.
    control_point : float
        From the root along the beam, m.
    warnings : tuple of str
        Where the inverse does not keep what it promises, by how much and why.
    idle : float
        Least load that the target is held up to, m/s²; zero where there is none.
    jerk : (t, 3) or None
        Of axes 1, 2, 3, rad/s³.
    span : tuple of float
        First and last time of the flight, s; before it the machine spins up, and after it it spins down.
    start : str
        How the machine begins: rest, pre-yawed or idle.
    flight : (t, 3) or None
        The flight's own load, base axes, m/s², which the target rounds off; before and after the flight that of its
        first and last time.
    """

    angle: Floats
    rate: Floats
    acceleration: Floats
    reference: Floats
    actual: Floats
    not_followed: Flags
    episodes: tuple[tuple[float, float, str], ...]
    limits: tuple[LimitUse, ...] = ()
    shortfalls: tuple[Shortfall, ...] = ()
    control_point: float = math.nan
    warnings: tuple[str, ...] = ()
    idle: float = 0.0
    jerk: Floats | None = None
    span: tuple[float, float] = (-math.inf, math.inf)
    start: str = "idle"
    flight: Floats | None = None

    @property
    def within_limits(self) -> bool:
        """Whether no limit of the machine is exceeded."""
        return not any(use.exceeded for use in self.limits)

    @property
    def exceeding(self) -> str:
        """The limits that are exceeded, by how much and when; empty where none is."""
        broken = [str(use) for use in self.limits if use.exceeded]
        return f"exceeds {'; '.join(broken)}" if broken else ""

    @property
    def limit_shares(self) -> dict[str, Floats]:
        """Share of each limit that is given used over time, (t,), by axis and quantity: ``axis 2 jerk``."""
        histories = {"rate": self.rate, "acceleration": self.acceleration, "jerk": self.jerk}
        shares = {}
        for use in self.limits:
            if not math.isfinite(use.allowed):
                continue
            if use.quantity == "power":  # its constant, the arm's inertia, follows from the largest
                used = np.abs(self.rate[:, 0] * self.acceleration[:, 0])
                used = used * (use.used / max(float(used.max()), 1e-300))
            else:
                history = histories[use.quantity]
                if history is None:
                    continue
                used = np.abs(history[:, int(use.axis[-1]) - 1])
            shares[f"{use.axis} {use.quantity}"] = used / use.allowed
        return shares

    @property
    def tracking_error(self) -> Floats:
        """Size of actual − reference, (t,) m/s²."""
        return np.asarray(np.linalg.norm(self.actual - self.reference, axis=1))


@dataclass(frozen=True, repr=False, eq=False)
class Commands(Part):
    """The axis motions at a controller's sample time.

    Parameters
    ----------
    sample : float
        s.
    time : (t,) s
    angle, rate, acceleration : (t, 3)
        Of axes 1, 2, 3; rad, rad/s, rad/s².
    """

    sample: float
    time: Floats
    angle: Floats
    rate: Floats
    acceleration: Floats
