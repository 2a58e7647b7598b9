"""Every part of a flight on a machine: peaks of its load, what is not followed and why, what comes on top."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gbeam.results.result import Part

TOLERANCE = 0.05  # of a load of the flight
TOLERANCE_OF = ("peak", "instant")  # the flight's largest load, or its load at each time


@dataclass(frozen=True, repr=False, eq=False)
class LoadPeak(Part):
    """A peak of the flight's load above idle, and what the machine makes of it.

    Maxima of the size of the load are one peak unless it falls below nine tenths of the lower of them, or to idle,
    in between.

    Parameters
    ----------
    time : float
        Of the flight's peak, s.
    load : float
        Its size, m/s².
    time_machine : float
        Of the machine's largest load while the flight's is above nine tenths of its peak, s.
    reproduced : float
        That load, at the control point, m/s².
    error : float
        Size of the difference of the two as vectors over `load`, their directions compared at `time_machine`.
    spread, spread_flight : tuple of float
        Size of the load at the root, and at the tip, over that at the control point, less one: of the rigid specimen on
        the machine at `time_machine`, and in flight at `time`.
    reason : str
        Why it is not reproduced within the tolerance: gimbals, left out, a limit of the machine that is used up there,
        such as ``axis 2 acceleration``, or corner (smoothing, or the inverse's own error). Empty where it is.
    instant_error : float
        Size of the difference of both loads as vectors at `time`, over `load`.
    """

    time: float
    load: float
    time_machine: float
    reproduced: float
    error: float
    spread: tuple[float, float]
    spread_flight: tuple[float, float]
    reason: str = ""
    instant_error: float = math.nan

    @property
    def ratio(self) -> float:
        """Reproduced over the flight's."""
        return self.reproduced / self.load


@dataclass(frozen=True, repr=False, eq=False)
class NotFollowed(Part):
    """A stretch of the flight in which the machine's load is not the flight's, within the tolerance.

    Parameters
    ----------
    start, end : float
        s.
    reason : str
        ``below idle``, or those of :class:`LoadPeak`.
    flight_peak : float
        Largest load of the flight in it, m/s².
    """

    start: float
    end: float
    reason: str
    flight_peak: float


@dataclass(frozen=True, repr=False, eq=False)
class Preload(Part):
    """A stretch in which the machine loads the specimen beyond both the flight and idle, by more than the tolerance.

    Parameters
    ----------
    start, end : float
        s.
    time : float
        When it is worst, s.
    load, flight : float
        Machine's and flight's load then, m/s².
    """

    start: float
    end: float
    time: float
    load: float
    flight: float


@dataclass(frozen=True, repr=False, eq=False)
class Accounting(Part):
    """Every part of a flight accounted for.

    Parameters
    ----------
    tolerance : float
        Share of the flight's load by which the machine's may differ and count as following.
    allowed : float
        That difference at the flight's largest load, m/s².
    idle : float
        Least load of the machine, m/s²; zero if there is none.
    span : tuple of float
        First and last time of the flight, s.
    followed_share : float
        Of that time.
    peaks : tuple of LoadPeak
        All above idle, in order of time.
    not_followed : tuple of NotFollowed
        In order of time; with the time followed they make up the flight.
    preloads : tuple of Preload
    tolerance_of : str
        ``peak``: `tolerance` is a share of the flight's largest load; ``instant``: of its load at each time.
    """

    tolerance: float
    allowed: float
    idle: float
    span: tuple[float, float]
    followed_share: float
    peaks: tuple[LoadPeak, ...]
    not_followed: tuple[NotFollowed, ...]
    preloads: tuple[Preload, ...] = ()
    tolerance_of: str = "peak"

    @property
    def main(self) -> LoadPeak | None:
        """The largest peak of the flight's load; None where it never exceeds idle."""
        return max(self.peaks, key=lambda peak: peak.load, default=None)

    @property
    def missed(self) -> tuple[LoadPeak, ...]:
        """Peaks that are not reproduced within the tolerance."""
        return tuple(peak for peak in self.peaks if peak.reason)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the flight's time that is not followed, by reason, the largest first."""
        total: dict[str, float] = {}
        for each in self.not_followed:
            total[each.reason] = total.get(each.reason, 0.0) + (each.end - each.start)
        duration = self.span[1] - self.span[0]
        return {reason: total[reason] / duration for reason in sorted(total, key=lambda reason: -total[reason])}


@dataclass(frozen=True, repr=False, eq=False)
class PeakPair(Part):
    """Largest size of a quantity in flight and on the machine; NaN where it is unknown.

    Parameters
    ----------
    flight, machine : float
        m, N, N m, Pa or m/s².
    time_flight, time_machine : float
        s.
    place_flight, place_machine : str
        Where on the specimen; empty where that is no question.
    """

    flight: float = math.nan
    machine: float = math.nan
    time_flight: float = math.nan
    time_machine: float = math.nan
    place_flight: str = ""
    place_machine: str = ""

    @property
    def ratio(self) -> float:
        """Machine over flight; NaN where there is none in flight."""
        return self.machine / self.flight if self.flight > 0 else math.nan
