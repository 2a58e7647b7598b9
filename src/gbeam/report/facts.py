"""Figures of any result as its verb prints them with ``--json``; their schema; a result computed again."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from gbeam.report.words import as_json
from gbeam.results.cases import Sweep
from gbeam.results.comparison import Comparison, MachinePlan
from gbeam.results.declared import declarations, records_in
from gbeam.results.facts import facts_of, json_of, paths_of, schema_of
from gbeam.results.provenance import Provenance
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import KINDS, Reproduction, Study, by_motion, tree_of_answers

VERSION = 1  # of the keys: raised where one changes or goes


def json_form(result: Result) -> Result:
    """Return a result as its JSON has it: a response in a study of its own, an answer for a motion with a name."""
    if isinstance(result, Response):
        name = result.name or result.environment
        remarks: dict[str, Any] = {"warnings": result.warnings, "notes": result.notes}
        return Study("", {name: result}, (), provenance=result.provenance, **remarks)
    if result.listed_by and not getattr(result, result.listed_by):
        fields: dict[str, Any] = {result.listed_by: result.unnamed}
        return replace(result, **fields)
    return result


def facts(*results: Result, title: str = "", files: Iterable[Path] | None = None) -> dict[str, Any]:
    """Return a result as JSON, or one result in several motions. `files` are those that were written with it.

    It carries its form (the kind of result and the version of its keys) and the unit of every number by its path.
    """
    answers = [json_form(result) for result in results]
    kind = type(answers[0])
    file_names = {} if files is None else {"files": [str(file) for file in files]}
    declared = paths_of(tree_of_answers(kind))
    units = {path: quantity.unit for path, quantity in declared if quantity.unit not in ("", "unit")}
    form = {"kind": kind.__name__, "version": VERSION}
    figures = by_motion(answers, title) if kind.listed_by else json_of(answers[0])
    return {"form": form} | _with_words(figures, answers) | file_names | {"units": units}


def _with_words(figures: dict[str, Any], answers: list[Result]) -> dict[str, Any]:
    """Add to JSON the sentences of printed reports, and to a sweep's its state as the outcome; return it."""
    for answer in answers:
        match answer:
            case MachinePlan():
                from gbeam.report.machine import ends_line, judged_lines

                lines = [ends_line(answer.time, answer.axes), *judged_lines(answer)]
                figures["motions"][answer.name]["lines"] = lines
            case Comparison():
                from gbeam.report.study import comparison_lines

                figures["lines"] = list(comparison_lines(answer))
            case Study():
                from gbeam.report.study import comparison_lines, response_lines

                for name, response in answer.responses.items():
                    figures["motions"][name]["lines"] = list(response_lines(response))
                for entry, comparison in zip(figures["comparisons"], answer.comparisons, strict=True):
                    entry["lines"] = list(comparison_lines(comparison))
            case Sweep():
                figures["outcome"] = answer.state
    return figures


def facts_text(result: Result) -> str:
    """Return a result as the text of its JSON."""
    return as_json(facts(result))


LISTED = 20  # differences in words


def origin_json(provenance: Provenance) -> dict[str, Any]:
    """Provenance as JSON: the scenario's text, hashes and versions; of records not the bytes."""
    return facts_of(provenance.stated()[0])


def reproduction_json(reproduction: Reproduction) -> dict[str, Any]:
    """Reproduction as JSON; a difference's size is null where the two cannot be compared."""
    return {
        "outcome": "reproduced" if reproduction.reproduced else "not reproduced",
        "file": reproduction.file,
        "compared": reproduction.compared,
        "tolerance": reproduction.tolerance,
        "rounded": reproduction.rounded,
        "differences": [asdict(difference) for difference in reproduction.differences],
        "changed": {name: {"then": old_value, "now": now} for name, (old_value, now) in reproduction.changed.items()},
    }


def reproduction_text(reproduction: Reproduction) -> str:
    """Return a reproduction in words: the values compared, their differences, and changes of the
    circumstances since.
    """
    verdict = reproduction.agreement.replace("to the", "the same to the")
    lines = [f"{reproduction.file}: {reproduction.compared} values and arrays computed again: {verdict}"]
    count = min(reproduction.excess_count or 1, LISTED)  # those beyond rounding, or else the largest
    lines += [f"  {difference}" for difference in reproduction.differences[:count]]
    if len(reproduction.differences) > count:
        lines.append(f"  and {len(reproduction.differences) - count} more: see --json")
    lines += [f"  {change}" for change in reproduction.circumstances()]
    return "\n".join(lines)


_ENVELOPE = {
    "form": {
        "type": "object",
        "description": "kind of result, and version of its keys",
        "properties": {"kind": {"enum": list(KINDS)}, "version": {"const": VERSION}},
    },
    "title": {"type": "string", "description": "title of the scenario"},
    "outcome": {"type": "string", "description": "how it ended; done where all is well"},
    "state": {"type": "string", "description": "outcome with what limits of acceptance make of it"},
    "units": {"type": "object", "description": "SI unit of every number by its path, where it has one"},
    "provenance": {"type": "object", "description": "scenario, records, command and versions that it comes from"},
    "files": {"type": "array", "description": "files that were written", "items": {"type": "string"}},
}
_HEAD = """\
# Results

This page is written by `gbeam schema --results --markdown`; `gbeam schema --results` prints the same as a JSON schema.

Every `--json` says in `form` which kind of result it is and which version its keys have, and in `units` the SI unit
of every number by its path. A key changes or goes with a new version only. In paths `*` is a name, such as a motion's
or an axis, and `[i]` a place in a list. The end of a path names a figure for `--measure`, `--of` and `--minimise`;
`--measure list` prints those of a verb. `null` is what is not known, or not finite. The same quantities are in files,
with long names, units and dimensions.
"""


def json_schema_of_results() -> str:
    """Return the JSON schema of what verbs print, by kinds of result."""
    kinds: dict[str, Any] = {}
    for name, kind in KINDS.items():
        schema = schema_of(tree_of_answers(kind))
        kinds[name] = {**schema, "properties": _ENVELOPE | schema["properties"]}
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "gbeam --json", "$defs": kinds}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def reference_of_results() -> str:
    """Return a page with a table of every kind of result."""
    summaries = {name: (kind.__doc__ or "").strip().splitlines()[0] for name, kind in KINDS.items()}
    text = _HEAD
    for name, kind in KINDS.items():
        text += f"\n## {name}\n\n{summaries[name]}\n\n| key | unit | |\n|---|---|---|\n"
        for path, unit, words in _rows(kind):
            text += f"| `{path}` | {'–' if unit in ('', 'unit') else unit} | {words} |\n"
    return text


def _rows(kind: type) -> Iterator[tuple[str, str, str]]:
    """Yield path, unit and words of the quantities of a kind of result; for parts of other kinds a link to these."""
    links: dict[str, list[str]] = {}
    for name, declaration in declarations(kind) if kind is Study else ():
        names = [record.__name__ for record in records_in(kind, name) if record.__name__ in KINDS]
        if declaration.role == "rows" and names:
            links[declaration.key or name] = names
    for key, names in sorted(links.items()):
        link_words = " or ".join(f"[{name}](#{name.lower()})" for name in names)
        yield f"{key}.*" if key == "motions" else f"{key}[i]", "–", f"a {link_words}"
    for path, entry in paths_of(tree_of_answers(kind)):
        if path.partition(".")[0].partition("[")[0] not in links:
            yield path, entry.unit, entry.words.replace("|", "\\|")
