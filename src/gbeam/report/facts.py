"""Figures of any result as its verb prints them with ``--json``, with the sentences of its text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from gbeam.report.words import as_json
from gbeam.results.cases import Sweep
from gbeam.results.equilibrium import Deflection
from gbeam.results.facts import json_of, paths_of
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.kinds import by_motion, tree_of_answers
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Study
from gbeam.results.system import SystemRest

VERSION = 1  # of the keys: raised where one changes or goes


def whole(result: Result) -> Result:
    """Return the result as its JSON has it: a response alone in a study, one that is listed by motion with a name."""
    match result:
        case Response():
            name = result.name or result.environment
            return Study("", {name: result}, (), warnings=(), provenance=result.provenance)
        case Deflection(motion=""):
            return replace(result, motion="beam")
        case SystemRest(name=""):
            return replace(result, name="ground")
        case MachinePlan(name=""):
            return replace(result, name="centrifuge")
        case _:
            return result


def facts(*results: Result, title: str = "", files: Iterable[Path] | None = None) -> dict[str, Any]:
    """Return a result as JSON, or those in several motions; with the files that were written, where they are given.

    It carries its form, the kind of result with the version of its keys, and the unit of every number by its path.
    """
    answers = [whole(each) for each in results]
    kind = type(answers[0])
    written = {} if files is None else {"files": [str(file) for file in files]}
    units = {path: each.unit for path, each in paths_of(tree_of_answers(kind)) if each.unit not in ("", "unit")}
    form = {"kind": kind.__name__, "version": VERSION}
    figures = by_motion(answers, title) if kind.listed_by else json_of(answers[0])
    return {"form": form} | _worded(figures, answers) | written | {"units": units}


def _worded(figures: dict[str, Any], answers: list[Result]) -> dict[str, Any]:
    """Figures with the sentences of a verb's text, and with how all cases of a sweep ended."""
    for answer in answers:
        match answer:
            case MachinePlan():
                from gbeam.report.machine import judged_lines

                figures["motions"][answer.name]["lines"] = list(judged_lines(answer))
            case Comparison():
                from gbeam.report.study import comparison_lines

                figures["lines"] = list(comparison_lines(answer))
            case Study():
                from gbeam.report.study import comparison_lines, of_beam, of_machine

                for name, response in answer.responses.items():
                    lines = [*of_beam(response), *of_machine(response)]
                    figures["motions"][name]["lines"] = lines
                for each, compared in zip(figures["comparisons"], answer.comparisons, strict=True):
                    each["lines"] = list(comparison_lines(compared))
            case Sweep():
                figures["outcome"] = answer.state
    return figures


def facts_text(result: Result) -> str:
    """Return a result as the text of its JSON."""
    return as_json(facts(result))
