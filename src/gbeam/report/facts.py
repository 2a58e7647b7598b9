"""Figures of any result as its verb prints them with ``--json``, with the sentences of its text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from gbeam.report.machine.accounting import judged_lines
from gbeam.report.study import comparison, sentences
from gbeam.report.words import as_json
from gbeam.results.cases import Sweep
from gbeam.results.equilibrium import Deflection
from gbeam.results.facts import json_of, paths_of, tree_of
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.kinds import by_motion
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Study

VERSION = 1  # of the keys: raised where one changes or goes


def whole(result: Result) -> Result:
    """Return the result as its JSON has it: a response alone in a study, one that is listed by motion with a name."""
    match result:
        case Response():
            name = result.name or result.environment
            return Study("", {name: result}, (), warnings=(), provenance=result.provenance)
        case Deflection(motion=""):
            return replace(result, motion="beam")
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
    units = {path: each.unit for path, each in paths_of(tree_of(kind)) if each.unit not in ("", "unit")}
    several = "motions.*." if isinstance(answers[0], (Deflection, MachinePlan)) else ""
    form = {"kind": kind.__name__, "version": VERSION}
    return {"form": form} | _figures(answers, title) | written | {"units": {several + p: u for p, u in units.items()}}


def _figures(answers: list[Result], title: str) -> dict[str, Any]:
    match answers[0]:
        case Deflection():
            return by_motion(answers, title)
        case MachinePlan():
            figures = by_motion(answers, title)
            for plan in answers:
                if isinstance(plan, MachinePlan):
                    figures["motions"][plan.name]["lines"] = list(judged_lines(plan))
            return figures
        case Study() as study:
            figures = json_of(study)
            for name, response in study.responses.items():
                lines = [*sentences.of_beam(response), *sentences.of_machine(response)]
                figures["motions"][name]["lines"] = lines
            for each, compared in zip(figures["comparisons"], study.comparisons, strict=True):
                each["lines"] = list(comparison.lines(compared))
            return figures
        case Sweep() as answer:
            return {**json_of(answer), "outcome": answer.state}
        case answer:
            return json_of(answer)


def facts_text(result: Result) -> str:
    """Return a result as the text of its JSON."""
    return as_json(facts(result))
