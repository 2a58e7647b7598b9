"""First cases of a sweep, which tell the keys and units of the measured figures, and how long a case takes.

They are computed only once: their rows are part of the sweep.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gbeam.analysis.case import Case
from gbeam.errors import GbeamError, InputError
from gbeam.studies.cases import Cases
from gbeam.studies.evaluate import NO_FACTS, Inquiry, Row, outcome_of, settle, width, without_figures
from gbeam.studies.evaluate import rows as computed
from gbeam.studies.figures import find, node_at, read_history, unit_at
from gbeam.studies.template import Template

_FEW = 8  # cases, at most, whose joint computation is timed
TRIED = 20  # cases, spread over the sweep, of which one must be possible
_IMPORTS = 2.0  # s: a first case that takes less may be mostly imports and compilation; another one is timed

# Keys, unit and true for a truth value, of each figure, as a store keeps them.
Figures = Sequence[tuple[Sequence[str | int], str, bool]]


@dataclass(frozen=True)
class OverTime:
    """Names of histories, and the number of times, over their responses in the first case, at which they are taken."""

    names: tuple[str, ...] = ()
    count: int = 0

    def add_to(self, inquiry: Inquiry, case: Case) -> Inquiry:
        """Return the inquiry with these histories, at times over their responses in `case`."""
        if not self.names:
            return inquiry
        histories = tuple(read_history(name, case) for name in self.names)
        settings = [case.settings_of(history.motion) for history in histories]
        first = min(response.start for response in settings)
        last = max(response.start + response.duration for response in settings)
        return replace(inquiry, histories=histories, times=np.linspace(first, last, self.count))


NO_HISTORIES = OverTime()


@dataclass(frozen=True)
class Start:
    """Inquiry with known figures, their units and kinds, an example of a case, the first rows, and seconds per case."""

    inquiry: Inquiry
    units: tuple[str, ...]
    truths: tuple[bool, ...]
    example: Template
    rows: tuple[Row, ...]
    seconds: float

    @property
    def figures(self) -> Figures:
        """Keys, unit and kind of each figure; a function has no keys."""
        keys = self.inquiry.keys or ((),) * len(self.units)
        return list(zip(keys, self.units, self.truths, strict=True))


def start(
    inquiry: Inquiry, cases: Cases, missing: Sequence[int], names: Sequence[str], histories: OverTime = NO_HISTORIES
) -> Start:
    """Compute cases, 20 at most, until one is possible; otherwise raise the error of the first."""
    reason: GbeamError | None = None
    rows: list[Row] = []
    figures = len(names) + len(histories.names) * histories.count
    for index in np.unique(np.linspace(0, len(missing) - 1, TRIED).astype(int)):
        number, begin = missing[index], time.perf_counter()
        try:
            example = inquiry.template.changed(cases.overrides(number))
            case = example.built()
            answered = histories.names or not inquiry.functions
            facts = inquiry.facts(case) if answered else NO_FACTS
        except GbeamError as error:
            reason = reason or error
            rows.append(without_figures(number, figures, error))
            continue
        units, truths = ("",) * len(names), (False,) * len(names)
        if not inquiry.functions:
            try:
                keys = tuple(find(facts, name) for name in names)
            except InputError as error:
                if facts["outcome"] == "done":
                    raise
                reason = reason or error
                rows.append(Row(number, (math.nan,) * figures, *outcome_of(facts)))
                continue
            inquiry = replace(inquiry, keys=keys)
            units = tuple(unit_at(facts, figure_keys) for figure_keys in keys)
            truths = tuple(isinstance(node_at(facts, figure_keys), bool) for figure_keys in keys)
        inquiry = settle(histories.add_to(inquiry, case), case, len(cases))
        task = (number, cases.overrides(number))
        rows += computed(inquiry, [task]) if inquiry.together else (inquiry.measured(number, case, facts),)
        seconds = time.perf_counter() - begin
        next_cases = missing[index + 1 : index + 1 + min(_FEW, width(inquiry))] or missing[:1]
        next_cases = [candidate for candidate in next_cases if all(candidate != row.case for row in rows)]
        if next_cases and (seconds < _IMPORTS or inquiry.together):
            timed, seconds = _timed(inquiry, cases, next_cases)
            rows += timed
        return Start(inquiry, units, truths, example, tuple(rows), seconds)
    assert reason is not None
    raise reason


def go_on(
    inquiry: Inquiry,
    cases: Cases,
    missing: Sequence[int],
    done: Sequence[Row],
    figures: Figures,
    histories: OverTime = NO_HISTORIES,
) -> Start:
    """Start of a resumed sweep, with the time that a first few of its `missing` cases take, if there are any.

    Its `figures` are known from the cases `done`.
    """
    inquiry = replace(inquiry, keys=tuple(tuple(keys) for keys, *_ in figures if keys))
    possible = [row for row in done if row.outcome != "refused"] or done
    example = inquiry.template.changed(cases.overrides(possible[0].case))
    if histories.names or inquiry.together:
        case = example.built()
        inquiry = settle(histories.add_to(inquiry, case), case, len(cases))
    rows: list[Row] = []
    seconds = 0.0
    count = min(_FEW, width(inquiry))
    # The first time includes imports and compilation. Where these may be most of it, a second batch is timed.
    for begin in (0, count):
        chosen = missing[begin : begin + count]
        if chosen:
            timed, seconds = _timed(inquiry, cases, chosen)
            rows += timed
        if seconds >= _IMPORTS:
            break
    units = tuple(unit for _, unit, _ in figures)
    truths = tuple(truth for *_, truth in figures)
    return Start(inquiry, units, truths, example, tuple(rows), seconds)


def _timed(inquiry: Inquiry, cases: Cases, numbers: Sequence[int]) -> tuple[list[Row], float]:
    """Rows of cases, and the mean time that one of them took, s."""
    begin = time.perf_counter()
    rows = list(computed(inquiry, [(number, cases.overrides(number)) for number in numbers]))
    return rows, (time.perf_counter() - begin) / len(numbers)
