"""Some cases at once, which is what a worker is given: runs of one shape are integrated together.

A case's digits do not depend on the cases beside it (:func:`gbeam.simulate_batch`), so neither do they on the workers,
nor on what a store holds; whether it is integrated with others depends on the sweep and on the case alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby, islice

from gbeam.analysis.response.batch import TOGETHER, simulate_batch
from gbeam.analysis.study.case import Case
from gbeam.analysis.study.study import study_of
from gbeam.errors import ComputationError
from gbeam.mechanics.structure import Structure
from gbeam.results.response import Response
from gbeam.results.study import Failure
from gbeam.sweeps.computing.evaluate import Question, Row, without_figures
from gbeam.sweeps.figures.answers import reduced, study_facts

Task = tuple[int, tuple[str, ...]]  # number of the case, and its changes
Posed = tuple[int, Case, Structure]
_ALONE = ("response", "model")  # tables: cases in which they differ have few steps or sizes in common


def width(question: Question) -> int:
    """How many cases are best computed at once."""
    return TOGETHER if question.together else 1


def may_share(verb: str, paths: Sequence[str]) -> bool:
    """Whether cases that differ at these paths are worth integrating together."""
    return verb == "run" and not any(path.partition(".")[0] in _ALONE for path in paths)


def settled(question: Question, case: Case, cases: int) -> Question:
    """The question, its figures known, with whether a case, and so every one of a sweep of so many, stands with others.

    An automatic step takes several runs, whose programs a few cases do not repay; so do numbers of shapes that are
    found case by case.
    """
    settings = reduced(case, question.needs).response
    enough = settings.step is not None or cases >= TOGETHER
    able = not settings.estimate and not case.model.automatic
    return replace(question, together=question.together and enough and able)


def rows(question: Question, tasks: Sequence[Task]) -> list[Row]:
    """Compute some cases."""
    if not question.together:
        return [question.row(*task) for task in tasks]
    left = iter(tasks)
    made: list[Row] = []
    while some := list(islice(left, TOGETHER)):  # no more responses at once
        made += _together(question, some)
    return made


def _together(question: Question, tasks: Sequence[Task]) -> list[Row]:
    made: list[Row] = []
    posed: list[Posed] = []
    structures: dict[tuple[str, ...], Structure] = {}
    for number, overrides in tasks:
        try:
            case = question.case(overrides)
            of_beam = tuple(each for each in overrides if not each.startswith("motion."))
            structure = structures[of_beam] = structures.get(of_beam) or case.assemble()
            posed.append((number, case, structure))
        except Exception as error:
            made.append(without_figures(number, question.width, error))
    # What varies in a motion may end a record elsewhere.
    for _, alike in groupby(posed, key=lambda each: each[1].response):
        made += _integrated(question, list(alike), set(structures) == {()})
    return made


def _integrated(question: Question, posed: Sequence[Posed], one_structure: bool) -> Iterator[Row]:
    """Rows of cases with the same settings."""
    answers = {name: _responses(question, posed, name, one_structure) for name in posed[0][1].motions}
    for k, (number, case, _) in enumerate(posed):
        yield _row(question, number, case, {name: each[k] for name, each in answers.items()})


def _responses(
    question: Question, posed: Sequence[Posed], name: str, one_structure: bool
) -> list[Response | Exception]:
    """Responses in one environment, or why there is none."""
    settings = reduced(posed[0][1], question.needs).response
    try:
        cases = ((structure, case.motions[name]) for _, case, structure in posed)
        made = dict(simulate_batch(cases, settings, one_structure=one_structure))
    except Exception as error:
        if len(posed) == 1:
            return [error]
        half = len(posed) // 2  # one that fails ends its batch
        return [
            each for part in (posed[:half], posed[half:]) for each in _responses(question, part, name, one_structure)
        ]
    return [replace(made[k], name=name, provenance=case.provenance) for k, (_, case, _) in enumerate(posed)]


def _row(question: Question, number: int, case: Case, answers: Mapping[str, Response | Exception]) -> Row:
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
        facts = study_facts(study_of(case, responses, failures))
    except Exception as error:
        return without_figures(number, question.width, error)
    return question.measured(number, case, facts)
