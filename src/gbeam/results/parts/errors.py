"""How far a result may be from the truth, and by what: time steps, too few shapes, the model."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from gbeam.results.result import Floats, Part


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
    total : float
        Largest error of all three together, which may be less than their sum.
    """

    step: float = math.nan
    shapes: float = math.nan
    model: float = math.nan
    total: float = math.nan

    def __repr__(self) -> str:
        parts = {f.name: getattr(self, f.name) for f in fields(self)}
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
    """

    displacement: ErrorEstimate = field(default_factory=ErrorEstimate)
    loads: ErrorEstimate = field(default_factory=ErrorEstimate)
    stress: ErrorEstimate = field(default_factory=ErrorEstimate)
    note: str = ""

    def __repr__(self) -> str:
        parts = {name: getattr(self, name) for name in ("displacement", "loads", "stress")}
        lines = [f"{name}: {part}" for name, part in parts.items()]
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
    total : (k,)
        Of both, against the exact model with more shapes.
    """

    shapes: Floats
    model: Floats
    total: Floats

    def __getitem__(self, chosen: Any) -> FrequencyErrors:
        return FrequencyErrors(self.shapes[chosen], self.model[chosen], self.total[chosen])

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
