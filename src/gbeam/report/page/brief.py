"""A result in a notebook: its verdict and a small table, as HTML without a script."""

from __future__ import annotations

import html
import json
from typing import Any

from gbeam.report.facts import facts_text
from gbeam.report.page.bodies import study
from gbeam.report.page.bodies.steady import crossings_table, modes_table, tracks_table
from gbeam.report.page.parts import Value, badge, heading, listed, paragraph, table
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.modal import Campbell, Modes
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Study


def html_of(result: Result) -> str:
    """Return a few lines of HTML for any result; in words where its kind has no table."""
    match result:
        case Study() | Response():
            inside = _of_run(result)
        case Comparison():
            inside = _of_comparison(result)
        case Modes():
            inside = modes_table(_known(result))
        case Campbell():
            inside = tracks_table(_known(result)) + crossings_table(_known(result))
        case _:
            return f"<pre>{html.escape(repr(result))}</pre>"
    return f"<div>{inside}{listed(result.warnings) if not isinstance(result, Study) else ''}</div>"


def _of_run(result: Study | Response) -> str:
    known = _known(result)
    title = known["title"] or (result.name if isinstance(result, Response) else "")
    parts = [heading(title, 3) if title else "", f"<p>{badge(known['state'])}</p>"]
    parts += [paragraph(each["verdict"]) for each in known["comparisons"]]
    parts += [paragraph(f"{name}: {each['message']}") for name, each in known["motions"].items() if each["message"]]
    done = {name: each for name, each in known["motions"].items() if "tip" in each}
    warnings = listed(study.warnings(known)) if isinstance(result, Study) else ""
    return "".join([*parts, study.tips_table(done), study.loads_table(done), warnings])


def _of_comparison(result: Comparison) -> str:
    head = ("", result.flight, result.centrifuge, "error")
    rows: list[list[Value]] = [
        [name.replace("_", " "), pair.flight, pair.machine, f"{100 * (pair.ratio - 1):+.2g} %"]
        for name, pair in result.peaks.items()
    ]
    return paragraph(result.verdict) + table(head, rows, "Largest over the whole flight, SI")


def _known(result: Result) -> dict[str, Any]:
    """The facts of a result as a file has them, with null for what is not finite."""
    return dict(json.loads(facts_text(result)))
