"""Design: the values of a scenario at which a figure is least, within limits."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.study.case import Case
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.progress import Progress
from gbeam.results.studies.optimum import BROKEN, Optimum, Requirement
from gbeam.results.study import Study
from gbeam.scenario.build import scenario_of
from gbeam.scenario.origin import provenance
from gbeam.scenario.values.kinds import KINDS
from gbeam.scenario.values.units import UnitError, argument
from gbeam.studies.derivatives import Neighbourhood
from gbeam.studies.search.bounds import Bounds, bounds_of, named
from gbeam.studies.search.descent import Goal, Search
from gbeam.studies.search.starts import agreeing
from gbeam.studies.sensitivity import facts_of, figure, needed, values_at
from gbeam.sweeps.computing.evaluate import Question
from gbeam.sweeps.figures.answers import Facts
from gbeam.sweeps.figures.measures import Keys, unit_at

OPTION, SUBJECT = "--minimise", "--subject-to"
LIMITS = "limits"
_BOUND = re.compile(r"\s*(\S+)\s*(<=|>=)\s*(.+?)\s*")


@typed
def optimise(
    scenario: str | os.PathLike[str] | Case,
    minimise: str,
    over: Sequence[str],
    *,
    subject_to: Sequence[str] = (),
    bounds: Bounds | None = None,
    verb: str = "run",
    motion: str | None = None,
    at: float | None = None,
    starts: int = 1,
    overrides: Sequence[str] = (),
    progress: Progress = None,
) -> Optimum:
    """Find the values of a scenario at which a figure is least.

    The search (sequential least squares programming) goes from the scenario's values along exact derivatives, by the
    steps that the scenario's own run needs; the figures of the answer come from a run with its own. One
    start finds the nearest valley; several, spread over the bounds, find others, and the answer says how many of them
    agree.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or what :func:`gbeam.read_scenario` makes of it.
    minimise : str
        A figure of the verb's JSON by the end of its path, such as ``tip.y.residual_amplitude``. Of a figure without a
        unit, such as ``verdict.root_moment``, the size is minimised.
    over : sequence of str
        Paths of the values to choose, such as ``motion.centrifuge.control_point``.
    subject_to : sequence of str
        Requirements: ``limits`` (of every machine), or ``FIGURE <= VALUE`` and ``>=``, with a unit or SI.
    bounds : mapping of str to a pair, optional
        By path, in SI or as text with a unit; a tenth to ten times the scenario's value where not given.
    verb, motion, at
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
    InputError, ScenarioError
        If the scenario, a figure, a value, a bound or a requirement is wrong.
    ComputationError
        If the scenario's own run is not done.
    """
    base = scenario_of(scenario, overrides)
    assert base.source is not None  # it was read from a file
    if not over:
        raise InputError("--over", "is missing", 'name values: --over "motion.centrifuge.control_point"')
    parameters = named(base, over, "--over")
    limits = np.array([bounds_of(each, bounds or {}, "--over") for each in parameters])
    question = Question(base.source, verb, motion, at)
    first = Neighbourhood(question, parameters, progress=progress)
    goal = _goal(facts_of(first.answer), first.case, minimise, subject_to)
    # On the way no more is computed than is read; the last answer is whole.
    search = Search(replace(question, keys=goal.keys), parameters, goal, first, progress)
    values, ends = search.best(limits, starts)
    last = Neighbourhood(question, parameters, values.tolist(), progress=progress)
    before, after = (values_at(facts_of(each.answer), goal.keys) for each in (first, last))
    if verb == "run":
        for name in needed(goal.keys, last.case.tracks)[0]:
            last.done(name)
    requirements = tuple(
        Requirement(name, unit_at(facts_of(last.answer), keys), low, high, float(before[k]), float(after[k]))
        for k, (name, keys, low, high) in enumerate(goal.required, 1)
    )
    reach = 1e-6 * (limits[:, 1] - limits[:, 0])
    broken = [each.name for each in requirements if not each.kept]
    return Optimum(
        title=base.title,
        minimise=minimise,
        unit=goal.unit,
        parameters=tuple(each.path for each in parameters),
        units=tuple(each.unit for each in parameters),
        before=np.array([each.value for each in parameters]),
        values=values,
        bounds=limits,
        at_bound=(values - limits[:, 0] < reach) | (limits[:, 1] - values < reach),
        figure_before=float(before[0]),
        figure=float(after[0]),
        error=_error(last.answer),
        requirements=requirements,
        path=np.array([x for x, _ in search.tried]),
        history=np.array([f for _, f in search.tried]),
        evaluations=search.evaluations,
        starts=starts,
        agreed=agreeing(ends, values, limits),
        outcome=BROKEN if broken else "done",
        warnings=search.warnings,
        provenance=provenance(base),
    )


def _error(answer: Any) -> float:
    if not isinstance(answer, Study):
        return math.nan
    return max((each.error_estimate for each in answer.responses.values()), default=math.nan)


def _goal(facts: Facts, case: Case, minimise: str, subject_to: Sequence[str]) -> Goal:
    objective = figure(facts, minimise, OPTION)
    required: list[tuple[str, Keys, float, float]] = []
    for text in subject_to:
        if text.strip() == LIMITS:
            found = list(_machine_limits(facts))
            if not found:
                fix = "give the machine's, or name figures: tip.z.max_abs <= 2 mm"
                raise InputError(SUBJECT, "names limits, of which the scenario has none", fix)
            required += found
            continue
        match = _BOUND.fullmatch(text)
        if match is None:
            raise InputError(SUBJECT, f"is {text!r}", 'write "limits", or "tip.z.max_abs <= 2 mm"')
        keys = figure(facts, match[1], SUBJECT)
        value = _bound(match[3], unit_at(facts, keys), match[1])
        required.append((match[1], keys, -math.inf, value) if match[2] == "<=" else (match[1], keys, value, math.inf))
    return Goal(objective, tuple(required), unit_at(facts, objective))


def _machine_limits(facts: Facts) -> Any:
    for name, motion in facts.get("motions", {}).items():
        for axis, uses in motion.get("limits", {}).items():
            for quantity, use in uses.items():
                if math.isfinite(use["allowed"]):
                    keys = ("motions", name, "limits", axis, quantity, "used")
                    yield f"{name}.limits.{axis}.{quantity}.used", keys, -math.inf, float(use["allowed"])


def _bound(text: str, unit: str, name: str) -> float:
    kind = "frequency" if unit == "Hz" else next((kind for kind, each in KINDS.items() if each.unit == unit), "ratio")
    try:
        return argument(text, kind)
    except UnitError as error:
        raise InputError(SUBJECT, f"of {name}: {error.problem}", error.hint) from None
