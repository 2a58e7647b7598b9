"""A scenario as text and as fields: two views of one document, with the command line's own messages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from gbeam.app.fields import fields, leaves
from gbeam.app.files import regular
from gbeam.errors import GbeamError, InputError
from gbeam.scenario import ScenarioError, build, loads
from gbeam.scenario.text.diagnostics import Diagnostic
from gbeam.scenario.text.source import Source, parse
from gbeam.scenario.values.paths import Place, parse_path, path_text

NAME = "scenario.toml"
_MEASURE = re.compile(r"[A-Za-z_][\w., \[\]-]{0,300}")
LONGEST = 60  # lines of a profile that a record takes the place of
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
        made["fields"] = [*fields(data)][:FIELDS]
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
    if key is not None and place is not None and not text.lstrip().startswith("{"):
        del flight[key]
        flight["record"] = record
        kind = source.places.get(("motion", motion, "kind"))
        for changed in _replaced(text.split("\n"), place, None if kind is None else kind.key.line, record):
            with suppress(ScenarioError):
                if parse(NAME, changed) == data:
                    return changed
    raise InputError(f"motion.{motion}", "is written in a way that cannot be changed here", fix)


def _replaced(lines: list[str], place: Place, kind: int | None, record: dict[str, str]) -> Iterator[str]:
    """The text with a record in place of an entry, which ends on its own line or a later one, or is tables of its own.

    `kind` is the number of the line that says that the motion is a flight.
    """
    inside = ", ".join(f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in record.items())
    new, first = f"record = {{ {inside} }}", place.key.line - 1
    before = f"{lines[first][: place.key.column - 1]}{new}"
    if place.value.line == place.key.line:
        yield "\n".join([*lines[:first], before + lines[first][place.value.end - 1 :], *lines[first + 1 :]])
    for after in range(first + 1, min(first + LONGEST, len(lines)) + 1):
        yield "\n".join([*lines[:first], before, *lines[after:]])
        if kind is not None and kind <= first:
            yield "\n".join([*lines[:kind], new, *lines[kind:first], *lines[after:]])


def records(data: Any, folder: Path) -> list[Path]:
    """The files that a scenario names, all of which must be records of the folder.

    Raises
    ------
    InputError
        If one is a path, or is not there.
    """
    found = []
    for path, value in leaves(data):
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
    known = {field["path"] for field in fields(data)}
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
