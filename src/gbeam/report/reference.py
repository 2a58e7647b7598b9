"""Every quantity of every kind of result: the JSON schema of what verbs print, and a page to read."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from gbeam.report.facts import VERSION
from gbeam.results.declared import declarations
from gbeam.results.facts import paths_of, schema_of
from gbeam.results.kinds import KINDS, tree_of_answers

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
    return _HEAD + "".join(f"\n## {name}\n\n{_summary(kind)}\n\n{_table(kind)}" for name, kind in KINDS.items())


def _summary(kind: type) -> str:
    return (kind.__doc__ or "").strip().splitlines()[0]


def _table(kind: type) -> str:
    rows = [f"| `{path}` | {'–' if unit in ('', 'unit') else unit} | {words} |" for path, unit, words in _rows(kind)]
    return "\n".join(["| key | unit | |", "|---|---|---|", *rows, ""])


def _rows(kind: type) -> Iterator[tuple[str, str, str]]:
    """Path, unit and words of the numbers; of what is another kind of result its name only."""
    others = {each.key or name for name, each in declarations(kind) if each.role == "rows"}
    links = {"motions": "Response", "comparisons": "Comparison"} if kind.__name__ == "Study" else {}
    for key in sorted(links.keys() & others):
        yield f"{key}.*" if key == "motions" else f"{key}[i]", "–", f"a [{links[key]}](#{links[key].lower()})"
    for path, each in paths_of(tree_of_answers(kind)):
        if path.partition(".")[0].partition("[")[0] not in links:
            yield path, each.unit, each.words.replace("|", "\\|")
