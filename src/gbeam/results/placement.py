"""Where to put a specimen on a centrifuge: frozen records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gbeam.results.machine import LimitUse
from gbeam.results.result import Part, Result

MEASURES = ("root-shear", "root-moment", "vibration", "tip")


@dataclass(frozen=True, repr=False)
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
    """

    mounting: str
    smoothing: float
    control_point: float
    mismatch: float
    total_error: float
    accelerations: tuple[float, float, float]
    share: float = 0.0
    exceeded: tuple[LimitUse, ...] = ()


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
    """

    name: str
    control_point: float
    tip_difference: float
    vibration: float
    moment_difference: float


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
        For ``best``, ``current`` and ``middle`` of the beam: each measure of the mismatch field, as a fraction of
        flight's peak.
    verifications : tuple of Verification
        Empty where there was none.
    refused : tuple of str
        Candidates that could not be built, and why.
    widths : tuple of float
        First and last width of smoothing that was tried, s.
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
