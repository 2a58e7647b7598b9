"""One case, from the scenario's text to its figures: what a worker computes, in this process or another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from gbeam.analysis.study.case import Case
from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.results.result import Floats
from gbeam.results.studies.sweep import ANSWERED
from gbeam.scenario.build import build
from gbeam.scenario.load import change
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.text.source import Source
from gbeam.scenario.values.suggest import advise
from gbeam.sweeps.figures.answers import VERBS, Facts, Needs
from gbeam.sweeps.figures.histories import History
from gbeam.sweeps.figures.measures import Keys, own_keys, value_at

Function = Callable[[Case], float]
NO_FACTS: Facts = {"outcome": "done"}  # where functions measure the case, no verb answers
# Figures of a motion, and of a comparison, which are the same to the last digit where no loads are computed.
_WITHOUT_LOADS = ("tip", "stations", "hub", "step", "steps", "damping_ratio", "axes", "limits", "tracking_error")
_VERDICT_WITHOUT_LOADS = (("verdict", "tip"), ("verdict", "followed"))


@dataclass(frozen=True)
class Row:
    """What one case gave: its figures, how it ended, and why it is not done or which limits it does not keep."""

    case: int
    values: tuple[float, ...]
    outcome: str
    message: str = ""

    @property
    def failed(self) -> bool:
        """Whether it has come to nothing, or was cut off."""
        return self.outcome not in ("done", *ANSWERED)


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
    histories : tuple of History
        Further figures, one for each of `times`.
    times : (t,)
        s.
    together : bool
        Whether cases that can be are integrated together.
    """

    source: Source
    verb: str
    motion: str | None
    at: float | None = None
    keys: tuple[Keys, ...] = ()
    functions: tuple[Function, ...] = ()
    histories: tuple[History, ...] = ()
    times: Floats = field(default_factory=lambda: np.empty(0))
    together: bool = False

    def __post_init__(self) -> None:
        if self.verb not in VERBS:
            raise InputError("--verb", f"is {self.verb!r}", advise(self.verb, VERBS))

    @cached_property
    def width(self) -> int:
        """How many figures a case has."""
        return len(self.keys) + len(self.functions) + len(self.histories) * len(self.times)

    @cached_property
    def needs(self) -> Needs:
        """What the figures are taken from; before their keys are known, anything."""
        if not self.keys and not self.histories:
            return Needs()
        errors = any("error" in str(key) for keys in self.keys for key in own_keys(keys))
        loads = any(map(_of_loads, self.keys)) or any(each.quantity != "tip" for each in self.histories)
        return Needs(errors, loads)

    @property
    def needs_facts(self) -> bool:
        """Whether the verb has to answer."""
        return bool(self.keys or self.histories)

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
        return VERBS[self.verb](case, self.motion, self.at, self.needs)

    def row(self, number: int, overrides: Sequence[str]) -> Row:
        """Compute one case. What goes wrong in it is part of the row: the other cases go on."""
        try:
            case = self.case(overrides)
            facts = self.facts(case) if self.needs_facts else NO_FACTS
        except Exception as error:
            return without_figures(number, self.width, error)
        return self.measured(number, case, facts)

    def measured(self, number: int, case: Case, facts: Facts) -> Row:
        """The row of a case that is built, from what the verb answers to it."""
        try:
            values = [value_at(facts, keys) for keys in self.keys] + [float(each(case)) for each in self.functions]
            for history in self.histories:
                values += history.at(facts["study"], self.times).tolist()
        except Exception as error:
            return without_figures(number, self.width, error)
        return Row(number, tuple(values), *ended(facts))


def _of_loads(keys: Keys) -> bool:
    """Whether a figure may be one of loads."""
    match keys[0]:
        case "motions":
            return len(keys) < 3 or keys[2] not in _WITHOUT_LOADS
        case "comparisons":
            return keys[2:] not in _VERDICT_WITHOUT_LOADS
    return True


def ended(facts: Facts) -> tuple[str, str]:
    """Outcome of a case, or what limits make of it, and its message."""
    state = str(facts.get("state", facts["outcome"]))
    return state if state in ANSWERED else str(facts["outcome"]), str(facts.get("message") or "")


def without_figures(number: int, width: int, error: Exception) -> Row:
    """Row of a case that came to nothing, with the reason."""
    nothing = (math.nan,) * width
    if isinstance(error, ComputationError):
        return Row(number, nothing, error.outcome, _line(error))
    if isinstance(error, GbeamError):
        return Row(number, nothing, "refused", _line(error))
    return Row(number, nothing, "failed", f"{type(error).__name__}: {_line(error)}")  # a defect, or a measure's own


def _line(error: Exception) -> str:
    """First line of a message; a scenario's shows the source on the others."""
    text = str(error).strip()
    return text.splitlines()[0] if text else type(error).__name__
