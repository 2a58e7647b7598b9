"""A scenario as text and as fields: two views of one document, with the command line's own messages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gbeam.app.files import regular
from gbeam.app.form import form, known_at, new_table, value_at
from gbeam.errors import GbeamError, InputError
from gbeam.scenario import ScenarioError, build, loads
from gbeam.scenario.text.diagnostics import Diagnostic
from gbeam.scenario.text.revise import toml, with_entry, without_entry
from gbeam.scenario.text.source import parse
from gbeam.scenario.values.paths import Path as Place
from gbeam.scenario.values.paths import parse_path, path_text, walk, written_at

NAME = "scenario.toml"
# Of a record: what its columns are.
COLUMNS = ("file", "time", "time_unit", "x", "y", "z", "unit", "quantity", "p", "q", "r", "rate_unit")
CHANGES = 3  # between two scenarios that are told
_LONG = 40  # characters of a value in them
_DURATION: Place = ("response", "duration")
_MISSING = re.compile(r"(\w+) is missing")  # a message about a table, whose field that is


class Unfit(GbeamError):
    """A scenario is wrong, by `problems` as :func:`problems` lists them."""

    def __init__(self, problems: list[dict[str, Any]]) -> None:
        self.problems = problems
        super().__init__("; ".join(str(each["message"]) for each in problems))


def described(text: str, folder: Path, *, distributions: bool = True) -> dict[str, Any]:
    """Return the form of a document, its problems, and where there are none its meaning."""
    document: dict[str, Any] = {"text": text, "form": [], "errors": [], "meaning": ""}
    try:
        data = parse(NAME, text)
        document["form"] = form(data)
        records(data, folder)
        from gbeam.analysis.case import describe
        from gbeam.report.description import text as in_words

        document["meaning"] = in_words(describe(build(loads(text, NAME, folder=folder, distributions=distributions))))
    except GbeamError as error:
        document["errors"] = problems(error)
    return document


def edited(text: str, path: str, value: str) -> str:
    """Return the text with another value at a path, or without it where that is empty; comments and all else stay."""
    data, place = parse(NAME, text), _place(path)
    if not value.strip():
        return without_entry(text, place) if written_at(data, place) is not None else text
    if not known_at(place, data) and isinstance(written_at(data, place), (dict, list, type(None))):
        raise InputError(path[:100], "is no value of a scenario", "choose one of the form")
    return with_entry(text, place, value_at(place, data, value))


def added(text: str, path: str, choice: str) -> str:
    """Return the text with a new table at a path, or with another kind (`choice`) of table than was there."""
    data, place = parse(NAME, text), _place(path)
    try:
        table = new_table(place, data, choice)
    except KeyError:
        raise InputError(path[:100], f"is no place for {choice[:100] or 'a table'}", "choose one of the form") from None
    return with_entry(text, place, table)


def removed(text: str, path: str) -> str:
    """Return the text without what is written at a path."""
    return without_entry(text, _place(path))


def with_record(text: str, motion: str, record: dict[str, str]) -> str:
    """Return the text with a flight's record in place of its acceleration, or of its record before.

    What else is written of a record of the same file stays. The duration of the response goes: it was that of another
    flight, and a record is flown to its end.
    """
    place: Place = ("motion", motion)
    data = parse(NAME, text)
    if written_at(data, place) is None:
        raise InputError(f"motion.{motion}"[:100], "is no flight of the scenario", "add a motion of kind flight")
    if written_at(data, (*place, "acceleration")) is not None:
        text = without_entry(text, (*place, "acceleration"))
    before = written_at(data, (*place, "record"))
    same = isinstance(before, dict) and before.get("file") == record.get("file")
    kept = {key: value for key, value in before.items() if key not in COLUMNS} if same else {}
    if written_at(data, _DURATION) is not None:
        text = without_entry(text, _DURATION)
    return with_entry(text, (*place, "record"), record | kept)


def _place(path: str) -> Place:
    place = parse_path(path)
    if place is None:
        raise InputError(path[:100] or "path", "is no path of a scenario", "write it such as beam.masses[0].at")
    return place


def _leaves(scenario: dict[str, Any]) -> Iterator[tuple[Place, Any]]:
    """Paths and values of what is no table and no list of tables."""
    return walk(scenario, lambda node: isinstance(node, list) and not any(isinstance(x, (dict, list)) for x in node))


def changes(before: str, after: str) -> str:
    """Changes of a scenario against one before it, in a line."""
    try:
        then, now = ({path_text(path): value for path, value in _leaves(parse(NAME, text))} for text in (before, after))
    except GbeamError:
        return ""
    lines = [f"{path} = {_shown(value)}" for path, value in now.items() if then.get(path) != value]
    lines += [f"no {path}" for path in then if path not in now]
    more = f", and {len(lines) - CHANGES} more" if len(lines) > CHANGES else ""
    return ", ".join(lines[:CHANGES]) + more if lines else "as before"


def _shown(value: Any) -> str:
    text = value if isinstance(value, str) else toml(value)
    return text if len(text) <= _LONG else f"{text[:_LONG]}…"


def records(data: Any, folder: Path) -> list[Path]:
    """The files that a scenario names, all of which must be records of the folder."""
    files = []
    for path, value in _leaves(data):
        if path[-1] == "file":
            if not isinstance(value, str):
                raise InputError(path_text(path), "is no text", "give the name of a record")
            try:
                files.append(regular(folder, value))
            except InputError as error:
                raise InputError(path_text(path), f"{value[:100]!r} {error.problem}", error.fix) from None
    return files


def problems(error: GbeamError) -> list[dict[str, Any]]:
    """Problems of a document, each with its path, its field, its message, the fix, and its line where it has one."""
    if isinstance(error, Unfit):
        return error.problems
    if isinstance(error, ScenarioError):
        return [_problem(each) for each in error.diagnostics]
    if isinstance(error, InputError):
        return [{"path": error.where, "field": error.where, "message": error.problem, "hint": error.fix, "line": None}]
    return [{"path": "", "field": "", "message": str(error), "hint": "", "line": None}]


def _problem(each: Diagnostic) -> dict[str, Any]:
    missing = _MISSING.fullmatch(each.message)
    field = f"{each.path}.{missing[1]}".removeprefix(".") if missing else each.path
    return {"path": each.path, "field": field, "message": each.message, "hint": each.hint, "line": each.line}
