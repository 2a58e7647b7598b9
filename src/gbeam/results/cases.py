"""Figures of many cases: sensitivities, sweeps, and what samples say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.guards.arguments import typed
from gbeam.guards.checks import index_of
from gbeam.results.criteria import BROKEN, EXCEEDED, NOT_ACCEPTED, NOT_DECIDED
from gbeam.results.declared import BESIDE, declared, fact, labels, quantity, rows
from gbeam.results.result import Figured, Flags, Floats, Part

CONFIDENCE = 0.95
BOUNDS = ("estimate", "low", "high")
MEAN, SPREAD, PROBABILITY = "mean", "standard deviation", "probability"
QUANTILES = {"5 %": 0.05, "median": 0.5, "95 %": 0.95}
ORDERS = ("first", "total")


@dataclass(frozen=True, repr=False, eq=False)
class Statistics(Part):
    """Estimates of a figure's distribution at every point of a sweep's grid."""

    names: tuple[str, ...] = labels(
        "mean, standard deviation, quantiles (5 %, median, 95 %); or probability, of what is true or not", "statistic"
    )
    values: Floats = quantity(
        "", "estimate, and the ends of its interval of 95 % confidence; NaN of too few draws", "... statistic bound"
    )
    count: NDArray[np.int_] = quantity("", "draws with a figure", "...")

    def __getitem__(self, name: str) -> Floats:
        """Estimate of one name and its bounds, (..., 3)."""
        return np.asarray(self.values[..., self.names.index(name), :])


@dataclass(frozen=True, repr=False, eq=False)
class Indices(Part):
    """Sobol indices of a figure: which share of its variance each parameter makes."""

    parameters: tuple[str, ...] = labels("paths", "parameter")
    values: Floats = quantity(
        "", "share by itself (first) and with all that it acts with (total)", "... parameter order bound"
    )
    count: NDArray[np.int_] = quantity("", "base samples of which all cases have a figure", "...")


SAMPLE = "sample"  # the dimension of what is drawn from distributions
# Outcomes of cases that are computed to the end, with every figure, and do not keep limits.
ANSWERED = (NOT_ACCEPTED, NOT_DECIDED, EXCEEDED, BROKEN)


@dataclass(frozen=True, repr=False, eq=False)
class Parameter(Part):
    """One value of the scenario that varies."""

    path: str = quantity("", "its key, such as motion.centrifuge.arm")
    values: NDArray[Any] = quantity("", "numbers in the unit, or words", "value")
    unit: str = quantity(
        "", "unit as written, such as g/s; the SI unit where none was; empty for words and plain numbers", default=""
    )
    drawn: str = quantity("", "distribution that the values are drawn from; empty for a grid", key=None, default="")

    @declared("", "distribution that the values are drawn from", role="fact")
    def distribution(self) -> str | None:
        """The distribution, or None for a grid."""
        return self.drawn or None

    @property
    def numeric(self) -> bool:
        """True if the values are numbers."""
        return bool(np.issubdtype(self.values.dtype, np.number))

    @property
    def dimension(self) -> str:
        """Dimension of the result along which it varies."""
        return SAMPLE if self.drawn else self.path


@dataclass(frozen=True, repr=False, eq=False)
class Measured(Part):
    """A figure of every case."""

    unit: str = quantity("", "its unit; empty where it has none")
    values: Floats = quantity(BESIDE, "values along the parameters, in their order", "case")


def _bounds(values: Floats) -> dict[str, Any]:
    return dict(zip(BOUNDS, np.moveaxis(values, -1, 0), strict=True))


@dataclass(frozen=True, repr=False, eq=False)
class Sweep(Figured[str]):
    """Figures of many cases of one scenario.

    Examples
    --------
    >>> moduli = ["beam.material.youngs_modulus=60 GPa, 70 GPa, 80 GPa"]
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sweep(hub, moduli, ["modes[0].frequency"], verb="modes")
    >>> print(answer.measures["modes[0].frequency"].round(3), answer.units["modes[0].frequency"])
    [0.432 0.467 0.499] Hz
    """

    title: str = fact("title of the scenario")
    verb: str = fact("question that the figures answer")
    parameters: tuple[Parameter, ...] = rows(
        "values that vary", "parameter",
        note="those of a grid span one dimension each, in order; all that are drawn share the last, sample",
    )  # fmt: skip
    measures: Mapping[str, Floats] = fact("figures by name", key=None, note="NaN where the case has none")
    units: Mapping[str, str] = fact("units of measures and histories by name", key=None)
    outcome: NDArray[Any] = quantity(
        "",
        "how each case ended",
        "case",
        key="outcomes",
        note="as its verb: done, diverged, not converged, not known; NOT ACCEPTED where limits of acceptance are not "
        "kept, or the machine's are exceeded, NOT DECIDED where a value is not known; of place limits exceeded; "
        "refused where the scenario does not allow its values; failed where the computation broke down; pending where "
        "it has not been computed",
    )
    message: NDArray[Any] = quantity(
        "", "why a case is not done, or which limits it does not keep", "case", key="messages"
    )
    histories: Mapping[str, Floats] = fact(
        "histories by name", key=None, note="at `time`, NaN where the case has no value", default_factory=dict
    )
    time: Floats = quantity("s", "times of the histories", "time", empty=True, key="")
    statistics: Mapping[str, Statistics] = fact(
        "statistics of measures and histories, where something is drawn: at every point of the grid",
        key=None,
        default_factory=dict,
    )
    indices: Mapping[str, Indices] = fact(
        "Sobol indices of the measures, of what the sampler saltelli draws", key=None, default_factory=dict
    )

    @declared("", "figures by name", "measure", role="rows", key="measures")
    def measured(self) -> Mapping[str, Measured]:
        return {name: Measured(self.units[name], values) for name, values in self.measures.items()}

    @declared("", "units of the histories by name", role="fact", key="histories")
    def recorded(self) -> Mapping[str, Mapping[str, str]]:
        return {name: {"unit": self.units[name]} for name in self.histories}

    @declared("", "estimates by name with their bounds; lists along the grid", role="fact", key="statistics")
    def estimates(self) -> Mapping[str, Mapping[str, Any]]:
        """Every estimate by name with its bounds; lists along the grid, and along the times of a history."""
        estimates: dict[str, dict[str, Any]] = {}
        for name, statistics in self.statistics.items():
            bounds = {kind: _bounds(statistics[kind]) for kind in statistics.names}
            estimates[name] = {"draws": statistics.count, **bounds}
        return estimates

    @declared("", "Sobol indices by measure, parameter and order; lists along the grid", role="fact", key="indices")
    def shares(self) -> Mapping[str, Mapping[str, Any]]:
        """First and total index of every parameter with its bounds; lists along the grid."""
        shares: dict[str, dict[str, Any]] = {}
        for name, indices in self.indices.items():
            shares[name] = {}
            for k, path in enumerate(indices.parameters):
                orders = indices.values[..., k, :, :]
                shares[name][path] = {order: _bounds(orders[..., i, :]) for i, order in enumerate(ORDERS)}
        return shares

    @declared("", "dimensions of every list", role="fact")
    def dimensions(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(parameter.dimension for parameter in self.parameters))

    @declared("", "how many cases ended how", role="fact")
    def counts(self) -> dict[str, int]:
        """Numbers of cases by their outcome; ``done`` first."""
        names, numbers = np.unique(self.outcome.astype(str), return_counts=True)
        counts = dict(zip(names.tolist(), numbers.tolist(), strict=True))
        return dict(sorted(counts.items(), key=lambda item: (item[0] != "done", item[0])))

    @property
    def computed(self) -> Flags:
        """Flags of the cases that are computed to the end, whether or not they keep limits, (...)."""
        return np.isin(self.outcome.astype(str), ("done", *ANSWERED))

    @property
    def failure_count(self) -> int:
        """Number of cases that are not computed to the end."""
        return int((~self.computed).sum())

    @property
    def state(self) -> str:
        """Outcome of the sweep: done, some cases failed, or some cases not accepted."""
        if self.failure_count:
            return "some cases failed"
        return "done" if set(self.counts) <= {"done"} else "some cases not accepted"

    def __repr__(self) -> str:
        shape = " × ".join(f"{size} {name}" for name, size in zip(self.dimensions, self.outcome.shape, strict=True))
        ended = ", ".join(f"{number} {name}" for name, number in self.counts.items())
        words = f"Sweep of {self.verb} over {shape}: {ended}; {', '.join([*self.measures, *self.histories])}"
        return self._with_warnings(words)


@dataclass(frozen=True, repr=False, eq=False)
class Effect(Part):
    """Effect of a parameter on a figure."""

    path: str = quantity("", "path in the scenario")
    value: float = quantity(BESIDE, "value of the parameter")
    unit: str = quantity("", "its SI unit")
    derivative: float = quantity("", "derivative, SI")
    relative: float = quantity("", "relative change of the figure over that of the parameter")
    error: float = quantity("", "how far differences of two orders are apart; none of an exact derivative")
    method: str = quantity("", "exact or difference")
    kink: bool = quantity("", "whether the slopes on either side differ")


@dataclass(frozen=True, repr=False, eq=False)
class Effects(Part):
    """A figure, and the effects of parameters on it."""

    value: float = quantity(BESIDE, "value of the figure")
    unit: str = quantity("", "its SI unit")
    parameters: tuple[Effect, ...] = rows("effects of the parameters, the largest first", "parameter")


@dataclass(frozen=True, repr=False, eq=False)
class Sensitivity(Figured[str]):
    """Derivatives of figures of one scenario with respect to physical values in it.

    Examples
    --------
    >>> slew = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sensitivity(slew, ["modes[0].frequency"], ["beam.length"], verb="modes")
    >>> print(answer.relative.round(2))
    [[-2.]]
    """

    title: str = fact("title of the scenario")
    verb: str = fact("question that the figures answer")
    measures: tuple[str, ...] = labels("names of the figures", "measure")
    units: tuple[str, ...] = quantity("", "SI unit of the measure", "measure", name="figure_unit", key=None)
    figures: Floats = quantity("", "value of the measure, in its unit", "measure", name="figure", key=None)
    parameters: tuple[str, ...] = labels("paths in the scenario", "parameter")
    parameter_units: tuple[str, ...] = quantity(
        "", "SI unit of the parameter", "parameter", name="value_unit", key=None
    )
    values: Floats = quantity("", "value of the parameter, in its unit", "parameter", name="value", key=None)
    derivatives: Floats = quantity(
        "", "derivative, in the measure's unit over the parameter's", "measure parameter", name="derivative", key=None
    )
    errors: Floats = quantity(
        "",
        "how far differences of two orders are apart; none of an exact derivative",
        "measure parameter",
        name="error",
        key=None,
    )
    methods: tuple[str, ...] = quantity("", "exact derivative, or difference", "parameter", name="method", key=None)
    kinks: Flags = quantity(
        "",
        "whether the slopes on either side differ",
        "measure parameter",
        name="kink",
        key=None,
        flags=("smooth", "kink"),
        note="the derivative is then their mean",
    )
    run_error: float = fact(
        "estimated error of the runs that the figures are read from",
        note="the largest of displacement and loads, relative to their largest; NaN of other verbs. Exact derivatives "
        "are those of these runs and have no error of their own",
        default=np.nan,
    )
    not_varied: tuple[str, ...] = fact(
        "values of the scenario that may not be a little more or less, and why; they have no derivative", default=()
    )

    @declared("", "figures, and the parameters that matter most to each first", "measure", role="rows", name=None,
              key="measures")  # fmt: skip
    def effects(self) -> Mapping[str, Effects]:
        answers = {}
        for k, name in enumerate(self.measures):
            effects = tuple(self._effect(k, j) for j in self.ranked(name))
            answers[name] = Effects(float(self.figures[k]), self.units[k], effects)
        return answers

    def _effect(self, k: int, j: int) -> Effect:
        """Effect of parameter j on measure k."""
        return Effect(
            path=self.parameters[j],
            value=float(self.values[j]),
            unit=self.parameter_units[j],
            derivative=float(self.derivatives[k, j]),
            relative=float(self.relative[k, j]),
            error=float(self.errors[k, j]),
            method=self.methods[j],
            kink=bool(self.kinks[k, j]),
        )

    @declared("", "relative change of the measure over that of the parameter", "measure parameter", key=None)
    def relative(self) -> Floats:
        """Relative change of each figure over that of each parameter, p/f ∂f/∂p, (m, p),
        or NaN where a figure is zero.
        """
        size = np.where(self.figures == 0, np.nan, self.figures)
        return self.derivatives * self.values / size[:, None]

    @typed
    def ranked(self, measure: str = "") -> NDArray[np.intp]:
        """Indices of the parameters by how much one percent of each changes a `measure`, the first by default."""
        k = index_of("measure", measure, self.measures) if measure else 0
        return np.argsort(-np.abs(self.derivatives[k] * self.values), kind="stable")

    def __repr__(self) -> str:
        leading = self.ranked()[:3]
        shares = ", ".join(f"{self.parameters[j]} {self.relative[0, j]:+.3g} %/%" for j in leading)
        subject = f"{', '.join(self.measures)} to {len(self.parameters)} values"
        return self._with_warnings(f"Sensitivity of {subject}: {self.measures[0]} by {shares}")
