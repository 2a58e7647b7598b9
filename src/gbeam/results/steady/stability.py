"""Where a beam no longer rests: critical speeds, accelerations and load factors, as frozen records."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.results.declared import declared, fact, part
from gbeam.results.declared import quantity as entry  # a critical value has a field of that name
from gbeam.results.parts.errors import MODEL, SHAPES, THEORY, TOTAL, ErrorEstimate
from gbeam.results.result import Figured, Floats, Part, Result, brief


@dataclass(frozen=True, repr=False, eq=False)
class Critical(Result):
    """Where the stiffness about the relative equilibrium stops being positive definite, or something grows."""

    quantity: str = fact("quantity that is raised", note="hub rate, acceleration along x, or load factor")
    unit: str = fact("unit of the quantity", note="rad/s, m/s^2, or none of a factor of the loads", name=None)
    value: float | None = entry(lambda self: self.unit, "critical value; missing where it is not reached", key=None)
    searched_to: float = entry(lambda self: self.unit, "end of the search")
    kind: str = fact("how it is lost", note="divergence, flutter, no equilibrium or none")
    direction: str = fact("direction of the mode that is lost", note="empty where there is none")
    reason: str = fact("the answer as a sentence")
    model: str = fact("kind of the model")
    errors: ErrorEstimate = part(
        "errors of the value",
        name="error_",
        default_factory=ErrorEstimate,
        note="that of the model is infinite where the exact one keeps its equilibrium to three times the value",
    )

    @property
    @declared("", "estimated error from too few shapes", name=None)
    def error_estimate(self) -> float:
        """Error of the value from too few shapes, a fraction; NaN where there is no estimate."""
        return self.errors.shapes

    def __repr__(self) -> str:
        value = f"none up to {self.searched_to:.6g}" if self.value is None else f"{self.value:.6g}"
        return self._with_warnings(f"Critical {self.quantity} ({self.model}): {value} {self.unit}", self.reason)


@dataclass(frozen=True, repr=False, eq=False)
class MapErrors(Part):
    """Estimated errors of the speeds of a map, as fractions, (m, p) each; NaN where there is none.

    Infinite where the exact model keeps its equilibrium to three times the speed.
    """

    shapes: Floats = entry("", SHAPES)
    model: Floats = entry("", MODEL)
    beam_theory: Floats = entry("", THEORY)
    total: Floats = entry("", TOTAL)


@dataclass(frozen=True, repr=False, eq=False)
class CriticalMap(Figured):
    """Critical hub rates against a mass on the beam and its position."""

    motion: str = fact("name of the motion")
    model: str = fact("kind of the model")
    mass: Floats = entry("kg", "mass on the beam", "mass", role="coordinate")
    position: Floats = entry("m", "its position from the root", "position", role="coordinate")
    speed: Floats = entry(
        "rad/s", "critical hub rate; missing where it is not reached", "mass", "position", key="critical_speed"
    )
    searched_to: float = fact("end of the search", "rad/s")
    errors: MapErrors | None = part(
        "errors of the speeds",
        "mass",
        "position",
        name="speed_error_",
        note="None where there is no estimate",
        default=None,
    )

    def __repr__(self) -> str:
        return brief(self)
