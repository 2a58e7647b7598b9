"""Values of a scenario at which a figure is least."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gbeam.results.result import Figured, Flags, Floats, Part

BROKEN = "limits exceeded"  # an outcome
_TIGHT = 1e-3  # of a bound: nearer, it decides


@dataclass(frozen=True, repr=False, eq=False)
class Requirement(Part):
    """A bound on a figure.

    Parameters
    ----------
    name, unit : str
        Of the figure, SI.
    low, high : float
        Infinite where there is none.
    before, value : float
        Of the figure in the scenario as it was, and at the optimum.
    """

    name: str
    unit: str
    low: float
    high: float
    before: float
    value: float

    @property
    def bound(self) -> float:
        """The one that is nearer to the value."""
        return self.high if abs(self.high - self.value) <= abs(self.value - self.low) else self.low

    @property
    def kept(self) -> bool:
        """Whether the value lies within, but for a thousandth of the bound."""
        slack = _TIGHT * abs(self.bound)
        return self.low - slack <= self.value <= self.high + slack

    @property
    def active(self) -> bool:
        """Whether it decides: the value lies on the bound."""
        return math.isfinite(self.bound) and abs(self.value - self.bound) <= _TIGHT * max(abs(self.bound), 1e-300)


@dataclass(frozen=True, repr=False, eq=False)
class Optimum(Figured):
    """Values of a scenario at which a figure is least, within bounds and requirements.

    Parameters
    ----------
    title : str
        Of the scenario.
    minimise, unit : str
        The figure, SI; of what has no unit, such as a verdict, the size is minimised.
    parameters, units : tuple of str
        Paths, and SI units.
    before, values : (p,)
        The scenario's values, and the best.
    bounds : (p, 2)
    at_bound : (p,) of bool
        Whether the best value lies on its bound.
    figure_before, figure : float
        By runs with steps of their own.
    error : float
        Estimated total error of the tip's displacement in the run at the optimum; NaN where there is no run.
    requirements : tuple of Requirement
    path : (k, p)
        The values tried that were better than those before.
    history : (k,)
        The figure there.
    evaluations : int
    starts, agreed : int
        Searches, and how many of them ended at these values.
    outcome : str
        done, or ``limits exceeded`` where no values within the bounds keep the requirements.
    """

    title: str
    minimise: str
    unit: str
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    before: Floats
    values: Floats
    bounds: Floats
    at_bound: Flags
    figure_before: float
    figure: float
    error: float
    requirements: tuple[Requirement, ...]
    path: Floats
    history: Floats
    evaluations: int
    outcome: str = "done"
    starts: int = 1
    agreed: int = 1

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} {unit}".rstrip() + f" (was {old:.6g})"
            for path, value, old, unit in zip(self.parameters, self.values, self.before, self.units, strict=True)
        ]
        end = "" if self.outcome == "done" else f" ({self.outcome})"
        what = f"Optimum of {self.minimise}: {self.figure:.4g} {self.unit}".rstrip()
        return self._with_warnings(f"{what}, was {self.figure_before:.4g}{end}", *rows)
