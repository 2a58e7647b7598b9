"""The machine's side of an imitation: what its axes do, and what that makes of the flight; a frozen record."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged, Limit, state_of
from gbeam.results.imitation.verdict import verdict
from gbeam.results.machine import AxesResult
from gbeam.results.result import Figured, Floats

_WIDTH = 110  # columns


@dataclass(frozen=True, repr=False, eq=False)
class MachinePlan(Judged, Figured):
    """What a centrifuge does to imitate a flight, without the response of a beam.

    Parameters
    ----------
    name, tracks : str
        Of the motion, and of the flight.
    arm : float
        m.
    outcome : str
        done or limits exceeded.
    message : str
        Which limits, where the outcome is not done.
    time : (t,) s
    axes : AxesResult
        At these times.
    accounting : Accounting
        Which parts of the flight's load the machine reproduces, and why not the others.
    gravity : float
        On the machine, a part of the load, m/s²; zero where the load is acceleration.
    mounting : str
        upright or inverted.
    peaks : mapping of str to PeakPair
        ``largest_load``, that of the base anywhere on the rigid specimen over all of the run; NaN where no beam says
        how long the specimen is.
    accept : mapping of str to float or tuple of float
        Limits by name; those that need a response are not judged.
    title : str
        Of the scenario.
    whole : tuple of float or None
        First and last time of the whole flight, s, where only a part of it is imitated.
    """

    name: str
    tracks: str
    arm: float
    outcome: str
    message: str
    time: Floats
    axes: AxesResult
    accounting: Accounting
    gravity: float
    mounting: str
    peaks: Mapping[str, PeakPair] = field(default_factory=dict)
    accept: Mapping[str, Limit] = field(default_factory=dict)
    title: str = ""
    whole: tuple[float, float] | None = None
    with_response = False

    @property
    def verdict(self) -> str:
        """One sentence about the load over the whole flight."""
        return verdict(
            self.tracks or "flight", self.name or "centrifuge", self.peaks, self.accounting, whole=self.whole
        )

    @property
    def state(self) -> str:
        """Outcome with what the limits of acceptance make of it."""
        return state_of(self.outcome, [self])

    def __repr__(self) -> str:
        of = f" {self.name!r}" if self.name else ""
        tracks = f", tracks {self.tracks!r}" if self.tracks else ""
        lines = [f"MachinePlan{of} (arm {self.arm:g} m{tracks}): {self.state}"]
        lines += [self.message] if self.message else []
        lines += textwrap.wrap(self.verdict, _WIDTH)
        rate, acceleration = (np.abs(each).max(axis=0) for each in (self.axes.rate, self.axes.acceleration))
        lines.append(f"axis rates up to {_listed(rate)} rad/s, accelerations {_listed(acceleration)} rad/s²")
        error = self.axes.tracking_error[~self.axes.not_followed]
        if error.size:
            held = float(self.axes.not_followed.mean())
            lines.append(f"target followed within {error.max():.3g} m/s², held {held:.0%} of the time")
        return "\n  ".join(lines)


def _listed(values: Floats) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
