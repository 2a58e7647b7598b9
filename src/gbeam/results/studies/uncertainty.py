"""What is known of a figure whose scenario has distributions: estimates with bounds of 95 % confidence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gbeam.results.result import Floats, Part

CONFIDENCE = 0.95
BOUNDS = ("estimate", "low", "high")
MEAN, SPREAD, PROBABILITY = "mean", "standard deviation", "probability"
QUANTILES = {"5 %": 0.05, "median": 0.5, "95 %": 0.95}
ORDERS = ("first", "total")


@dataclass(frozen=True, repr=False, eq=False)
class Statistics(Part):
    """Estimates of a figure's distribution at every point of a sweep's grid.

    Parameters
    ----------
    names : tuple of str
        mean, standard deviation, 5 %, median and 95 % (quantiles); or probability, of what is true or not.
    values : (..., len(names), 3)
        Estimate, and the ends of its interval of 95 % confidence; NaN where there are too few draws for one.
    count : (...) int
        Draws with a figure.
    """

    names: tuple[str, ...]
    values: Floats
    count: NDArray[np.int_]

    def __getitem__(self, name: str) -> Floats:
        """Estimate of one name and its bounds, (..., 3)."""
        return np.asarray(self.values[..., self.names.index(name), :])


@dataclass(frozen=True, repr=False, eq=False)
class Indices(Part):
    """Sobol indices of a figure: which share of its variance each parameter makes.

    Parameters
    ----------
    parameters : tuple of str
        Paths, d of them.
    values : (..., d, 2, 3)
        First order (by itself) and total (with all that it acts together with): estimate and ends of its interval of
        95 % confidence.
    count : (...) int
        Base samples of which all cases have a figure.
    """

    parameters: tuple[str, ...]
    values: Floats
    count: NDArray[np.int_]
