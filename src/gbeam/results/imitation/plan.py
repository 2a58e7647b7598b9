"""The machine's side of an imitation: what its axes do, and what that makes of the flight; a frozen record."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gbeam.results.declared import INSIDE, fact, part, quantity, rows
from gbeam.results.imitation.accounting import UNITS, Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged, Limit, state_of
from gbeam.results.imitation.verdict import verdict
from gbeam.results.machine import AxesResult, Driven
from gbeam.results.result import Figured, Floats

_WIDTH = 110  # columns


@dataclass(frozen=True, repr=False, eq=False)
class MachinePlan(Judged, Driven, Figured):
    """Motion of a centrifuge that imitates a flight, without the response of a beam."""

    listed_by = "name"
    name: str = fact("name of the motion", key=None)
    tracks: str = fact("name of the flight")
    arm: float = fact("arm of the centrifuge", "m")
    outcome: str = fact("how it ended", note="done or limits exceeded")
    message: str = fact("which limits, where the outcome is not done")
    time: Floats = quantity("s", "time", "time", role="coordinate", key=None)
    axes: AxesResult = part("the axes at these times", name=None, key=INSIDE)
    accounting: Accounting = part(
        "which parts of the flight's load the machine reproduces, and why not the others", name=None
    )
    gravity: float = fact(
        "gravity on the machine, a part of the load", "m/s^2", note="zero where the load is acceleration"
    )
    mounting: str = fact("upright or inverted")
    peaks: Mapping[str, PeakPair] = rows(
        "largest_load, that of the base anywhere on the rigid specimen over all of the run", "peak", UNITS,
        note="NaN where no beam says how long the specimen is", name=".", default_factory=dict,
    )  # fmt: skip
    accept: Mapping[str, Limit] = fact(
        "limits by name; those that need a response are not judged", name=None, key=None, default_factory=dict
    )
    title: str = fact("title of the scenario", key=None, default="")
    whole: tuple[float, float] | None = fact(
        "first and last time of the whole flight, where only a part of it is imitated", "s", name=None, key=None,
        default=None,
    )  # fmt: skip
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
            first, last = self.axes.span
            flown = (self.time >= first) & (self.time <= last)  # without spin-up and spin-down
            held = float(self.axes.not_followed[flown].mean()) if flown.any() else 0.0
            lines.append(f"target followed within {error.max():.3g} m/s², held {held:.0%} of the flight's time")
        return "\n  ".join(lines)


def _listed(values: Floats) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
