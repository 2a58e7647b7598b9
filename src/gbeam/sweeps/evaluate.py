"""One case, from the scenario's text to its figures: what a worker computes, in this process or another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from gbeam.analysis.study.case import Case
from gbeam.errors import ComputationError, GbeamError
from gbeam.scenario.build import build
from gbeam.scenario.load import change
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.text.source import Source
from gbeam.sweeps.answers import VERBS, Facts
from gbeam.sweeps.measures import Keys, value_at

Function = Callable[[Case], float]


@dataclass(frozen=True)
class Row:
    """What one case gave: its figures, how it ended, and why it is not done."""

    case: int
    values: tuple[float, ...]
    outcome: str
    message: str = ""


@dataclass(frozen=True)
class Question:
    """What is computed of every case.

    Parameters
    ----------
    source : Source
        The scenario, parsed once, with the changes that all cases share.
    verb : str
    motion : str or None
    at : float or None
        Time at which the motion is frozen, s; the start of the response by default.
    keys : tuple of keys
        Of the figures in the verb's JSON.
    functions : tuple of callable
        Of the case: further figures.
    """

    source: Source
    verb: str
    motion: str | None
    at: float | None = None
    keys: tuple[Keys, ...] = ()
    functions: tuple[Function, ...] = field(default=())

    @cached_property
    def width(self) -> int:
        """How many figures a case has."""
        return len(self.keys) + len(self.functions)

    def scenario(self, overrides: Sequence[str]) -> Scenario:
        """One case's scenario, validated."""
        return change(self.source, overrides)

    def case(self, overrides: Sequence[str]) -> Case:
        """The objects of one case.

        Raises
        ------
        ScenarioError
            If the scenario does not allow these values.
        """
        return build(self.scenario(overrides))

    def facts(self, case: Case) -> Facts:
        """What the verb answers, as JSON."""
        return VERBS[self.verb](case, self.motion, self.at)

    def row(self, number: int, overrides: Sequence[str]) -> Row:
        """Compute one case. What goes wrong in it is part of the row: the other cases go on."""
        nothing = (math.nan,) * self.width
        try:
            case = self.case(overrides)
        except GbeamError as error:
            return Row(number, nothing, "refused", _line(error))
        try:
            facts: Facts = self.facts(case) if self.keys else {"outcome": "done"}
            values = [value_at(facts, keys) for keys in self.keys] + [float(each(case)) for each in self.functions]
        except ComputationError as error:
            return Row(number, nothing, error.outcome, _line(error))
        except GbeamError as error:
            return Row(number, nothing, "refused", _line(error))
        except Exception as error:  # a defect, or a measure's own: named in the result
            return Row(number, nothing, "failed", f"{type(error).__name__}: {_line(error)}")
        return Row(number, tuple(values), str(facts["outcome"]), str(facts.get("message") or ""))


def rows(question: Question, tasks: Sequence[tuple[int, tuple[str, ...]]]) -> list[Row]:
    """Compute some cases: a number and its changes each."""
    return [question.row(number, overrides) for number, overrides in tasks]


def _line(error: Exception) -> str:
    """First line of a message; a scenario's shows the source on the others."""
    text = str(error).strip()
    return text.splitlines()[0] if text else type(error).__name__
