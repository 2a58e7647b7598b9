"""Text of a scenario, parsed and overridden, with the places of its entries."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import accumulate
from pathlib import Path as File
from typing import Any, Literal

from gbeam.errors import InputError
from gbeam.guards.limits import SCENARIO_BYTES, in_bytes, refuse_large_file
from gbeam.printable import closest
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import Override, crowded, excess, no_text
from gbeam.scenario.values import Distribution, Path, Place, Span, path_text, written_at

STDIN = File("<stdin>")  # in place of the name of a file
_LONG = "give long tables as a record: [motion.NAME.record]"
_SPACE = re.compile(r"(?:\s|#[^\n]*)*+")
_STRING = r"\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+'"
_KEY = re.compile(rf"{_STRING}|[\w-]++")
_VALUE = re.compile(
    rf'"""(?:[^\\]|\\.)*?"""(?!")|\'\'\'.*?\'\'\'(?!\')|{_STRING}|'
    r"[^\s,\[\]{}#\"']++(?: \d\d:[^\s,\]}#]++)?",  # the hour may stand apart from the date
    re.DOTALL,
)


def is_json(text: str) -> bool:
    """True if a scenario is JSON, false if it is TOML."""
    return text.lstrip().startswith("{")  # no TOML document begins with a brace


def locate(text: str) -> dict[Path, Place]:
    """Map every path of a text that has been parsed, such as ``("beam", "masses", 0, "at")``, to its place."""
    reader = _Reader(text)
    if is_json(text):
        span = reader.value(())
        reader.places[()] = Place(span, span)
    else:
        reader.tables()
    return reader.places


class _Reader:
    """Reader of a text that has been parsed, from `at` on, which collects the places of its entries by path."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.unquoted = json.loads if is_json(text) else lambda key: next(iter(tomllib.loads(f"{key} = 0")))
        self.lines = text.split("\n")
        self.starts = [*accumulate((len(line) + 1 for line in self.lines), initial=0)]
        self.places: dict[Path, Place] = {}

    def tables(self) -> None:
        """Read a document of TOML."""
        path: Path = ()
        counts: dict[Path, int] = {}
        while self.peek():
            if not self.skip("["):
                self.pair(path)
                continue
            opens, path = self.skip("["), ()
            names = self.keys()
            for i, (name, key) in enumerate(names, 1):
                path += (name,)
                self.places.setdefault(path, Place(key, key))
                if opens and i == len(names):
                    counts[path] = counts.get(path, -1) + 1
                if path in counts:  # a header below an array of tables belongs to its latest element
                    path += (counts[path],)
                    self.places.setdefault(path, Place(key, key))
            while self.skip("]"):
                pass

    def pair(self, path: Path) -> None:
        """Read ``key = value``, or ``"key": value`` of JSON; a dotted key may open a table again."""
        names = self.keys()
        self.skip("=")
        self.skip(":")
        value = self.value((*path, *(name for name, _ in names)))
        for name, key in names:
            path += (name,)
            self.places.setdefault(path, Place(key, value))
        self.places[path] = Place(key, value)  # in JSON the last of equal keys holds

    def keys(self) -> list[tuple[str, Span]]:
        """Read a key, and return its name, or its names if it is dotted, with their places."""
        names: list[tuple[str, Span]] = []
        while not names or self.skip("."):
            self.peek()
            start, key = self.at, self.take(_KEY)
            names.append((self.unquoted(key) if key[0] in "\"'" else key, self.span(start)))
        return names

    def value(self, path: Path) -> Span:
        """Read a value, with the entries inside it, and return its place."""
        self.peek()
        start, index = self.at, 0
        if self.skip("{"):
            while not self.skip("}"):
                self.pair(path)
                self.skip(",")
        elif self.skip("["):
            while not self.skip("]"):
                element = self.value((*path, index))
                self.places[*path, index] = Place(element, element)
                self.skip(",")
                index += 1
        else:
            self.take(_VALUE)
        return self.span(start)

    def peek(self) -> str:
        """Pass spaces and comments, and return the next character, or "" at the end."""
        self.take(_SPACE)
        return self.text[self.at : self.at + 1]

    def skip(self, character: str) -> bool:
        """Pass a character if it comes next; return true if it did."""
        comes = self.peek() == character
        self.at += comes
        return comes

    def take(self, pattern: re.Pattern[str]) -> str:
        """Pass the text that a pattern matches, and return it."""
        match = pattern.match(self.text, self.at)
        assert match is not None  # since the text has been parsed
        self.at = match.end()
        return match[0]

    def span(self, start: int) -> Span:
        """Return the place of the text from `start` to the current position, cut at the end of its first line."""
        row = bisect_right(self.starts, start) - 1
        first, following = self.starts[row], self.starts[row + 1]
        end = self.at - first if self.at < following else len(self.lines[row].rstrip())
        return Span(row + 1, start - first + 1, end + 1)


Mark = Literal["value", "key"]


@dataclass(frozen=True)
class Source:
    """A scenario as it was written."""

    name: str  # of the file, as it was named
    text: str
    folder: File  # to which file names in it are relative
    data: dict[str, Any]  # the parsed text, with the overrides in it, and centres of distributions
    overrides: tuple[Override, ...] = ()
    distributions: Mapping[str, Distribution] = field(default_factory=dict)  # by the paths of their values

    @cached_property
    def places(self) -> dict[Path, Place]:
        """Places of the entries of the text."""
        return locate(self.text)

    def raw(self, path: Path) -> Any:
        """Return what is written at `path`, None if nothing is."""
        return written_at(self.data, path)

    def diagnostic(self, path: Path, message: str, hint: str = "", mark: Mark = "value") -> Diagnostic:
        """Diagnostic at the place of `path`: in the file, or in the override that wrote it."""
        override = self._override_of(path)
        if override is not None:
            return Diagnostic(self.name, path_text(path), message, hint, override=override.text)
        nearest = path  # the entry itself, or the innermost table or list around it that is written
        while nearest and nearest not in self.places:
            nearest = nearest[:-1]
        place = self.places.get(nearest)
        if place is None:
            span = Span(1, 1, 2)
        else:
            span = place.key if mark == "key" or nearest != path else place.value
        return at_span(self.name, self.text, span, path_text(path), message, hint)

    def _override_of(self, path: Path) -> Override | None:
        """Last override that set the entry at `path` or a table around it; else one inside an entry not in the text."""
        outer = [change for change in self.overrides if path[: len(change.path)] == change.path]
        if outer:
            return outer[-1]
        inner = [change for change in self.overrides if path and change.path[: len(path)] == path]
        return inner[-1] if inner and path not in self.places else None


def at_span(name: str, text: str, span: Span, path: str, message: str, hint: str) -> Diagnostic:
    """Make the diagnostic of a stretch of the text."""
    line = text.split("\n")[span.line - 1].rstrip("\r")
    return Diagnostic(name, path, message, hint, span.line, span.column, span.end, line)


def read_text(path: File) -> str:
    """Text of a scenario file, or of standard input; ScenarioError, with the reason, if it cannot be read."""
    try:
        if path == STDIN:
            data = standard_input()
            if len(data) > SCENARIO_BYTES:
                raise InputError("", f"has more than {in_bytes(SCENARIO_BYTES)}", _LONG)
        else:
            refuse_large_file("", path, SCENARIO_BYTES, _LONG)
            data = path.read_bytes()
        return data.decode("utf-8-sig")
    except InputError as error:
        problem, hint = error.problem.removeprefix(f"{path} "), error.fix
    except FileNotFoundError:
        folder = path.parent
        neighbours = sorted(p.name for p in folder.glob("*") if p.suffix in (".toml", ".json"))
        suggestion = closest(path.name, neighbours)
        hint = (
            f"did you mean {str(path.with_name(suggestion))!r}?"
            if suggestion
            else "`gbeam new` writes one to start from"
        )
        problem = "there is no such file"
    except UnicodeDecodeError as error:
        if b"\0" not in data:
            raise ScenarioError([_in_another_encoding(str(path), error)]) from None
        problem, hint = "is not UTF-8 text", "save it as UTF-8, or give the path of a scenario file, TOML or JSON"
    except OSError as error:
        problem, hint = f"cannot be read ({error.strerror})", "give the path of a scenario file"
    except ValueError:  # a null character in the name
        problem, hint = "is no name of a file", "give the path of a scenario file"
    raise ScenarioError([Diagnostic(str(path) if str(path).strip() else repr(str(path)), "", problem, hint)])


def _in_another_encoding(name: str, error: UnicodeDecodeError) -> Diagnostic:
    """Diagnostic of the first byte of a text that is not UTF-8."""
    decoded, rest = error.object[: error.start].decode("utf-8-sig"), error.object[error.start :].decode("latin-1")
    lines = decoded.split("\n")
    column = len(lines[-1]) + 1
    problem = f"the byte 0x{ord(rest[0]):02x}, {rest[0]!r} in Latin-1, is not UTF-8"
    return at_span(name, decoded + rest, Span(len(lines), column, column + 1), "", problem, "save it as UTF-8")


@cache
def standard_input() -> bytes:
    """Bytes of a scenario on standard input, which can be read only once, and one more than are read at most."""
    return sys.stdin.buffer.read(SCENARIO_BYTES + 1) if sys.stdin else b""  # None where it is closed


def parse(name: str, text: str) -> dict[str, Any]:
    """Parse TOML, or JSON if the text begins with a brace; a ScenarioError says where the syntax is wrong."""
    refused = no_text(text) or excess(text)
    if refused is not None:
        span, problem, fix = refused
        raise ScenarioError([at_span(name, text, span, "", problem, fix)])
    try:
        data: dict[str, Any] = json.loads(text) if is_json(text) else tomllib.loads(text)
        half = no_text(json.dumps(data, ensure_ascii=False)) if is_json(text) else None
        if half is not None:  # written as an escape, at an unknown place
            raise ScenarioError([at_span(name, text, Span(1, 1, 2), "", *half[1:])])
        full = crowded(data)
        if full is not None:
            raise ScenarioError([Diagnostic(name, path_text(full[0]), full[1], "give what is long as a record")])
        return data
    except json.JSONDecodeError as error:
        line, column, message = error.lineno, error.colno, error.msg
    except tomllib.TOMLDecodeError as error:
        # Its place is in its text only: "... (at line 3, column 5)" or "... (at end of document)".
        match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", str(error), re.DOTALL)
        message = match[1] if match else str(error)
        if match and match[2]:
            line, column = int(match[2]), int(match[3])
        else:
            lines = text.rstrip("\n").split("\n")
            line, column = len(lines), len(lines[-1]) + 1
    language = "JSON" if is_json(text) else "TOML"
    problem = message[:1].lower() + message[1:]
    span = Span(line, column, column + 1)
    raise ScenarioError([at_span(name, text, span, "", f"{problem}", f"this is not valid {language}")])
