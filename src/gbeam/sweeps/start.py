"""The first cases of a sweep: which figures the measures mean, their units, and how long a case takes.

They are computed once, as any other: their rows are part of the sweep.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gbeam.errors import GbeamError, InputError
from gbeam.scenario.build import build
from gbeam.scenario.schema.scenario import Scenario
from gbeam.sweeps.cases import Cases
from gbeam.sweeps.evaluate import NO_FACTS, Question, Row, ended, without_figures
from gbeam.sweeps.measures import find, unit_at

TRIED = 20  # cases, all over the sweep, of which one must be possible
_IMPORTS = 2.0  # s: a first case that takes less may be imports and compilation above all; another one is timed

Figures = Sequence[tuple[Sequence[str | int], str]]  # keys and unit of each, as a store keeps them


@dataclass(frozen=True)
class Start:
    """What the first cases show of the others.

    Parameters
    ----------
    question : Question
        With the keys of its figures.
    units : tuple of str
        Of the figures.
    example : Scenario
        Of a case that is possible.
    rows : tuple of Row
        Of the cases computed.
    seconds : float
        That a case takes.
    """

    question: Question
    units: tuple[str, ...]
    example: Scenario
    rows: tuple[Row, ...]
    seconds: float

    @property
    def figures(self) -> Figures:
        """Keys and unit of each figure; a function has no keys."""
        keys = self.question.keys or ((),) * len(self.units)
        return list(zip(keys, self.units, strict=True))


def start(question: Question, cases: Cases, missing: Sequence[int], names: Sequence[str]) -> Start:
    """Compute first cases until one is possible.

    Parameters
    ----------
    question : Question
        With its functions, if functions of the case are its measures; without keys.
    cases : Cases
    missing : sequence of int
        Cases not yet computed, one at least.
    names : sequence of str
        Of the measures.

    Raises
    ------
    InputError
        If a measure names no figure, or several.
    GbeamError
        What the first case raised, where none of 20 all over the sweep is possible.
    """
    reason: GbeamError | None = None
    rows: list[Row] = []
    for index in np.unique(np.linspace(0, len(missing) - 1, TRIED).astype(int)):
        number, begin = missing[index], time.perf_counter()
        try:
            scenario = question.scenario(cases.overrides(number))
            case = build(scenario)
            facts = NO_FACTS if question.functions else question.facts(case)
        except GbeamError as error:
            reason = reason or error
            rows.append(without_figures(number, len(names), error))
            continue
        units = ("",) * len(names)
        if not question.functions:
            try:
                keys = tuple(find(facts, name) for name in names)
            except InputError as error:
                if facts["outcome"] == "done":
                    raise
                reason = reason or error
                rows.append(Row(number, (math.nan,) * len(names), *ended(facts)))
                continue
            question, units = replace(question, keys=keys), tuple(unit_at(facts, each) for each in keys)
        rows.append(question.measured(number, case, facts))
        seconds = time.perf_counter() - begin
        after = missing[index + 1] if index + 1 < len(missing) else missing[0]
        if seconds < _IMPORTS and all(after != row.case for row in rows):
            row, seconds = _timed(question, cases, after)
            rows.append(row)
        return Start(question, units, scenario, tuple(rows), seconds)
    assert reason is not None
    raise reason


def go_on(question: Question, cases: Cases, missing: Sequence[int], done: Sequence[Row], figures: Figures) -> Start:
    """The same of a sweep some of whose cases are done, by which its figures are known; nothing may be missing."""
    question = replace(question, keys=tuple(tuple(keys) for keys, _ in figures if keys))
    possible = [row for row in done if row.outcome != "refused"] or done
    scenario = question.scenario(cases.overrides(possible[0].case))
    rows, seconds = [], 0.0
    for number in missing[:2]:
        row, seconds = _timed(question, cases, number)
        rows.append(row)
        if seconds >= _IMPORTS:
            break
    return Start(question, tuple(unit for _, unit in figures), scenario, tuple(rows), seconds)


def _timed(question: Question, cases: Cases, number: int) -> tuple[Row, float]:
    begin = time.perf_counter()
    row = question.row(number, cases.overrides(number))
    return row, time.perf_counter() - begin
