"""Values of a scenario found from a measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Figured, Flags, Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class FittedColumn(Part):
    """One column of the data, and what the fitted scenario says of it.

    Parameters
    ----------
    name, unit : str
        SI.
    measured, fitted, before : (t,)
        `before` is of the scenario as it was.
    noise : float
        Standard deviation of the residual, with the degrees of freedom that the fit leaves.
    correlation : float
        Of each residual with the next one; NaN where the data are no history. Noise has none.
    """

    name: str
    unit: str
    measured: Floats
    fitted: Floats
    before: Floats
    noise: float
    correlation: float

    @property
    def residual(self) -> Floats:
        """Measured less fitted."""
        return np.asarray(self.measured - self.fitted)


@dataclass(frozen=True, repr=False, eq=False)
class Fit(Figured):
    """Values of a scenario at which it is nearest to a measurement, in the sense of least squares.

    Parameters
    ----------
    title : str
        Of the scenario.
    data : str
        The measurement's file.
    parameters, units : tuple of str
        Paths, and SI units.
    before, values : (p,)
        The scenario's values, and those found.
    errors : (p,)
        Standard deviations, one sigma, of the values, if the residuals are noise.
    intervals : (p, 2)
        That hold each value with a probability of 95 %, by Student's t.
    covariance, correlation : (p, p)
    bounds : (p, 2)
    at_bound : (p,) of bool
        Whether a value lies on its bound: then it has no error.
    columns : tuple of FittedColumn
    at : (t,)
        Times, s, or numbers of the modes.
    modal : bool
    evaluations : int
        Of the scenario.
    starts, agreed : int
        Searches, and how many of them ended at these values.
    condition : float
        Of the derivatives, each parameter's of unit length: 1 where the data tell them apart perfectly.
    """

    title: str
    data: str
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    before: Floats
    values: Floats
    errors: Floats
    intervals: Floats
    covariance: Floats
    correlation: Floats
    bounds: Floats
    at_bound: Flags
    columns: tuple[FittedColumn, ...]
    at: Floats
    modal: bool
    evaluations: int
    condition: float
    starts: int = 1
    agreed: int = 1

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} ± {error:.2g} {unit}".rstrip()
            for path, value, error, unit in zip(self.parameters, self.values, self.errors, self.units, strict=True)
        ]
        return self._with_warnings(f"Fit of {len(self.parameters)} values to {self.data}", *rows)
