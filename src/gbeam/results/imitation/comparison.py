"""A comparison of flight and centrifuge: a frozen record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged, Limit
from gbeam.results.imitation.measures import Fatigue, Mismatch, RootLoads, Shock, Statistics
from gbeam.results.imitation.verdict import verdict
from gbeam.results.parts import yield_margin
from gbeam.results.result import Figured, Flags, Floats


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(Judged, Figured):
    """Differences of a centrifuge's response from the flight's that it imitates.

    Peaks and accounting are those of the whole flight; differences are taken where the target is the flight's load.

    Parameters
    ----------
    flight, centrifuge : str
        Names of the motions.
    time : (t,) s
    difference : (t, 3)
        Tip displacement on the centrifuge less in flight, m.
    covered : (t,) bool
        Times compared: those at which the target was not held.
    max_difference, rms_difference : (3,)
        Over the covered times, m.
    peak_flight, peak_centrifuge : (3,)
        Largest displacement over the covered times, m.
    peaks : mapping of str to PeakPair
        Largest sizes over the whole flight of the vectors ``tip``, ``root_force`` and ``root_moment``, and of the
        ``stress`` anywhere; ``largest_load`` is the base's load anywhere on the rigid specimen, on the machine from the
        beginning of its spin-up to the end of its spin-down.
    accounting : Accounting
        Which parts of the flight's load the machine reproduces, and why not the others.
    accept : mapping of str to float or tuple of float
        Limits by name: docs/verdict.md, Pass or fail.
    stations : Statistics or None
        Displacement of every station, with trend and elastic vibration apart; None where the record is too short.
    mismatch : Mismatch or None
        Acceleration that the centrifuge gives the beam's points and the flight does not, and what it implies.
    root : RootLoads or None
        What the root carries in both environments.
    shock : Shock or None
        Shock response spectra of the tip's acceleration.
    fatigue : Fatigue or None
        Cycles of the stress at the root in both runs, and their damage.
    yield_strength : float or None
        Of the material, Pa, where it is given.
    whole : tuple of float or None
        First and last time of the whole flight, s, where only a part of it was run, and is judged.
    kept_every : int
        How many samples of the histories make one in a file.

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

    flight: str
    centrifuge: str
    time: Floats
    difference: Floats
    covered: Flags
    max_difference: Floats
    rms_difference: Floats
    peak_flight: Floats
    peak_centrifuge: Floats
    peaks: Mapping[str, PeakPair]
    accounting: Accounting
    accept: Mapping[str, Limit] = field(default_factory=dict)
    stations: Statistics | None = None
    mismatch: Mismatch | None = None
    root: RootLoads | None = None
    shock: Shock | None = None
    fatigue: Fatigue | None = None
    yield_strength: float | None = None
    whole: tuple[float, float] | None = None
    kept_every: int = 1

    @property
    def relative(self) -> Floats:
        """Largest difference over the flight's largest displacement, per axis, (3,); NaN without displacement."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.peak_flight > 0, self.max_difference / self.peak_flight, np.nan)

    @property
    def main_axis(self) -> int:
        """Axis (0, 1, 2) along which the tip moves most in flight; z where no time is compared."""
        return int(np.argmax(self.peak_flight)) if self.covered.any() else 2

    @property
    def verdict(self) -> str:
        """One sentence about the whole flight that a person can quote."""
        tip = self.accept.get("tip")
        within = tip if isinstance(tip, float) else None
        return verdict(self.flight, self.centrifuge, self.peaks, self.accounting, within, self.margins, self.whole)

    @property
    def margins(self) -> tuple[float, float] | None:
        """Least margin on yield over the whole flight, in it and on the machine; None without a yield strength."""
        stress = self.peaks.get("stress")
        if self.yield_strength is None or stress is None or not np.isfinite(stress.machine):
            return None
        flight, machine = yield_margin(self.yield_strength, np.array([stress.flight, stress.machine]))
        return float(flight), float(machine)

    def __str__(self) -> str:
        return self.verdict[:1].upper() + self.verdict[1:]

    def __repr__(self) -> str:
        return f"Comparison: {self.verdict}"
