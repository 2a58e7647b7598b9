"""Every part of a flight on a machine: peaks of its load, what is not followed and why, and what comes on top."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gbeam.constants import STANDARD_GRAVITY
from gbeam.results.declared import BESIDE, declared, fact, quantity, rows
from gbeam.results.result import Part

TOLERANCE = 0.05  # of a load of the flight
TOLERANCE_OF = ("peak", "instant")  # the flight's largest load, or its load at each time


@dataclass(frozen=True, repr=False, eq=False)
class LoadPeak(Part):
    """A peak of the flight's load above idle, and the machine's load there.

    Maxima of the size of the load are one peak unless it falls below nine tenths of the lower of them, or to idle,
    in between. It counts as reproduced where its `error` is within the tolerance, of its own size.
    """

    time: float = quantity("s", "peak of the flight's load above idle")
    load: float = quantity("m/s^2", "its size", name="flight")
    time_machine: float = quantity(
        "s", "time of the machine's largest load", note="while the flight's is above nine tenths of its peak"
    )
    reproduced: float = quantity("m/s^2", "load of the machine then", name="machine", note="at the control point")
    error: float = quantity(
        "", "difference as vectors over its size", note="their directions compared at `time_machine`"
    )
    spread: tuple[float, float] = quantity(
        "",
        "load at root and tip over that at the control point, less one",
        "end",
        note="of the rigid specimen on the machine at `time_machine`; of one that is no beam at the corner where it "
        "differs most in place of the tip",
    )
    spread_flight: tuple[float, float] = quantity(
        "", "the same in flight", "end", name=None, note="of the rigid specimen at `time`"
    )
    reason: str = quantity(
        "",
        "why it is not reproduced; empty where it is",
        key=None,
        note="gimbals, left out, a limit of the machine that is used up there, such as axis 2 acceleration, or corner "
        "(smoothing, or the inverse's own error)",
        default="",
    )
    instant_error: float = quantity("", "difference at the time of the flight's peak over its size", default=math.nan)

    @declared("", "why it is not reproduced", name=None, key="reason")
    def reason_or_none(self) -> str | None:
        return self.reason or None

    @declared("", "reproduced over the flight's", name=None)
    def ratio(self) -> float:
        return self.reproduced / self.load


@dataclass(frozen=True, repr=False, eq=False)
class NotFollowed(Part):
    """A stretch of the flight in which the machine's load is not the flight's, within the tolerance."""

    start: float = quantity("s", "start of a stretch that is not followed", name="from")
    end: float = quantity("s", "its end", name="to")
    reason: str = quantity("", "why it is not followed", note="below idle, or a reason of a :class:`LoadPeak`")
    flight_peak: float = quantity("m/s^2", "largest load of the flight in it", name="peak")


@dataclass(frozen=True, repr=False, eq=False)
class Overload(Part):
    """A stretch in which the machine loads the specimen beyond both the flight and idle, by more than the tolerance."""

    start: float = quantity("s", "its start")
    end: float = quantity("s", "its end")
    time: float = quantity("s", "when it is worst")
    load: float = quantity("m/s^2", "load of the machine then")
    flight: float = quantity("m/s^2", "load of the flight then")


@dataclass(frozen=True, repr=False, eq=False)
class Accounting(Part):
    """Every part of a flight accounted for."""

    tolerance: float = quantity(
        "", "share of the flight's load by which the machine's may differ and count as following", name=None
    )
    allowed: float = quantity(
        "m/s^2", "error of the load that counts as following", name="tolerance_load", key="tolerance_load",
        note="at the flight's largest load",
    )  # fmt: skip
    idle: float = quantity("m/s^2", "least load of the machine; zero if there is none", name=None)
    span: tuple[float, float] = quantity("s", "time of the flight that is judged", "ends", name="flight", key=None)
    followed_share: float = quantity("", "share of the flight's time that is followed")
    peaks: tuple[LoadPeak, ...] = rows("all above idle, in order of time", "load_peak", name="load_peak_")
    not_followed: tuple[NotFollowed, ...] = rows(
        "stretches not followed, in order of time", "stretch", name="not_followed_",
        note="with the time followed they make up the flight",
    )  # fmt: skip
    overloads: tuple[Overload, ...] = rows(
        "stretches that load the specimen beyond", "overload", name=None, key="overload", default=()
    )
    tolerance_of: str = fact(
        "the load that `tolerance` is a share of",
        note="peak: the flight's largest; instant: the flight's at each time",
        default="peak",
    )

    @declared("", "units of what follows", role="fact", name=None)
    def units(self) -> dict[str, str]:
        return {"load": "m/s^2", "time": "s"}

    @property
    def main(self) -> LoadPeak | None:
        """The largest peak of the flight's load, or None where it never exceeds idle."""
        return max(self.peaks, key=lambda peak: peak.load, default=None)

    @property
    def missed(self) -> tuple[LoadPeak, ...]:
        """Peaks that are not reproduced within the tolerance."""
        return tuple(peak for peak in self.peaks if peak.reason)

    @declared("", "share of the flight's time that is not followed, by reason", role="fact", name=None,
              key="not_followed_share")  # fmt: skip
    def shares(self) -> dict[str, float]:
        """Share of the flight's time that is not followed, by reason, the largest first."""
        total: dict[str, float] = {}
        for stretch in self.not_followed:
            total[stretch.reason] = total.get(stretch.reason, 0.0) + (stretch.end - stretch.start)
        duration = self.span[1] - self.span[0]
        return {reason: total[reason] / duration for reason in sorted(total, key=lambda reason: -total[reason])}


# Quantities whose largest sizes are compared: words, SI unit, and that in which tables have it.
QUANTITIES = {
    "largest_load": ("load anywhere on the specimen", "m/s^2", "g"),
    "tip": ("tip displacement", "m", "mm"),
    "root_force": ("root force", "N", "N"),
    "root_moment": ("root moment", "N m", "N m"),
    "stress": ("stress", "Pa", "MPa"),
    "stress_at": ("stress at the point", "Pa", "MPa"),
}
UNITS = {name: unit for name, (_, unit, _) in QUANTITIES.items()}


@dataclass(frozen=True, repr=False, eq=False)
class PeakPair(Part):
    """Largest size of a quantity in flight and on the machine, SI, or NaN where it is unknown."""

    flight: float = quantity(BESIDE, "largest in flight", default=math.nan)
    machine: float = quantity(BESIDE, "largest on the machine", default=math.nan)
    time_flight: float = quantity("s", "when that is in flight", default=math.nan)
    time_machine: float = quantity("s", "when that is on the machine", default=math.nan)
    place_flight: str = quantity("", "where on the specimen that is in flight", optional=True, default="")
    place_machine: str = quantity("", "where on the specimen that is on the machine", optional=True, default="")

    @declared("", "machine over flight", name=None)
    def ratio(self) -> float:
        """Machine over flight, or NaN where there is none in flight."""
        return self.machine / self.flight if self.flight > 0 else math.nan


_TIMES = 3.0  # from here on a ratio says more than a change of so many per cent


def tolerance_words(accounting: Accounting) -> str:
    """Write the difference from the flight's load within which it counts as followed."""
    share = percent(accounting.tolerance)
    if accounting.tolerance_of == "instant":
        return f"{share} of the load at the time"
    return f"{in_g(accounting.allowed)} ({share} of the largest load)"


def in_g(load: float) -> str:
    """Write a load, m/s², in g."""
    return f"{load / STANDARD_GRAVITY:.3g} g"


def metres(length: float) -> str:
    """Write a length in m, or in mm below 1 m."""
    return f"{length:.4g} m" if abs(length) >= 1 else f"{1e3 * length:.4g} mm"


def seconds(time: float) -> str:
    """Write a time in s, or in ms below 1 s."""
    return f"{time:#.4g} s" if time >= 1 else f"{1e3 * time:#.4g} ms"


def change(ratio: float) -> str:
    """Write by how much a ratio differs from one, with its sign; the ratio where it is large."""
    share = 100 * (ratio - 1)
    if ratio >= _TIMES:
        return f"{ratio:.2g} times" if ratio < 100 else f"{ratio:.0f} times"
    if abs(share) < 0.05:
        return "under 0.1 %"
    return f"{share:+.0f} %" if abs(share) >= 10 else f"{share:+.1f} %"


def percent(share: float, *, ceiling: bool = False) -> str:
    """Write a share with two digits and no exponent; rounded up, as `ceiling` asks, where it is a bound."""
    if not math.isfinite(share):
        return "an unknown share"
    value = 100 * share
    if ceiling and value > 0:
        unit = 10.0 ** (math.floor(math.log10(value)) - 1)
        value = math.ceil(value / unit - 1e-9) * unit
    return f"{float(f'{value:.2g}'):g} %"
