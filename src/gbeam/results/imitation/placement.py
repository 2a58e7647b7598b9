"""Where to put a specimen on a centrifuge: frozen records."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from gbeam.results.imitation.accounting import PeakPair
from gbeam.results.machine import LimitUse
from gbeam.results.result import Part, Result

MEASURES = ("root-shear", "root-moment", "vibration", "tip")
EXCEEDED = "limits exceeded"  # an outcome
_LEVER = 0.1  # least part of the total error that a move must save to be worth it
_FULL = 0.99  # share of a limit from which on it is used up
_SAME = 1e-3  # of the length: control points nearer than this are one


@dataclass(frozen=True, repr=False, eq=False)
class Candidate(Part):
    """One way of mounting and smoothing, with the control point that is best for it.

    Parameters
    ----------
    mounting : str
        upright or inverted.
    smoothing : float
        Width of the target's kernel, s.
    control_point : float
        Best for this candidate, from the root, m.
    mismatch : float
        Weighted measure of what the mismatch field alone does there, as a fraction of flight's peak.
    total_error : float
        The same with what smoothing and tracking change of the load: what candidates are chosen by.
    accelerations : tuple of float
        Largest accelerations of axes 1, 2, 3, rad/s².
    share : float
        Largest share of a limit of the machine that is used; zero where it has none.
    exceeded : tuple of LimitUse
        The limits that it breaks.
    most_used : LimitUse or None
        The limit of which the largest share is used.
    tracking : float
        Weighted measure of what smoothing and tracking alone change of the load, which no control point changes.
    largest_load : PeakPair
        Of the base anywhere on the rigid specimen, m/s², on the machine from the beginning of its spin-up to the end of
        its spin-down.
    """

    mounting: str
    smoothing: float
    control_point: float
    mismatch: float
    total_error: float
    accelerations: tuple[float, float, float]
    share: float = 0.0
    exceeded: tuple[LimitUse, ...] = ()
    most_used: LimitUse | None = None
    tracking: float = math.nan
    largest_load: PeakPair = field(default_factory=PeakPair)


@dataclass(frozen=True)
class Verification:
    """What the full model says of a control point, over the times at which the target was not held.

    Parameters
    ----------
    name : str
        best, current or middle.
    control_point : float
        m.
    tip_difference : float
        Largest difference of the tip from flight across the beam, m.
    vibration : float
        Largest elastic vibration of the tip that the mismatch field causes, m: across the beam, against a base that
        carries the same load at the control point without turning.
    moment_difference : float
        Largest difference of the bending moment at the root, N m.
    force_difference : float
        Largest difference of the shear force at the root, N.
    """

    name: str
    control_point: float
    tip_difference: float
    vibration: float
    moment_difference: float
    force_difference: float = math.nan


@dataclass(frozen=True, repr=False, eq=False)
class Placement(Result):
    """The best control point, mounting and smoothing for a measure.

    Parameters
    ----------
    flight, centrifuge : str
        Names of the motions.
    weights : mapping of str to float
        Of the measures.
    length : float
        Of the beam, m.
    best : Candidate
    options : tuple of Candidate
        All that were tried, the best first, those that break limits last.
    current : float
        The scenario's control point, m.
    values : mapping of str to (mapping of str to float)
        For ``best``, ``current`` (the scenario's own mounting, smoothing and control point) and ``middle`` of the beam:
        each measure of the mismatch field, as a fraction of flight's peak.
    verifications : tuple of Verification
        Empty where there was none.
    refused : tuple of str
        Candidates that could not be built, and why.
    widths : tuple of float
        First and last width of smoothing that was tried, s.
    totals : mapping of str to (mapping of str to float)
        As `values`, with what smoothing and tracking change of the load.
    before : Candidate or None
        The scenario's own.
    outcome : str
        done, or limits exceeded where every candidate breaks a limit: the best is then the nearest.
    """

    flight: str
    centrifuge: str
    weights: Mapping[str, float]
    length: float
    best: Candidate
    options: tuple[Candidate, ...]
    current: float
    values: Mapping[str, Mapping[str, float]]
    verifications: tuple[Verification, ...] = field(default=())
    refused: tuple[str, ...] = ()
    widths: tuple[float, float] = (0.0, 0.0)
    totals: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    before: Candidate | None = None
    outcome: str = "done"

    @property
    def changes(self) -> dict[str, str]:
        """What to change of the centrifuge, as in a scenario; empty where it is the best already, or none may be."""
        best, before = self.best, self.before
        if self.outcome != "done":
            return {}
        found = {}
        if abs(best.control_point - self.current) > _SAME * self.length:
            found["control_point"] = f"{1e3 * best.control_point:.6g} mm"
        if before is not None and best.mounting != before.mounting:
            found["mounting"] = best.mounting
        if before is not None and abs(best.smoothing - before.smoothing) > 1e-3 * before.smoothing:
            # Upwards: rounding must not sharpen the corners of a machine at its limit.
            found["smoothing"] = f"{math.ceil(1e5 * best.smoothing - 1e-6) / 100:g} ms"
        return found

    @property
    def message(self) -> str:
        """Why none is allowed and which comes nearest; or why placing saves little, and what dominates."""
        best, before = self.best, self.before
        if self.outcome != "done":
            broken = "; ".join(str(use) for use in best.exceeded)
            return (
                f"none of {len(self.options)} options keeps the machine's limits; nearest comes {best.mounting}, "
                f'{1e3 * best.smoothing:.4g} ms: {broken}; try wider smoothing or inverse = "planned"'
            )
        if not self.changes:
            return "the scenario has the best placement already"
        if before is None or before.exceeded or best.total_error <= (1 - _LEVER) * before.total_error:
            return ""
        most = best.most_used
        limit = f", and {most} leaves no more" if most is not None and most.share >= _FULL else ""
        return (
            f"placing is no lever here: it brings the measure from {100 * before.total_error:.3g} to "
            f"{100 * best.total_error:.3g} % of flight's peak; what the load itself differs by at the control point "
            f"makes {100 * best.tracking:.3g} %{limit}"
        )

    @property
    def fraction(self) -> float:
        """Best control point over the length."""
        return self.best.control_point / self.length

    @property
    def vibration_gain(self) -> float:
        """Vibration with the control point at mid-span over that with the best, simulated; NaN where it was not."""
        vibration = {check.name: check.vibration for check in self.verifications}
        if not {"best", "middle"} <= vibration.keys() or vibration["best"] <= 0:
            return float("nan")
        return vibration["middle"] / vibration["best"]

    def __repr__(self) -> str:
        best = self.best
        measure = " + ".join(f"{weight:g} × {name}" for name, weight in self.weights.items() if weight)
        lines = [
            f"Placement of {self.centrifuge!r}, tracking {self.flight!r}, by {measure}",
            f"control point {1e3 * best.control_point:.2f} mm from the root ({self.fraction:.4f} of the length), "
            f"{best.mounting}, smoothing {1e3 * best.smoothing:.4g} ms",
            f"mismatch {100 * best.mismatch:.3g} % of flight's peak, in total {100 * best.total_error:.3g} %; "
            f"{len(self.options)} candidates",
        ]
        return "\n  ".join(lines)
