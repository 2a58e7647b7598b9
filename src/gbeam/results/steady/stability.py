"""Where a beam no longer rests: critical speeds, accelerations and load factors, as frozen records."""

from __future__ import annotations

from dataclasses import dataclass, field

from gbeam.results.parts.errors import ErrorEstimate
from gbeam.results.result import Figured, Floats, Part, Result, brief


@dataclass(frozen=True, repr=False, eq=False)
class Critical(Result):
    """Where the stiffness about the relative equilibrium stops being positive definite, or something grows.

    Parameters
    ----------
    quantity, unit : str
        What was raised: ``hub rate``, rad/s; ``acceleration along x``, m/s²; or ``load factor``, times the loads.
    value : float or None
        None where it is not reached.
    searched_to : float
        End of the search.
    kind : str
        ``divergence``, ``flutter``, ``no equilibrium`` or ``none``.
    direction : str
        Of the mode that is lost; empty where there is none.
    reason : str
        The answer as a sentence.
    model : str
    errors : ErrorEstimate
        Of the value. The model's is infinite where the exact one keeps its equilibrium to three times the value.
    """

    quantity: str
    unit: str
    value: float | None
    searched_to: float
    kind: str
    direction: str
    reason: str
    model: str
    errors: ErrorEstimate = field(default_factory=ErrorEstimate)

    @property
    def error_estimate(self) -> float:
        """Error of the value from too few shapes, a fraction; NaN where there is no estimate."""
        return self.errors.shapes

    def __repr__(self) -> str:
        value = f"none up to {self.searched_to:.6g}" if self.value is None else f"{self.value:.6g}"
        return self._with_warnings(f"Critical {self.quantity} ({self.model}): {value} {self.unit}", self.reason)


@dataclass(frozen=True, repr=False, eq=False)
class MapErrors(Part):
    """Estimated errors of the speeds of a map, as fractions, (m, p) each; NaN where there is none.

    Parameters
    ----------
    shapes, model, beam_theory, total : (m, p)
        From too few shapes, of the model against exact, of the theory of slender beams, and of all; infinite where the
        exact model keeps its equilibrium to three times the speed.
    """

    shapes: Floats
    model: Floats
    beam_theory: Floats
    total: Floats


@dataclass(frozen=True, repr=False, eq=False)
class CriticalMap(Figured):
    """Critical hub rates against a mass on the beam and its position.

    Parameters
    ----------
    motion, model : str
    mass : (m,) kg
    position : (p,) m from the root
    speed : (m, p) rad/s; NaN where it is not reached
    searched_to : float
        rad/s.
    errors : MapErrors or None
        Of the speeds; None where there is no estimate.
    """

    motion: str
    model: str
    mass: Floats
    position: Floats
    speed: Floats
    searched_to: float
    errors: MapErrors | None = None

    def __repr__(self) -> str:
        return brief(self)
