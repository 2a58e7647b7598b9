"""Figures of many cases: sensitivities, sweeps, and what samples say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.results.imitation.criteria import EXCEEDED, NOT_ACCEPTED
from gbeam.results.result import Figured, Flags, Floats, Part

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


SAMPLE = "sample"  # the dimension of what is drawn from distributions
# Outcomes of cases that are computed to the end, with every figure, and do not keep limits.
ANSWERED = (NOT_ACCEPTED, EXCEEDED, "limits exceeded")


@dataclass(frozen=True, repr=False, eq=False)
class Parameter(Part):
    """One value of the scenario that varies.

    Parameters
    ----------
    path : str
        Its key, such as ``motion.centrifuge.arm``.
    values : (n,)
        Numbers in `unit`, or words.
    unit : str
        As written, such as ``g/s``; the SI unit where none was; empty for words and plain numbers.
    drawn : str
        The distribution that the values are drawn from; empty for a grid.
    """

    path: str
    values: NDArray[Any]
    unit: str = ""
    drawn: str = ""

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return bool(np.issubdtype(self.values.dtype, np.number))

    @property
    def dimension(self) -> str:
        """Dimension of the result along which it varies."""
        return SAMPLE if self.drawn else self.path


@dataclass(frozen=True, repr=False, eq=False)
class Sweep(Figured):
    """Figures of many cases of one scenario.

    Parameters
    ----------
    title : str
        Of the scenario.
    verb : str
        Whose figures they are: run, static, modes, critical-speed, plan, place.
    parameters : tuple of Parameter
        Those of a grid span one dimension each, in order; all that are drawn share the last, ``sample``.
    measures : mapping of str to (...) array
        By the measure's name; NaN where the case has none.
    units : mapping of str to str
        Of the measures; empty where there is none.
    outcome : (...) array of str
        Of each case: that of its verb (done, diverged, not converged), ``not accepted`` where limits of acceptance are
        not kept, ``machine limits exceeded`` or, of plan and place, ``limits exceeded``, ``refused`` where the scenario
        does not allow its values, ``failed`` where the computation broke down, ``pending`` where it has not been
        computed.
    message : (...) array of str
        Why a case is not done, or which limits it does not keep.
    histories : mapping of str to (..., t) array
        At the times `time`, which all cases share; NaN where the case has no value. Units are in `units`.
    time : (t,)
        s.
    statistics : mapping of str to Statistics
        Of measures and, at every time, of histories, where something is drawn: at every point of the grid.
    indices : mapping of str to Indices
        Sobol indices of the measures, of what the sampler saltelli draws.

    Examples
    --------
    >>> moduli = ["beam.material.youngs_modulus=60 GPa, 70 GPa, 80 GPa"]
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sweep(hub, moduli, ["modes[0].frequency"], verb="modes")
    >>> print(answer.measures["modes[0].frequency"].round(3), answer.units["modes[0].frequency"])
    [0.432 0.467 0.499] Hz
    """

    title: str
    verb: str
    parameters: tuple[Parameter, ...]
    measures: Mapping[str, Floats]
    units: Mapping[str, str]
    outcome: NDArray[Any]
    message: NDArray[Any]
    histories: Mapping[str, Floats] = field(default_factory=dict)
    time: Floats = field(default_factory=lambda: np.empty(0))
    statistics: Mapping[str, Statistics] = field(default_factory=dict)
    indices: Mapping[str, Indices] = field(default_factory=dict)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions of every array."""
        return tuple(dict.fromkeys(parameter.dimension for parameter in self.parameters))

    @property
    def counts(self) -> dict[str, int]:
        """How many cases ended how; ``done`` first."""
        names, numbers = np.unique(self.outcome.astype(str), return_counts=True)
        found = dict(zip(names.tolist(), numbers.tolist(), strict=True))
        return dict(sorted(found.items(), key=lambda each: (each[0] != "done", each[0])))

    @property
    def computed(self) -> Flags:
        """Which cases are computed to the end, whether or not they keep limits, (...)."""
        return np.isin(self.outcome.astype(str), ("done", *ANSWERED))

    @property
    def lost(self) -> int:
        """How many cases are not computed to the end."""
        return int((~self.computed).sum())

    @property
    def state(self) -> str:
        """How the sweep ended: done, some cases failed, or some cases not accepted."""
        if self.lost:
            return "some cases failed"
        return "done" if set(self.counts) <= {"done"} else "some cases not accepted"

    def __repr__(self) -> str:
        shape = " × ".join(f"{size} {name}" for name, size in zip(self.dimensions, self.outcome.shape, strict=True))
        ended = ", ".join(f"{number} {name}" for name, number in self.counts.items())
        words = f"Sweep of {self.verb} over {shape}: {ended}; {', '.join([*self.measures, *self.histories])}"
        return self._with_warnings(words)


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

    Examples
    --------
    >>> slew = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sensitivity(slew, ["modes[0].frequency"], ["beam.length"], verb="modes")
    >>> print(answer.relative.round(2))
    [[-2.]]
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
