"""A scenario as text and as fields: two views of one document, with the command line's own messages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from gbeam.app.files import regular
from gbeam.errors import GbeamError, InputError
from gbeam.scenario import ScenarioError, build, json_schema, loads
from gbeam.scenario.text.diagnostics import Diagnostic
from gbeam.scenario.text.paths import parse_path, path_text
from gbeam.scenario.text.source import Source, parse

NAME = "scenario.toml"
_MEASURE = re.compile(r"[A-Za-z_][\w., \[\]-]{0,300}")
FIELDS = 400  # shown; a table of thousands of numbers is edited as text


class Unfit(GbeamError):
    """A scenario is wrong.

    Parameters
    ----------
    problems : list of dict
        As :func:`problems` has them.
    """

    def __init__(self, problems: list[dict[str, Any]]) -> None:
        self.problems = problems
        super().__init__("; ".join(str(each["message"]) for each in problems))


def described(text: str, folder: Path) -> dict[str, Any]:
    """What a document holds: its fields, what is wrong with it, and what it means where nothing is.

    Parameters
    ----------
    text : str
    folder : Path
        Of the records that it may name.
    """
    made: dict[str, Any] = {"text": text, "fields": [], "errors": [], "meaning": ""}
    try:
        data = parse(NAME, text)
        made["fields"] = [*_fields(data)][:FIELDS]
        records(data, folder)
        from gbeam.analysis.study.describe import describe
        from gbeam.report.description import text as in_words

        made["meaning"] = in_words(describe(build(loads(text, NAME, folder=folder))))
    except GbeamError as error:
        made["errors"] = problems(error)
    return made


def edited(text: str, path: str, value: str) -> str:
    """Return the text with another value at a path; comments and all else stay.

    Raises
    ------
    InputError
        If there is no such value, or the text cannot be changed there.
    """
    source, place = Source(NAME, text, Path(), parse(NAME, text)), parse_path(path)
    span = source.places.get(place) if place else None
    if place is None or span is None:
        raise InputError(path, "is not written in the scenario", "add it to the text")
    before = source.raw(place)
    if isinstance(before, (dict, list)):
        raise InputError(path, "is a table", "change its values, or the text")
    literal = _literal(value, before)
    lines = text.split("\n")
    line, at = lines[span.value.line - 1], span.value
    lines[at.line - 1] = line[: at.column - 1] + literal + line[at.end - 1 :]
    changed = "\n".join(lines)
    try:
        sound = Source(NAME, changed, Path(), parse(NAME, changed)).raw(place) == json.loads(literal)
    except ScenarioError:
        sound = False
    if not sound:
        raise InputError(path, "cannot be changed here", "change the text")
    return changed


def with_record(text: str, motion: str, record: dict[str, str]) -> str:
    """Return the text with a flight's record in place of its acceleration, or of its record before.

    Raises
    ------
    InputError
        If the text is not one that can be changed there.
    """
    data = parse(NAME, text)
    source = Source(NAME, text, Path(), data)
    motions = data.get("motion")
    flight = motions.get(motion) if isinstance(motions, dict) else None
    flight = flight if isinstance(flight, dict) else {}
    key = next((each for each in ("record", "acceleration") if each in flight), None)
    fix = f"write it yourself: [motion.{motion}.record]"
    place = None if key is None else source.places.get(("motion", motion, key))
    if key is None or place is None or place.key.line != place.value.line or text.lstrip().startswith("{"):
        raise InputError(f"motion.{motion}", "is written in a way that cannot be changed here", fix)
    inside = ", ".join(f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in record.items())
    lines = text.split("\n")
    line = lines[place.value.line - 1]
    lines[place.value.line - 1] = f"{line[: place.key.column - 1]}record = {{ {inside} }}{line[place.value.end - 1 :]}"
    changed = "\n".join(lines)
    del flight[key]
    flight["record"] = record
    try:
        sound = parse(NAME, changed) == data
    except ScenarioError:
        sound = False
    if not sound:
        raise InputError(f"motion.{motion}", "is written in a way that cannot be changed here", fix)
    return changed


def records(data: Any, folder: Path) -> list[Path]:
    """The files that a scenario names, all of which must be records of the folder.

    Raises
    ------
    InputError
        If one is a path, or is not there.
    """
    found = []
    for path, value in _leaves(data):
        if path[-1] == "file":
            if not isinstance(value, str):
                raise InputError(path_text(path), "is no text", "give the name of a record")
            try:
                found.append(regular(folder, value))
            except InputError as error:
                raise InputError(path_text(path), f"{value[:100]!r} {error.problem}", error.fix) from None
    return found


def sweep_arguments(text: str, over: Sequence[str], measure: str) -> list[str]:
    """The arguments of `gbeam sweep` for one or two values of a scenario.

    Parameters
    ----------
    text : str
        Of the scenario.
    over : sequence of str
        ``PATH=VALUES`` each.
    measure : str
        Figures, separated by commas.

    Raises
    ------
    InputError
        If a path is none of the scenario's values, or is that of a file, which would lead out of the folder.
    """
    data = parse(NAME, text)
    if "sweep" in data:
        raise InputError("sweep", "is a table of the scenario", "take it out: the page says what varies")
    known = {field["path"] for field in _fields(data)}
    arguments = []
    if not 1 <= len(over) <= 2:
        raise InputError("over", f"has {len(over)} values", "vary one or two")
    for each in over:
        path, _, values = each.partition("=")
        if path not in known or path.rpartition(".")[2] == "file" or not values.strip():
            fix = "choose a value of the form, and say which values"
            raise InputError(path[:100] or "over", "cannot be varied", fix)
        arguments += ["--over", each]
    if not _MEASURE.fullmatch(measure):
        raise InputError("measure", f"is {measure[:100]!r}", 'name figures, such as "tip.z.max_abs"')
    return [*arguments, "--measure", measure]


def problems(error: GbeamError) -> list[dict[str, Any]]:
    """What is wrong, each with its path, its message, the fix, and its line where it has one."""
    if isinstance(error, Unfit):
        return error.problems
    if isinstance(error, ScenarioError):
        return [_problem(each) for each in error.diagnostics]
    if isinstance(error, InputError):
        return [{"path": error.where, "message": error.problem, "hint": error.fix, "line": None}]
    return [{"path": "", "message": str(error), "hint": "", "line": None}]


def _problem(each: Diagnostic) -> dict[str, Any]:
    return {"path": each.path, "message": each.message, "hint": each.hint, "line": each.line}


def _literal(value: str, before: Any) -> str:
    """A value as TOML and JSON write it: a number or a truth value only where one stood."""
    if isinstance(before, (bool, int, float)):
        try:
            new = json.loads(value)
        except json.JSONDecodeError:
            new = value
        if isinstance(new, (bool, int, float)):
            return json.dumps(new)
    return json.dumps(value, ensure_ascii=False)


def _leaves(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    if isinstance(node, dict):
        for key, each in node.items():
            yield from _leaves(each, (*path, key))
    elif isinstance(node, list) and any(isinstance(each, (dict, list)) for each in node):
        for i, each in enumerate(node):
            yield from _leaves(each, (*path, i))
    elif path:
        yield path, node


def _fields(data: Any) -> Iterator[dict[str, Any]]:
    for path, value in _leaves(data):
        if isinstance(value, list):
            continue
        shown = value if isinstance(value, str) else json.dumps(value)
        yield {"path": path_text(path), "value": shown, "help": _help(tuple(path))}


@cache
def _schema() -> dict[str, Any]:
    schema: dict[str, Any] = json.loads(json_schema())
    return schema


def _help(path: tuple[Any, ...]) -> str:
    """What the schema says of a key; empty where it says nothing, or not only one thing."""
    nodes = [_schema()]
    words = ""
    for step in path:
        nexts = [each for node in nodes for each in _inside(node, step)]
        words = next((str(each["description"]) for each in nexts if "description" in each), "")
        nodes = nexts
    return words


def _inside(node: dict[str, Any], step: Any) -> Iterator[dict[str, Any]]:
    """The schemas of what is inside, of every alternative."""
    for each in _alternatives(node):
        if isinstance(step, int):
            if isinstance(each.get("items"), dict):
                yield each["items"]
        elif step in each.get("properties", {}):
            yield each["properties"][step]
        elif isinstance(each.get("additionalProperties"), dict):
            yield each["additionalProperties"]


def _alternatives(node: dict[str, Any]) -> Iterator[dict[str, Any]]:
    if "$ref" in node:
        yield from _alternatives(_schema()["$defs"][node["$ref"].rsplit("/", 1)[-1]])
    for each in (*node.get("anyOf", ()), *node.get("oneOf", ()), *node.get("allOf", ())):
        yield from _alternatives(each)
    yield node
