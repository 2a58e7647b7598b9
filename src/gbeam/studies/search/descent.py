"""From some values of a scenario down to the least of a figure, along exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gbeam.analysis.response.tangents.differentiated import Grid
from gbeam.analysis.study.case import Case
from gbeam.errors import ComputationError, GbeamError
from gbeam.mechanics.models import Model
from gbeam.progress import Progress
from gbeam.results.result import Floats
from gbeam.studies.derivatives import Neighbourhood
from gbeam.studies.parameters import PhysicalValue
from gbeam.studies.search.starts import starting_points
from gbeam.studies.sensitivity import facts_of, needed, values_at
from gbeam.sweeps.computing.evaluate import Question
from gbeam.sweeps.figures.measures import Keys

_PRECISE, _EVALUATIONS = 1e-7, 40  # of one search
_FEASIBLE = 1e-4  # of a bound: less is no excess


@dataclass(frozen=True)
class Goal:
    """What is minimised, and what is required."""

    objective: Keys
    required: tuple[tuple[str, Keys, float, float], ...]
    unit: str

    @property
    def keys(self) -> tuple[Keys, ...]:
        """Of all figures, the objective first."""
        return (self.objective, *(keys for _, keys, _, _ in self.required))


class _Enough(Exception):
    """A search that has evaluated the scenario so often that it will not end."""


@dataclass
class Search:
    """The search, which keeps what it has tried."""

    question: Question
    parameters: Sequence[PhysicalValue]
    goal: Goal
    first: Neighbourhood
    progress: Progress
    evaluations: int = 0
    tried: list[tuple[Floats, float]] = field(default_factory=list)
    ranks: list[tuple[float, float]] = field(default_factory=list)  # of those tried, each better than before
    warnings: tuple[str, ...] = ()
    _last: tuple[Floats, Floats, Neighbourhood] | None = None

    def __post_init__(self) -> None:
        self.motions, self.parts = needed(self.goal.keys, self.first.case.tracks)
        self.shapes: Model = self.first.case.model
        self.grids: Mapping[str, Grid] | None = None
        if self.question.verb == "run":
            self.grids = {name: self.first.grid(name) for name in self.motions}

    def best(self, limits: Floats, count: int) -> tuple[Floats, list[Floats]]:
        """The best values within bounds (p, 2) of so many searches, and where each of them ended."""
        own = np.array([each.value for each in self.parameters])
        ends = []
        for k, start in enumerate(starting_points(own, limits, count)):
            try:
                ends.append(self._from(start, limits))
            except GbeamError:  # values that the scenario does not allow, or whose run is not done
                if k == 0:
                    raise
        return self.tried[-1][0], ends

    def _from(self, start: Floats, limits: Floats) -> Floats:
        """Where a search from some values ends."""
        from scipy.optimize import minimize

        low, width = limits[:, 0], limits[:, 1] - limits[:, 0]
        sizes = self._sizes(self.figures(start))
        begun = self.evaluations
        power = 1 if self.goal.unit else 2  # of what has no unit, the size: its square is smooth at zero
        best: tuple[float, float, Floats] | None = None

        def objective(x: Floats) -> float:
            nonlocal best
            if self.evaluations - begun >= _EVALUATIONS:
                raise _Enough
            values = low + x * width
            figures = self.figures(values)
            excess = float(max(0.0, *(-self._slack(figures) / sizes[1:]))) if self.goal.required else 0.0
            rank = (0.0 if excess <= _FEASIBLE else excess, abs(float(figures[0])) if power == 2 else float(figures[0]))
            if best is None or rank < best[:2]:
                best = (*rank, values)
                if not self.ranks or rank < self.ranks[-1]:
                    self.ranks.append(rank)
                    self.tried.append((values, float(figures[0])))
            return float((figures[0] / sizes[0]) ** power)

        def gradient(x: Floats) -> Floats:
            values = low + x * width
            slope = self.slopes(values)[0] * width / sizes[0]
            return slope if power == 1 else 2 * self.figures(values)[0] / sizes[0] * slope

        constraints: Any = ()
        if self.goal.required:
            constraints = {
                "type": "ineq",
                "fun": lambda x: self._slack(self.figures(low + x * width)) / sizes[1:],
                "jac": lambda x: self._signs[:, None] * self.slopes(low + x * width)[1:] * width / sizes[1:, None],
            }
        try:
            found = minimize(
                objective, (start - low) / width, jac=gradient, method="SLSQP", bounds=[(0.0, 1.0)] * len(start),
                constraints=constraints, options={"ftol": _PRECISE},
            )  # fmt: skip
            end = "" if found.success else found.message.lower()
        except _Enough:
            end = f"after {_EVALUATIONS} evaluations"
        if end:
            self.warnings = (f"a search ended early ({end}); the best values tried are given",)
        assert best is not None
        return best[2]

    @property
    def _signs(self) -> Floats:
        return np.array([1.0 if math.isinf(high) else -1.0 for _, _, _, high in self.goal.required])

    def _slack(self, figures: Floats) -> Floats:
        """By how much every requirement is kept; negative where it is not."""
        ends = np.array([low if math.isinf(high) else high for _, _, low, high in self.goal.required])
        return np.asarray(self._signs * (figures[1:] - ends))

    def _sizes(self, figures: Floats) -> Floats:
        """Sizes of the figures: the objective's own, the bounds of the others."""
        ends = [abs(low if math.isinf(high) else high) for _, _, low, high in self.goal.required]
        others = [end or abs(value) or 1.0 for end, value in zip(ends, figures[1:], strict=True)]
        return np.array([abs(figures[0]) or 1.0, *others])

    def figures(self, values: Floats) -> Floats:
        """Objective and required figures at some values."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self.evaluations += 1
            about = Neighbourhood(
                self.question, self.parameters, values.tolist(), grids=self.grids, parts=self.parts,
                adapt=self._shaped, progress=self.progress,
            )  # fmt: skip
            for name in self.motions if self.grids is not None else ():
                about.done(name)
            found = values_at(facts_of(about.answer), self.goal.keys)
            if not np.isfinite(found).all():
                raise ComputationError("not converged", "a figure of the search has no value")
            self._last = values.copy(), found, about
        return self._last[1]

    def slopes(self, values: Floats) -> Floats:
        """Their derivatives, (figures, p)."""
        self.figures(values)
        assert self._last is not None

        def read(_: Case, answer: Any) -> Floats:
            return values_at(facts_of(answer), self.goal.keys)

        return self._last[2].slopes(read, self.motions).slopes

    def _shaped(self, case: Case) -> Case:
        return replace(case, model=self.shapes)
