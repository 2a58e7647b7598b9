"""Design: the values of a scenario at which a figure is least within limits, by a search with exact derivatives."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.constants import Verb
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import KINDS, WRITTEN, kinds
from gbeam.guards.quantities import Seconds
from gbeam.guards.units import read_quantity
from gbeam.progress import Progress
from gbeam.questions import Options
from gbeam.results.criteria import BROKEN
from gbeam.results.result import Floats
from gbeam.results.searches import Optimum, Requirement
from gbeam.results.study import Study
from gbeam.studies.derivatives import Neighbourhood, Quantities
from gbeam.studies.evaluate import Inquiry
from gbeam.studies.figures import Facts, Keys, check_figures, unit_at
from gbeam.studies.parameters import Bounds, bounds_of, count_agreeing, on_bound, search_all, select_values
from gbeam.studies.sensitivity import facts_of, figure, needed_parts, values_at
from gbeam.studies.template import template_of

OPTION, SUBJECT = "--minimise", "--subject-to"
LIMITS = "limits"
_BOUND = re.compile(r"\s*(\S+)\s*(<=|>=)\s*(.+?)\s*")


@kinds(bounds=WRITTEN, options=WRITTEN)
@typed
def optimise(
    scenario: str | os.PathLike[str] | Case,
    minimise: str,
    over: Sequence[str],
    *,
    subject_to: Sequence[str] = (),
    bounds: Bounds | None = None,
    verb: Verb = "run",
    motion: str | None = None,
    at: Seconds | None = None,
    options: Options | None = None,
    starts: int = 1,
    overrides: Sequence[str] = (),
    progress: Progress = None,
) -> Optimum:
    """Find the values of a scenario at which a figure is least.

    The search (sequential least squares programming) goes from the scenario's values along exact derivatives, by the
    steps that the scenario's own run needs. The figures of the answer come from a run with its own. One
    start finds the nearest valley. Several, spread over the bounds, find others, and the answer says how many of them
    agree.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or a case, of :func:`gbeam.read_scenario` or made in Python.
    minimise : str
        A figure of the verb's JSON by the end of its path, such as ``tip.y.residual_amplitude``. Of a figure without a
        unit, such as ``verdict.root_moment``, the size is minimised.
    over : sequence of str
        Paths of the values to choose, such as ``motion.centrifuge.control_point``.
    subject_to : sequence of str
        Requirements: ``limits`` (of every machine), or ``FIGURE <= VALUE`` and ``>=``, with a unit or SI.
    bounds : mapping of str to a pair, optional
        By path, in SI or as text with a unit; a tenth to ten times the scenario's value where not given.
    verb, motion, at, options
        As for :func:`gbeam.sensitivity`.
    starts : int
        Searches: one from the scenario's values, the others from values spread over the bounds.
    overrides : sequence of str
        Changes of the scenario, such as ``beam.length=250 mm``.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Optimum
        Its outcome is ``limits exceeded`` where the search found no values that keep the requirements.

    Raises
    ------
    InputError
        If the scenario, a figure, a value, a bound or a requirement is wrong.
    ComputationError
        If the scenario's own run is not done.

    Examples
    --------
    >>> scenario = "examples/zhang2020_example1.toml"
    >>> over = ["motion.centrifuge.control_point"]
    >>> answer = gb.optimise(scenario, "verdict.tip", over, overrides=["response.step=5 ms"])
    >>> print(f"{1e3 * answer.values[0]:.1f} mm")
    37.5 mm
    """
    template = template_of(scenario, overrides)
    if not over:
        raise InputError("--over", "is missing", 'name values: --over "motion.centrifuge.control_point"')
    parameters = select_values(template, over, "--over")
    check_figures(verb, [minimise], OPTION)
    limits = np.array([bounds_of(parameter, bounds or {}, "--over") for parameter in parameters])
    inquiry = Inquiry(template, verb, motion, at, options or {})
    first_neighbourhood = Neighbourhood(inquiry, parameters, progress=progress)
    goal = _goal(facts_of(first_neighbourhood.answer), first_neighbourhood.case, minimise, subject_to)
    # The search computes only what its figures are read from; the last answer is whole.
    motions, parts = needed_parts(goal.keys, first_neighbourhood.case.tracks)
    model = Quantities(
        replace(inquiry, keys=goal.keys), parameters, goal.read, first_neighbourhood, motions, parts, progress=progress
    )
    search = Search(model, goal, limits)
    ends = search_all(parameters, limits, starts, search)
    values = search.tried[-1][0]
    last_neighbourhood = Neighbourhood(inquiry, parameters, values.tolist(), progress=progress)
    start_study, found_study = (
        values_at(facts_of(neighbourhood.answer), goal.keys)
        for neighbourhood in (first_neighbourhood, last_neighbourhood)
    )
    if last_neighbourhood.runs:
        for name in needed_parts(goal.keys, last_neighbourhood.case.tracks)[0]:
            last_neighbourhood.require_response(name)
    requirements = tuple(
        Requirement(
            name,
            unit_at(facts_of(last_neighbourhood.answer), keys),
            low,
            high,
            float(start_study[k]),
            float(found_study[k]),
        )
        for k, (name, keys, low, high) in enumerate(goal.required, 1)
    )
    broken = [requirement.name for requirement in requirements if not requirement.kept]
    paths = tuple(parameter.path for parameter in parameters)
    return Optimum(
        title=template.title(paths),
        minimise=minimise,
        unit=goal.unit,
        parameters=paths,
        units=tuple(parameter.unit for parameter in parameters),
        before=np.array([parameter.value for parameter in parameters]),
        values=values,
        bounds=limits,
        at_bound=on_bound(values, limits),
        figure_before=float(start_study[0]),
        figure=float(found_study[0]),
        error=_error(last_neighbourhood.answer),
        requirements=requirements,
        path=np.array([x for x, _ in search.tried]),
        history=np.array([f for _, f in search.tried]),
        evaluations=model.evaluations,
        starts=starts,
        agreed=count_agreeing(ends, values, limits),
        outcome=BROKEN if broken else "done",
        warnings=search.warnings + (() if not search.flat else (f"{minimise} does not depend on {', '.join(paths)}",)),
        notes=template.notes,
        provenance=template.provenance,
    )


def _error(answer: Any) -> float:
    """Largest estimated error of a study's responses, or NaN for other answers."""
    if not isinstance(answer, Study):
        return math.nan
    return max((response.error_estimate for response in answer.responses.values()), default=math.nan)


def _goal(facts: Facts, case: Case, minimise: str, subject_to: Sequence[str]) -> Goal:
    """Goal from the texts of objective and requirements. InputError unless their figures have values in `facts`."""
    objective = figure(facts, minimise, OPTION)
    required: list[tuple[str, Keys, float, float]] = []
    for text in subject_to:
        if text.strip() == LIMITS:
            limits = list(_machine_limits(facts))
            if not limits:
                fix = "give the machine's, or name figures: tip.z.max_abs <= 2 mm"
                raise InputError(SUBJECT, "names limits, of which the scenario has none", fix)
            required += limits
            continue
        bound = _BOUND.fullmatch(text)
        if bound is None:
            raise InputError(SUBJECT, f"is {text!r}", 'write "limits", or "tip.z.max_abs <= 2 mm"')
        keys = figure(facts, bound[1], SUBJECT)
        value = _bound(bound[3], unit_at(facts, keys), bound[1])
        required.append((bound[1], keys, -math.inf, value) if bound[2] == "<=" else (bound[1], keys, value, math.inf))
    return Goal(objective, tuple(required), unit_at(facts, objective))


def _machine_limits(facts: Facts) -> Any:
    """Yield name, keys and bounds of every finite limit of a machine, as the requirements of a Goal have them."""
    for name, motion in facts.get("motions", {}).items():
        for axis, uses in motion.get("limits", {}).items():
            for quantity, use in uses.items():
                if math.isfinite(use["allowed"]):
                    keys = ("motions", name, "limits", axis, quantity, "used")
                    yield f"{name}.limits.{axis}.{quantity}.used", keys, -math.inf, float(use["allowed"])


def _bound(text: str, unit: str, name: str) -> float:
    kind = "frequency" if unit == "Hz" else next((kind for kind, entry in KINDS.items() if entry.unit == unit), "ratio")
    return read_quantity(SUBJECT, text, kind, f"of {name}: ")


_PRECISE, _EVALUATIONS = 1e-7, 40  # of one search
_FEASIBLE = 1e-4  # of a bound, by which a requirement may be missed


@dataclass(frozen=True)
class Goal:
    """Objective and requirements."""

    objective: Keys
    required: tuple[tuple[str, Keys, float, float], ...]  # name, keys, lower and upper bound, one of them infinite
    unit: str  # of the objective

    @property
    def keys(self) -> tuple[Keys, ...]:
        """Keys of all figures, the objective first."""
        return (self.objective, *(keys for _, keys, _, _ in self.required))

    def read(self, _: Any, answer: Any) -> Floats:
        """Figures (1 + r,) of an answer, the objective first."""
        return values_at(facts_of(answer), self.keys)


class _Enough(Exception):
    """Raised to end a search after too many evaluations."""


@dataclass
class Search:
    """Search from any start, which keeps the tried values that were better than all before them."""

    model: Quantities
    goal: Goal
    limits: Floats
    tried: list[tuple[Floats, float]] = field(default_factory=list)  # values and objective
    ranks: list[tuple[float, float]] = field(default_factory=list)  # of those: excess over the bounds, cost
    warnings: tuple[str, ...] = ()
    flat: bool = True  # while no value tried has changed the objective

    def __call__(self, start: Floats) -> Floats:
        """Return the best values (p,) that a search from `start` (p,) has tried."""
        from scipy.optimize import minimize

        low, width = self.limits[:, 0], self.limits[:, 1] - self.limits[:, 0]
        sizes = self._sizes(self.model(start))
        begun = self.model.evaluations
        power = 1 if self.goal.unit else 2  # without a unit its size, by the square, which is smooth at zero
        best_case: tuple[float, float, Floats] | None = None
        slopes = self.model.slopes

        def objective(x: Floats) -> float:
            nonlocal best_case
            if self.model.evaluations - begun >= _EVALUATIONS:
                raise _Enough
            values = low + x * width
            figures = self.model(values)
            excess = float(max(0.0, *(-self._slack(figures) / sizes[1:]))) if self.goal.required else 0.0
            cost = abs(float(figures[0])) if power == 2 else float(figures[0])
            rank = (0.0 if excess <= _FEASIBLE else excess, cost)
            if best_case is None or rank < best_case[:2]:
                best_case = (*rank, values)
                if not self.ranks or rank < self.ranks[-1]:
                    self.ranks.append(rank)
                    self.tried.append((values, float(figures[0])))
            return float((figures[0] / sizes[0]) ** power)

        def gradient(x: Floats) -> Floats:
            values = low + x * width
            slope = slopes(values)[0] * width / sizes[0]
            self.flat = self.flat and not slope.any()
            return slope if power == 1 else 2 * self.model(values)[0] / sizes[0] * slope

        constraints: Any = ()
        if self.goal.required:
            constraints = {
                "type": "ineq",
                "fun": lambda x: self._slack(self.model(low + x * width)) / sizes[1:],
                "jac": lambda x: self._signs[:, None] * slopes(low + x * width)[1:] * width / sizes[1:, None],
            }
        try:
            optimum = minimize(
                objective, (start - low) / width, jac=gradient, method="SLSQP", bounds=[(0.0, 1.0)] * len(start),
                constraints=constraints, options={"ftol": _PRECISE},
            )  # fmt: skip
            end = "" if optimum.success else optimum.message.lower()
        except _Enough:
            end = f"after {_EVALUATIONS} evaluations"
        if end:
            self.warnings = (f"a search ended early ({end}); the best values tried are given",)
        assert best_case is not None
        return best_case[2]

    @property
    def _signs(self) -> Floats:
        return np.array([1.0 if math.isinf(high) else -1.0 for _, _, _, high in self.goal.required])

    def _slack(self, figures: Floats) -> Floats:
        """Distance (r,) of each required figure from its bound; negative where that is exceeded."""
        bounds = np.array([low if math.isinf(high) else high for _, _, low, high in self.goal.required])
        return np.asarray(self._signs * (figures[1:] - bounds))

    def _sizes(self, figures: Floats) -> Floats:
        """Scales of the figures (1 + r,), none zero: the objective's size, the bounds of the others."""
        sizes = [abs(figures[0]) or 1.0]
        for (_, _, low, high), value in zip(self.goal.required, figures[1:], strict=True):
            bound = low if math.isinf(high) else high
            sizes.append(abs(bound) or abs(value) or 1.0)
        return np.array(sizes)
