"""How figures of a scenario change with its physical values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gbeam.results.result import Figured, Flags, Floats


@dataclass(frozen=True, repr=False, eq=False)
class Sensitivity(Figured):
    """Derivatives of figures of one scenario with respect to physical values in it.

    Parameters
    ----------
    title : str
        Of the scenario.
    verb : str
        Whose figures they are.
    measures : tuple of str
    units : tuple of str
        SI, of the measures.
    figures : (m,)
        The measures' values.
    parameters : tuple of str
        Paths in the scenario.
    parameter_units : tuple of str
        SI.
    values : (p,)
        Of the parameters.
    derivatives : (m, p)
        SI.
    errors : (m, p)
        Of those derivatives that are differences: how far the formulas of second and fourth order are apart. NaN where
        the derivative is exact.
    methods : tuple of str
        Of each parameter: ``exact``, the derivative of the discrete solution, or ``difference``.
    kinks : (m, p) of bool
        Whether the slopes on either side differ, so that the derivative is their mean.
    run_error : float
        Estimated error of the runs that the figures are read from, the largest of displacement and loads, relative to
        their largest; NaN of other verbs. Exact derivatives are those of these runs and have no error of their own.
    not_varied : tuple of str
        Values of the scenario that may not be a little more or less, and why; they have no derivative.
    """

    title: str
    verb: str
    measures: tuple[str, ...]
    units: tuple[str, ...]
    figures: Floats
    parameters: tuple[str, ...]
    parameter_units: tuple[str, ...]
    values: Floats
    derivatives: Floats
    errors: Floats
    methods: tuple[str, ...]
    kinks: Flags
    run_error: float = np.nan
    not_varied: tuple[str, ...] = ()

    @property
    def relative(self) -> Floats:
        """Relative change of each figure over that of each parameter, p/f ∂f/∂p, (m, p); NaN where a figure is zero."""
        size = np.where(self.figures == 0, np.nan, self.figures)
        return self.derivatives * self.values / size[:, None]

    def ranked(self, measure: str = "") -> NDArray[np.intp]:
        """Indices of the parameters by how much one percent of each changes a `measure`, the first by default."""
        k = self.measures.index(measure) if measure else 0
        return np.argsort(-np.abs(self.derivatives[k] * self.values), kind="stable")

    def __repr__(self) -> str:
        first = self.ranked()[:3]
        shares = ", ".join(f"{self.parameters[j]} {self.relative[0, j]:+.3g} %/%" for j in first)
        what = f"{', '.join(self.measures)} to {len(self.parameters)} values"
        return self._with_warnings(f"Sensitivity of {what}: {self.measures[0]} by {shares}")
