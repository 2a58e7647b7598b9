"""Imitations of a flight: the comparison of two responses, and the machine's side alone; frozen records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gbeam.results.accounting import UNITS, Accounting, PeakPair, in_g
from gbeam.results.criteria import Limit, state_of
from gbeam.results.declared import INSIDE, declared, fact, internal, part, quantity, rows
from gbeam.results.machine import AxesFigure, AxesResult, Driven
from gbeam.results.measures import Fatigue, LoadDifference, RootLoads, Shock, StationStatistics
from gbeam.results.parts import yield_margin
from gbeam.results.result import Figured, Flags, Floats
from gbeam.results.verdict import Verdict, Worded

# The main axis has no letter.
ComparisonFigure = Literal["parts", "parts x", "parts y", "parts z", "shock"]
_ACROSS = "over the times at which the target is the flight's load"


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(Worded, Figured[ComparisonFigure]):
    """Differences of a centrifuge's response from the flight's that it imitates.

    Peaks and accounting are those of the whole flight. Differences are taken where the target is the flight's load.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> turn = gb.Flight(z=load)
    >>> machine = gb.Centrifuge(
    ...     turn, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> options = {"duration": 8.0, "step": 0.002, "estimate": False}
    >>> flight = gb.simulate(structure, turn, **options)
    >>> run = gb.simulate(structure, machine, **options)
    >>> comparison = gb.compare(flight, run)
    >>> print(f"{1e3 * comparison.peak_flight[2]:.3f} mm, {1e3 * comparison.peak_centrifuge[2]:.3f} mm")
    2.052 mm, 2.051 mm
    """

    flight: str = fact("name of the flight")
    centrifuge: str = fact("name of the centrifuge")
    time: Floats = quantity("s", "time", "time", role="coordinate")
    difference: Floats = quantity("m", "tip displacement on the centrifuge less in flight", "time axis")
    covered: Flags = quantity(
        "",
        "whether the time is compared",
        "time",
        flags=("not_compared", "compared"),
        note="times at which the target is the flight's load",
    )
    max_difference: Floats = quantity("m", f"largest difference {_ACROSS}", "axis")
    rms_difference: Floats = quantity("m", f"root mean square difference {_ACROSS}", "axis")
    peak_flight: Floats = quantity("m", f"largest displacement in flight {_ACROSS}", "axis")
    peak_centrifuge: Floats = quantity("m", f"largest displacement on the centrifuge {_ACROSS}", "axis")
    peaks: Mapping[str, PeakPair] = rows(
        "largest sizes over the whole flight", "peak", UNITS, name=".",
        note="of the vectors tip, root_force and root_moment, of the stress anywhere and at a point; largest_load is "
        "the base's load anywhere on the rigid specimen, on the machine from the beginning of its spin-up to the end "
        "of its spin-down",
    )  # fmt: skip
    accounting: Accounting = part(
        "which parts of the flight's load the machine reproduces, and why not the others", name="."
    )
    accept: Mapping[str, Limit] = internal(
        "", "limits by name", note="docs/verdict.md, Pass or fail", default_factory=dict
    )
    stations: StationStatistics | None = part(
        "displacement of every station, with trend and elastic vibration apart", name=".", key=INSIDE, optional=True,
        note="None where the record is too short", default=None,
    )  # fmt: skip
    load_difference: LoadDifference | None = part(
        "acceleration that the centrifuge gives the beam's points and the flight does not, and what it implies",
        name="load_difference_", optional=True, default=None,
    )  # fmt: skip
    root: RootLoads | None = part("loads of the root in both environments", name=".", optional=True, default=None)
    shock: Shock | None = part(
        "shock response spectra of the tip's acceleration", name=".", optional=True, default=None
    )
    fatigue: Fatigue | None = part(
        "stress cycles in both runs, and their damage", name=".", optional=True, default=None
    )
    yield_strength: float | None = internal("Pa", "yield strength of the material, where it is given", default=None)
    margins_of_materials: tuple[float, float] | None = internal(
        "",
        "least margin on yield of a solid's materials in flight and on the machine, whose run is judged as a whole",
        default=None,
    )
    whole: tuple[float, float] | None = internal(
        "s", "first and last time of the whole flight, where only a part of it was run, and is judged", default=None
    )
    kept_every: int = internal("", "how many samples of the histories make one in a file", default=1)
    point: str = fact(
        "point whose displacement is that of the tip", name=None, note="empty where it is the tip", default=""
    )
    scale: float | None = fact("level factor of the flight's loads; None of 1", optional=True, default=None)

    exceeded: str = internal("", "worst of the machine's limits that are exceeded", default="")

    @declared("", "share of the times that are compared", role="fact", name=None, key="covered")
    def covered_share(self) -> float:
        return float(self.covered.mean())

    @declared("", "largest difference over the flight's largest displacement", "axis", name=None)
    def relative(self) -> Floats:
        """Largest difference over the flight's largest displacement, per axis, (3,), or NaN without displacement."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.peak_flight > 0, self.max_difference / self.peak_flight, np.nan)

    @property
    def main_axis(self) -> int:
        """Axis (0, 1, 2) along which the tip moves most in flight; z where no time is compared."""
        return int(np.argmax(self.peak_flight)) if self.covered.any() else 2

    @property
    def words(self) -> Verdict:
        """The verdict as words are made of it."""
        return Verdict(self, self.point or "tip", self.margins, self.exceeded, self.scale)

    @declared("", "least margin on yield in flight and on the machine", role="fact", name=None, key="margin")
    def margin(self) -> dict[str, float] | None:
        """Least margin on yield in flight and on the machine, or None without a yield strength."""
        return None if self.margins is None else dict(zip(("flight", "machine"), self.margins, strict=True))

    @property
    def margins(self) -> tuple[float, float] | None:
        """Least margin on yield over the whole flight, in it and on the machine, or None without a yield strength."""
        if self.margins_of_materials is not None:
            return self.margins_of_materials
        stress = self.peaks.get("stress")
        if self.yield_strength is None or stress is None or not np.isfinite(stress.machine):
            return None
        flight, machine = yield_margin(self.yield_strength, np.array([stress.flight, stress.machine]))
        return float(flight), float(machine)

    def __str__(self) -> str:
        return "\n".join([self.verdict, *self.findings])

    def __repr__(self) -> str:
        return "\n  ".join([f"Comparison: {self.verdict}", *self.findings])


@dataclass(frozen=True, repr=False, eq=False)
class MachinePlan(Worded, Driven, Figured[AxesFigure]):
    """Motion of a centrifuge that imitates a flight, without the response of a beam."""

    listed_by, unnamed = "name", "centrifuge"
    name: str = fact("name of the motion", key=None)
    tracks: str = fact("name of the flight")
    arm: float = fact("arm of the centrifuge", "m")
    outcome: str = fact("how it ended", note="done or limits exceeded")
    message: str = fact("which limits, where the outcome is not done")
    time: Floats = quantity("s", "time", "time", role="coordinate")
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
    accept: Mapping[str, Limit] = internal(
        "", "limits by name; those that need a response are not judged", default_factory=dict
    )
    title: str = fact("title of the scenario", key=None, default="")
    whole: tuple[float, float] | None = internal(
        "s", "first and last time of the whole flight, where only a part of it is imitated", default=None
    )
    scale: float | None = fact("level factor of the flight's loads; None of 1", optional=True, default=None)
    with_response = False

    @property
    def words(self) -> Verdict:
        """The verdict as words are made of it."""
        return Verdict(self, exceeded=self.axes.largest_excess, scale=self.scale)

    @declared("", "the outcome, with what limits make of it", role="fact", name=None)
    def state(self) -> str:
        """Outcome with what the limits of acceptance make of it."""
        return state_of(self.outcome, [self])

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        tracks = f", tracks {self.tracks!r}" if self.tracks else ""
        lines = [f"MachinePlan{name} (arm {self.arm:g} m{tracks}): {self.state}"]
        lines += [self.message] if self.message else []
        lines.append(self.verdict)
        rate = np.abs(self.axes.rate).max(axis=0)
        acceleration = np.abs(self.axes.acceleration).max(axis=0)
        lines.append(f"axis rates up to {_listed(rate)} rad/s, accelerations {_listed(acceleration)} rad/s²")
        error = self.axes.tracking_error[~self.axes.not_followed]
        if error.size:
            first, last = self.axes.span
            flown = (self.time >= first) & (self.time <= last)  # without spin-up and spin-down
            share = float(self.axes.not_followed[flown].mean()) if flown.any() else 0.0
            remark = f"another than the flight's load for {share:.0%} of the flight"
            lines.append(f"target followed within {in_g(error.max())}, {remark}")
        return "\n  ".join(lines)


def _listed(values: Floats) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
