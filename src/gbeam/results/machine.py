"""Records of a centrifuge: its axes, its limits and its commands."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gbeam.printable import raised
from gbeam.results.declared import BESIDE, declared, fact, internal, part, rows
from gbeam.results.declared import quantity as entry  # a limit has a field of that name
from gbeam.results.parts import Base
from gbeam.results.result import Flags, Floats, Part

_SAME = 1e-9  # of a dynamic imbalance: less of it is rounding
AxesFigure = Literal["tracking", "axes_rate", "axes_acceleration", "axes_jerk"]


@dataclass(frozen=True)
class LimitUse:
    """Use of one of its limits by a machine."""

    axis: str = entry("", "axis 1, axis 2, axis 3 or arm")
    quantity: str = entry("", "rate, acceleration, jerk or power")
    unit: str = entry("", "unit of both")
    used: float = entry(BESIDE, "largest size")
    allowed: float = entry(BESIDE, "limit", note="infinite where none is given")
    time: float = entry("s", "time of its use")

    @declared("", "used over allowed")
    def share(self) -> float:
        """Used over allowed, or zero where no limit is given."""
        return self.used / self.allowed

    @declared("", "whether more is used than allowed")
    def exceeded(self) -> bool:
        """True if more is used than allowed, beyond rounding."""
        return self.share > 1 + 1e-9

    def __str__(self) -> str:
        share = f"{raised(self.unit)} ({100 * self.share:.0f} %)"
        return f"{self.axis} {self.quantity} {self.used:.4g} of {self.allowed:.4g} {share} at {self.time:.3f} s"


@dataclass(frozen=True)
class Shortfall:
    """A stretch of time in which a machine cannot make the load of the flight."""

    start: float = entry("s", "start of a stretch in which the flight's load cannot be made", name="from")
    end: float = entry("s", "its end", name="to")
    reason: str = entry("", "why it cannot", note="below idle, below gravity, across below gravity, too sharp")
    time: float = entry("s", "when it is worst")
    reference: float = entry(BESIDE, "load of the flight then")
    possible: float = entry(BESIDE, "the nearest that the machine can make then")
    unit: str = entry("", "unit of reference and possible", note="m/s^4 of a load's second derivative")
    remedy: str = entry("", "smallest change that would help")

    def __str__(self) -> str:
        if self.unit == "m/s^4":  # it may yet be made: axis 2 pays for it
            return f"corner at {self.time:.2f} s too sharp for the arm: axis 2 jerks; {self.remedy}"
        return (
            f"{self.start:.3f} to {self.end:.3f} s: {self.reason}, {self.reference:.3g} {self.unit} "
            f"at {self.time:.3f} s where {self.possible:.3g} {self.unit} can be made; {self.remedy}"
        )


@dataclass(frozen=True, repr=False, eq=False)
class Departure(Part):
    """A stretch in which the target is not the flight's load."""

    start: float = entry("s", "start of a stretch in which the target is not the flight's load", name="from")
    end: float = entry("s", "its end", name="to")
    reason: str = entry("", "why it is not")


@dataclass(frozen=True, repr=False, eq=False)
class AxesResult(Part):
    """A three-axis centrifuge over time."""

    angle: Floats = entry("rad", "angle of the centrifuge's axes", "time machine_axis", name="axis_angle")
    rate: Floats = entry("rad/s", "rate of the centrifuge's axes", "time machine_axis", name="axis_rate")
    acceleration: Floats = entry(
        "rad/s^2", "acceleration of the centrifuge's axes", "time machine_axis", name="axis_acceleration"
    )
    reference: Floats = entry("m/s^2", "load of the target at the control point", "time axis", name="load_reference")
    actual: Floats = entry("m/s^2", "load that the axes make at the control point", "time axis", name="load_actual")
    not_followed: Flags = entry(
        "",
        "whether the target is another than the flight's load",
        "time",
        flags=("flight", "another"),
        note="spin-up and spin-down among them",
    )
    episodes: tuple[tuple[float, float, str], ...] = internal(
        "", "stretches in which it is: start s, end s, reason", "episode"
    )
    limits: tuple[LimitUse, ...] = rows("limits of every axis, used and allowed", "limit", name=None, default=())
    shortfalls: tuple[Shortfall, ...] = rows(
        "where the machine cannot make the flight's load", "shortfall", name="shortfall_", default=()
    )
    control_point: float = entry("m", "control point, from the root along the beam", default=math.nan)
    warnings: tuple[str, ...] = internal("", "where the inverse follows worse than it aims at", "warning", default=())
    idle: float = entry("m/s^2", "least load of the target; 0 where there is none", key=None, default=0.0)
    jerk: Floats | None = entry(
        "rad/s^3", "jerk of the centrifuge's axes", "time machine_axis", name="axis_jerk", default=None
    )
    span: tuple[float, float] = entry(
        "s",
        "time of the flight, between spin-up and spin-down",
        "ends",
        name="flight",
        key=None,
        default=(-math.inf, math.inf),
    )
    start: str = fact("how the machine begins", name=None, note="rest, pre-yawed or idle", default="idle")
    flight: Floats | None = entry(
        "m/s^2",
        "load of the flight itself",
        "time axis",
        name="load_flight",
        note="which the target rounds off; before and after the flight that of its first and last time",
        default=None,
    )
    place: Floats | None = entry(
        "m",
        "control point, from the root, where it lies beside x",
        "axis",
        name="control_place",
        key="control_place",
        default=None,
    )
    arm: float = entry(
        "m", "from axis 1 of the centrifuge to the control point", key=None, optional=True, default=math.nan
    )
    turn: Floats | None = entry(
        "rad", "rotation vector of the specimen in the machine, where it is turned", "axis", name="turn", default=None
    )
    imitated: Imitated | None = internal("", "flight and machine at times of their own", default=None)

    @declared(
        "",
        "stretches in which the target is not the flight's load",
        "episode",
        role="rows",
        name="not_followed_",
        key="not_followed",
    )
    def departures(self) -> tuple[Departure, ...]:
        return tuple(Departure(*episode) for episode in self.episodes)

    @property
    def within_limits(self) -> bool:
        """True if no limit of the machine is exceeded."""
        return not any(use.exceeded for use in self.limits)

    @property
    def exceeding(self) -> str:
        """The limits that are exceeded, by how much and when, or empty where none is."""
        broken = [str(use) for use in self.limits if use.exceeded]
        return f"exceeds {'; '.join(broken)}" if broken else ""

    @property
    def largest_excess(self) -> str:
        """The limit that is exceeded most, and by how much, or empty where none is."""
        use = max((use for use in self.limits if use.exceeded), key=lambda use: use.share, default=None)
        return "" if use is None else f"{use.axis} {use.quantity} {use.share:.0%}".replace("%", " % of its limit")

    @property
    def limit_shares(self) -> dict[str, Floats]:
        """Used share of each finite limit over time, (t,), by axis and quantity: ``axis 2 jerk``."""
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
class Imitated:
    """Motions of a flight and of the machine that imitates it, from the machine's beginning to its end, and its axes.

    Their times are close enough for peaks, and the same for every question. A plan and a response have other steps, and
    yet read the peaks of the load, its errors and the use of limits from them alike.
    """

    time: Floats  # (t,) s
    flight: Base  # at the first and the last time of the flight before it and after it
    machine: Base
    axes: AxesResult | None = None  # of a base that is no centrifuge none


_BOUND, _BEYOND = 0.99, 1.001  # shares of a limit between which the limit holds an axis back


def used_up(shares: Mapping[str, Floats], stretch: slice) -> list[str]:
    """Names of the limits that hold an axis back in a stretch, the longest first, by their used `shares` (t,)."""
    counts = {
        name: int(np.count_nonzero(share[stretch] >= _BOUND))
        for name, share in shares.items()
        if _BOUND <= share[stretch].max() <= _BEYOND
    }
    return sorted(counts, key=lambda name: -counts[name])


@dataclass(frozen=True)
class Peak:
    """Largest size of a history of a rotation about an axis."""

    max_abs: float = entry(BESIDE, "largest size")
    time_of_max: float = entry("s", "its time")


@dataclass(frozen=True)
class AxisPeaks:
    """Largest rate and acceleration of an axis."""

    rate: Peak = part("largest rate", unit="rad/s")
    acceleration: Peak = part("largest acceleration", unit="rad/s^2")


@dataclass(frozen=True)
class Tracking:
    """Largest error of the load while the target is the flight's, or NaN where the load was followed at no time."""

    max: float = entry("m/s^2", "largest error")
    time_of_max: float = entry("s", "its time")
    fraction: float = entry("", "that of the load then")


@dataclass(frozen=True, repr=False, eq=False)
class ArmLevel(Part):
    """Level that a plain arm holds at its control point: the centripetal acceleration there, gravity beside it."""

    level: float = entry("m/s^2", "largest centripetal acceleration at the control point, without gravity")
    radius: float = entry("m", "from the arm's axis to the control point")
    control_point: Floats = entry("m", "control point, from the root", "axis")
    load: Floats = entry("", "direction in which the level accelerates the specimen: towards the arm's axis", "axis")
    up: Floats = entry("", "direction that is up: along the arm's axis", "axis")
    rate: float = entry("rad/s", "largest rate of the arm")
    onset: float = entry("m/s^3", "largest rate at which the level rises")
    tangential: float = entry("m/s^2", "largest tangential acceleration at the control point, on the way up or down")
    reached: float = entry("s", "time at which the level is reached")
    ends: float = entry("s", "time until which it is held")


@dataclass(frozen=True, repr=False, eq=False)
class Imbalance(Part):
    """Imbalance of all that a plain arm carries, without the arm itself, and the counterweight that cures it.

    In axes of the arm: x from its axis to the control point, z up along it, from the control point's height.
    """

    static: Floats = entry("kg m", "mass times place from the arm's axis, Σ m r", "axis", frame="arm")
    dynamic: Floats = entry("kg m^2", "that times the height above the control point, Σ m z r", "axis", frame="arm")
    radius: float = entry("m", "from the arm's axis to the control point", key=None)

    @declared("kg m", "size of the static imbalance", name=None)
    def size(self) -> float:
        return float(np.linalg.norm(self.static))

    @declared("rad", "direction of the static imbalance about up, from the arm", name=None)
    def angle(self) -> float:
        return float(np.arctan2(self.static[1], self.static[0]))

    @declared("kg", "counterweight across the axis, as far from it as the control point", name=None)
    def counterweight(self) -> float:
        return self.size / self.radius

    @declared("m", "height of the counterweight above the control point", name=None)
    def height(self) -> float:
        return float(self.static @ self.dynamic) / self.size**2 if self.size > 0 else 0.0

    @declared(
        "kg m^2", "dynamic imbalance that it leaves, which takes two counterweights at different heights", name=None
    )
    def left(self) -> float:
        remainder = float(np.linalg.norm(self.dynamic - self.height * self.static))
        return remainder if remainder > _SAME * float(np.linalg.norm(self.dynamic)) else 0.0


class Driven:
    """A result with the motion of a centrifuge's axes, if any, over its times."""

    time: Floats
    axes: AxesResult | None

    @declared("s", "time from the start to the flight", role="fact", name=None, optional=True)
    def spin_up(self) -> float:
        """Time from the start to the flight, s, or zero at idle, NaN without a machine."""
        return math.nan if self.axes is None else max(float(self.axes.span[0] - self.time[0]), 0.0)

    @declared("s", "time from the flight to the end", role="fact", name=None, optional=True)
    def spin_down(self) -> float:
        """Time from the flight to the end, s, or zero at idle, NaN without a machine."""
        return math.nan if self.axes is None else max(float(self.time[-1] - self.axes.span[1]), 0.0)

    @declared(
        "", "largest rate and acceleration of every axis", "axis", role="rows", name=None, key="axes", optional=True
    )
    def axis_peaks(self) -> Mapping[str, AxisPeaks]:
        if self.axes is None:
            return {}
        time, axes = self._at_own_times(self.axes)
        peaks = {}
        for i, (rate, acceleration) in enumerate(zip(axes.rate.T, axes.acceleration.T, strict=True), 1):
            peaks[str(i)] = AxisPeaks(_peak(time, rate), _peak(time, acceleration))
        return peaks

    @declared("", "largest error of the load against the target", role="part", name=None, optional=True)
    def tracking_error(self) -> Tracking | None:
        """Largest error of the load against the target, whose corners are rounded, or None without a machine."""
        if self.axes is None:
            return None
        time, axes = self._at_own_times(self.axes)
        return _tracking(time, axes, axes.reference)

    @declared("", "largest error of the load against the flight's own", role="part", name=None, optional=True)
    def flight_error(self) -> Tracking | None:
        """Largest error of the load against the flight's own, or None where that is not known."""
        if self.axes is None or self.axes.flight is None:
            return None
        time, axes = self._at_own_times(self.axes)
        return None if axes.flight is None else _tracking(time, axes, axes.flight)

    def _at_own_times(self, axes: AxesResult) -> tuple[Floats, AxesResult]:
        """Times and axes of the imitation where they are known; those of the result else."""
        imitated = axes.imitated
        return (self.time, axes) if imitated is None or imitated.axes is None else (imitated.time, imitated.axes)


def _peak(time: Floats, values: Floats) -> Peak:
    i = int(np.argmax(np.abs(values)))
    return Peak(float(abs(values[i])), float(time[i]))


def _tracking(time: Floats, axes: AxesResult, aim: Floats) -> Tracking:
    """Largest error of the load against `aim` (t, 3) where the target is the flight's load,
    or NaN where it never is.
    """
    if axes.not_followed.all():
        return Tracking(math.nan, math.nan, math.nan)
    error = np.where(axes.not_followed, -1.0, np.linalg.norm(axes.actual - aim, axis=1))
    i = int(np.argmax(error))
    size = float(np.linalg.norm(aim[i]))
    return Tracking(float(error[i]), float(time[i]), float(error[i]) / size if size > 0 else math.nan)


@dataclass(frozen=True, repr=False, eq=False)
class Commands(Part):
    """The axis motions at a controller's sample time."""

    sample: float = fact("sample time", "s")
    time: Floats = entry("s", "time", "time")
    angle: Floats = entry("rad", "angles of axes 1, 2, 3", "time machine_axis")
    rate: Floats = entry("rad/s", "their rates", "time machine_axis")
    acceleration: Floats = entry("rad/s^2", "their accelerations", "time machine_axis")
