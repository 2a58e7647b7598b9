"""Computation of cases by a worker, from the scenario's text to the figures, one by one or integrated together.

A case's digits do not depend on the cases beside it (:func:`gbeam.simulate_batch`). Whether it is integrated with
others depends only on the sweep and on the case.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby, islice
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.analysis.environments import study_of
from gbeam.analysis.response.batch import TOGETHER, simulate_batch
from gbeam.errors import ComputationError, GbeamError
from gbeam.mechanics.tree.system import System
from gbeam.questions import Needs, question_of, reduced
from gbeam.results.cases import ANSWERED
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.study import Failure
from gbeam.studies.figures import Facts, History, Keys, answer_facts, own_keys, value_at, without_body
from gbeam.studies.template import Template

Function = Callable[[Any], float]
NO_FACTS: Facts = {"outcome": "done"}  # where functions measure the case, and no verb answers
# Figures of a motion, and of a comparison, that have the same digits if no loads are computed.
_WITHOUT_LOADS = (
    "tip", "stations", "points", "coordinates", "hub", "step", "steps", "damping_ratio", "axes", "limits",
    "tracking_error",
)  # fmt: skip
_VERDICT_WITHOUT_LOADS = (("verdict", "tip"), ("verdict", "followed"))


@dataclass(frozen=True)
class Row:
    """Figures of one case, its outcome, and the reason if that is not done, or the limits that it does not keep."""

    case: int
    values: tuple[float, ...]
    outcome: str
    message: str = ""

    @property
    def failed(self) -> bool:
        """True if the case has no answer, or was cut off."""
        return self.outcome not in ("done", *ANSWERED)


@dataclass(frozen=True)
class Inquiry:
    """Question asked of every case, at time `at`, s, and the figures that are taken from its answer."""

    template: Template
    verb: str
    motion: str | None
    at: float | None = None
    options: Mapping[str, Any] = field(default_factory=dict)  # of the verb, as its function takes them
    keys: tuple[Keys, ...] = ()  # of the figures in the answer's facts
    functions: tuple[Function, ...] = ()  # figures by functions of the case
    histories: tuple[History, ...] = ()
    times: Floats = field(default_factory=lambda: np.empty(0))  # of the histories, (t,) s
    together: bool = False  # integrate cases together

    def __post_init__(self) -> None:
        question_of(self.verb).chosen(self.options)  # before anything is computed

    @cached_property
    def width(self) -> int:
        """Number of figures of a case."""
        return len(self.keys) + len(self.functions) + len(self.histories) * len(self.times)

    @cached_property
    def needs(self) -> Needs:
        """Parts of answers that the figures are taken from. All parts while their keys are not known."""
        if not self.keys and not self.histories:
            return Needs()
        errors = any("error" in str(key) for keys in self.keys for key in own_keys(keys))
        loads = any(map(of_loads, self.keys)) or any(history.quantity != "tip" for history in self.histories)
        return Needs(errors, loads)

    def case(self, overrides: Sequence[str]) -> Case:
        """The objects of one case."""
        return self.template.changed(overrides).built()

    def facts(self, case: Case) -> Facts:
        """Facts of the verb's answer to a case."""
        question = question_of(self.verb)
        question.refuse(case)
        answer = question.answer(case, self.motion, self.at, self.needs, **question.chosen(self.options))
        return answer_facts(answer, case.title)

    def row(self, number: int, overrides: Sequence[str]) -> Row:
        """Compute one case. An exception becomes part of its row, so that the other cases go on."""
        try:
            case = self.case(overrides)
            facts = self.facts(case) if self.keys or self.histories else NO_FACTS
        except Exception as error:
            return without_figures(number, self.width, error)
        return self.measured(number, case, facts)

    def measured(self, number: int, case: Case, facts: Facts) -> Row:
        """Row of a built case, from the facts of the verb's answer to it."""
        try:
            values = [value_at(facts, keys) for keys in self.keys]
            function_values, problem = _measure(self.functions, case)
            values += function_values
            for history in self.histories:
                values += history.interpolate(facts["study"], self.times).tolist()
        except Exception as error:
            return without_figures(number, self.width, error)
        outcome, message = outcome_of(facts)
        return Row(number, tuple(values), outcome, message or problem)


def _measure(functions: Sequence[Function], case: Case) -> tuple[list[float], str]:
    """Values of functions of a case, NaN for those that fail, and the reasons. If all fail the last error is raised."""
    values, problems, last_error = [], [], Exception()
    for k, function in enumerate(functions):
        try:
            values.append(float(function(case)))
        except Exception as error:
            values.append(math.nan)
            problems.append(f"measure {k + 1}: {type(error).__name__}: {_line(error)}")
            last_error = error
    if problems and len(problems) == len(functions):
        raise last_error
    return values, "; ".join(problems)


def of_loads(keys: Keys) -> bool:
    """True if a figure may depend on the loads; False if it is known to be the same where none are computed."""
    match keys[0]:
        case "motions":
            keys = without_body(keys)
            return len(keys) < 3 or keys[2] not in _WITHOUT_LOADS
        case "comparisons":
            return keys[2:] not in _VERDICT_WITHOUT_LOADS
    return True


def outcome_of(facts: Facts) -> tuple[str, str]:
    """Outcome of a case, or the state that its limits put it in, such as not accepted, and its message."""
    state = str(facts.get("state", facts["outcome"]))
    return state if state in ANSWERED else str(facts["outcome"]), str(facts.get("message") or "")


def without_figures(number: int, width: int, error: Exception) -> Row:
    """Row of a case that raised `error`: no figures, an outcome by the error's type, and its message."""
    nans = (math.nan,) * width
    if isinstance(error, ComputationError):
        return Row(number, nans, error.outcome, _line(error))
    if isinstance(error, GbeamError):
        return Row(number, nans, "refused", _line(error))
    return Row(number, nans, "failed", f"{type(error).__name__}: {_line(error)}")  # a defect, or a measure's own


def _line(error: Exception) -> str:
    """First line of an error's message. Further lines show the scenario's source."""
    text = str(error).strip()
    return text.splitlines()[0] if text else type(error).__name__


Task = tuple[int, tuple[str, ...]]  # number of the case, and its changes
Posed = tuple[int, Case]
MANY = 4 * TOGETHER  # cases that are built at once, so that most batches of equal runs are full
_ALONE = ("response", "model")  # tables: cases that differ in these share few steps or sizes


def width(inquiry: Inquiry) -> int:
    """Number of cases to compute in one call."""
    return TOGETHER if inquiry.together else 1


def may_share(verb: str, paths: Sequence[str]) -> bool:
    """True if cases that differ at these paths are worth integrating together."""
    return verb == "run" and not any(path.partition(".")[0] in _ALONE for path in paths)


def settle(inquiry: Inquiry, case: Case, cases: int) -> Inquiry:
    """Inquiry that stays `together` only if cases like this one gain by being integrated together.

    Automatic steps take several runs, which pay only for many cases. Automatic numbers of shapes exclude it.
    """
    settings = reduced(case, inquiry.needs).response
    if settings is None or not inquiry.together:
        return inquiry
    enough = settings.step is not None or cases >= TOGETHER
    able = len(case.system.tree.unknowns) > 0 and not settings.estimate and not case.automatic and not case.spans
    return replace(inquiry, together=enough and able)


def rows(inquiry: Inquiry, tasks: Iterable[Task]) -> Iterator[Row]:
    """Compute cases; if they are integrated together, their rows come in any order."""
    if inquiry.together:
        return _batch_rows(inquiry, iter(tasks))
    return (inquiry.row(*task) for task in tasks)


def _batch_rows(inquiry: Inquiry, tasks: Iterator[Task]) -> Iterator[Row]:
    """Rows of cases, computed many at a time. Neighbours with equal settings are integrated together."""
    while chunk := list(islice(tasks, MANY)):
        posed: list[Posed] = []
        systems: dict[tuple[str, ...], System] = {}
        for number, overrides in chunk:
            try:
                # Cases that differ only in their motion share a structure.
                key = tuple(change for change in overrides if not change.startswith("motion."))
                case = inquiry.template.changed(overrides).built(systems.get(key))
                systems[key] = case.system
                posed.append((number, case))
            except Exception as error:
                yield without_figures(number, inquiry.width, error)
        # Settings differ where a motion's record ends at another time.
        for _, group in groupby(posed, key=lambda numbered: numbered[1].response):
            yield from _answer_cases(inquiry, list(group), one_structure=set(systems) == {()})


def _answer_cases(inquiry: Inquiry, posed: Sequence[Posed], *, one_structure: bool) -> Iterator[Row]:
    """Rows of cases with the same settings. Each is yielded as soon as all of its motions are answered."""
    settings = reduced(posed[0][1], inquiry.needs).response
    pairs = [(k, name) for k, (_, case) in enumerate(posed) for name in case.environments]
    answers: dict[int, dict[str, Response | Exception]] = {}  # of cases by index in `posed`, then by motion
    for (k, name), answer in _responses(posed, pairs, settings, one_structure=one_structure):
        number, case = posed[k]
        by_motion = answers.setdefault(k, {})
        by_motion[name] = answer
        if len(by_motion) == len(case.environments):
            yield _row(inquiry, number, case, {name: by_motion[name] for name in case.environments})
            del answers[k]


def _responses(
    posed: Sequence[Posed], pairs: Sequence[tuple[int, str]], settings: Any, *, one_structure: bool
) -> Iterator[tuple[tuple[int, str], Response | Exception]]:
    """Response, or exception, for each pair of a case's index in `posed` and a motion, in any order.

    An exception of one pair ends the batch: halves are then tried until the pair is alone.
    """
    pending = dict.fromkeys(pairs)
    try:
        cases = ((posed[k][1].system, posed[k][1].environments[name]) for k, name in pairs)
        for k, response in simulate_batch(cases, settings, one_structure=one_structure):
            case, name = pairs[k]
            del pending[case, name]
            yield (case, name), replace(response, name=name, provenance=posed[case][1].provenance)
    except Exception as error:
        if len(pending) == 1:
            yield next(iter(pending)), error
            return
        rest, half = list(pending), len(pending) // 2
        for part in (rest[:half], rest[half:]):
            yield from _responses(posed, part, settings, one_structure=one_structure)


def _row(inquiry: Inquiry, number: int, case: Case, answers: Mapping[str, Response | Exception]) -> Row:
    """Row of a case from its answers. A ComputationError concerns one motion. Any other exception ends the case."""
    responses: dict[str, Response] = {}
    failures: dict[str, Failure] = {}
    try:
        for name, answer in answers.items():
            if isinstance(answer, ComputationError):
                failures[name] = Failure(answer.outcome, str(answer))
            elif isinstance(answer, Exception):
                raise answer
            else:
                responses[name] = answer
        facts = answer_facts(study_of(case, responses, failures))
    except Exception as error:
        return without_figures(number, inquiry.width, error)
    return inquiry.measured(number, case, facts)
