"""How far a result may be from the truth, and by what: time steps, too few shapes, the model, the beam theory."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from gbeam.results.result import Floats, Part

PARTS = ("shapes", "model", "beam_theory", "total")


@dataclass(frozen=True, repr=False, eq=False)
class ErrorEstimate(Part):
    """Estimated errors of one quantity, as fractions of its largest size; NaN where there is no estimate.

    A vector's error is its length.

    Parameters
    ----------
    step : float
        Of the time steps.
    shapes : float
        Of too few shapes: against the same model with more.
    model : float
        Of the model: against the geometrically exact one.
    beam_theory : float
        Of the theory of slender beams: against one with shear, rotary inertia and twist, and by plate action.
    total : float
        Largest error of all together, which may be less than their sum.
    """

    step: float = math.nan
    shapes: float = math.nan
    model: float = math.nan
    beam_theory: float = math.nan
    total: float = math.nan

    @property
    def slender(self) -> float:
        """All but the beam theory's: against an exact slender beam."""
        return self.total - (0.0 if math.isnan(self.beam_theory) else self.beam_theory)

    def with_theory(self, share: float) -> ErrorEstimate:
        """The same with an error of the beam theory; one that is not known leaves the total."""
        return replace(self, beam_theory=share, total=self.total + (0.0 if math.isnan(share) else share))

    def __repr__(self) -> str:
        parts = {f.name.replace("_", " "): getattr(self, f.name) for f in fields(self)}
        # A static deflection has no steps.
        known = [f"{k} {100 * x:.2g} %" for k, x in parts.items() if math.isfinite(x) and (x or k != "step")]
        return ", ".join(known) or "not known"


@dataclass(frozen=True, repr=False, eq=False)
class Errors(Part):
    """Estimated errors of a response, or of a static deflection, which takes no time steps.

    Parameters
    ----------
    displacement : ErrorEstimate
        Of the tip's displacement.
    loads : ErrorEstimate
        Of the root's force and moment: the larger of both.
    stress : ErrorEstimate
        Of the largest size of the normal stress over the stations' sections.
    note : str
        Why something is not estimated, or what the estimate leaves out.
    theory : str
        What makes the error of the beam theory, and what it assumes: ``plate action; assumed: Poisson's ratio 0.3``.
    """

    displacement: ErrorEstimate = field(default_factory=ErrorEstimate)
    loads: ErrorEstimate = field(default_factory=ErrorEstimate)
    stress: ErrorEstimate = field(default_factory=ErrorEstimate)
    note: str = ""
    theory: str = ""

    def __repr__(self) -> str:
        parts = {name: getattr(self, name) for name in ("displacement", "loads", "stress")}
        lines = [f"{name}: {part}" for name, part in parts.items()]
        if self.theory:
            lines.append(f"beam theory: {self.theory}")
        return "\n  ".join(["Errors", *lines, *([self.note] if self.note else [])])


@dataclass(frozen=True, repr=False, eq=False)
class FrequencyErrors(Part):
    """Estimated errors of frequencies, as fractions, (k,) each; NaN where there is no estimate.

    Parameters
    ----------
    shapes : (k,)
        Of too few shapes: against the same model with more.
    model : (k,)
        Of the model with enough shapes, against the geometrically exact one.
    beam_theory : (k,)
        Of the theory of slender beams: against one with shear, rotary inertia and twist, and by plate action.
    total : (k,)
        Of all: against the exact model with more shapes, and the beam theory's.
    theory : str
        What makes the error of the beam theory, and what it assumes.
    unseen : tuple of float
        Frequencies below the highest of these that bend the beam and twist it, and that no model here has, Hz.
    """

    shapes: Floats
    model: Floats
    beam_theory: Floats
    total: Floats
    theory: str = ""
    unseen: tuple[float, ...] = ()

    @property
    def slender(self) -> Floats:
        """All but the beam theory's: against an exact slender beam."""
        return self.total - np.nan_to_num(self.beam_theory)

    @property
    def parts(self) -> dict[str, Floats]:
        """The errors by name."""
        return {name: getattr(self, name) for name in PARTS}

    def __getitem__(self, chosen: Any) -> FrequencyErrors:
        shapes, model, beam_theory, total = (each[chosen] for each in self.parts.values())
        return FrequencyErrors(shapes, model, beam_theory, total, self.theory, self.unseen)

    def within(self, share: float) -> int:
        """Of how many of the first frequencies every total is within a share; none where there is no estimate."""
        return int(np.append(np.flatnonzero(~(self.total <= share)), len(self.total))[0])

    @property
    def largest(self) -> float:
        """Largest of the totals that are known; NaN where none is."""
        known = self.total[np.isfinite(self.total)]
        return float(known.max()) if known.size else math.nan


@dataclass(frozen=True)
class StepErrors:
    """Estimated errors of the time steps as fractions of the largest size; NaN where there is no estimate.

    Parameters
    ----------
    displacement : float
        Of the tip's displacement.
    loads : float
        Of the root's force and moment, the larger of both.
    stress : float
    """

    displacement: float = math.nan
    loads: float = math.nan
    stress: float = math.nan
