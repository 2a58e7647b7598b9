"""Places of a scenario's values in its text, TOML or JSON."""

from __future__ import annotations

import json
import re
import tomllib
from bisect import bisect_right
from itertools import accumulate

from gbeam.scenario.values.paths import Path, Place, Span

_SPACE = re.compile(r"(?:\s|#[^\n]*)*+")
_STRING = r"\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+'"
_KEY = re.compile(rf"{_STRING}|[\w-]++")
_VALUE = re.compile(
    rf'"""(?:[^\\]|\\.)*?"""(?!")|\'\'\'.*?\'\'\'(?!\')|{_STRING}|'
    r"[^\s,\[\]{}#\"']++(?: \d\d:[^\s,\]}#]++)?",  # the hour may stand apart from the date
    re.DOTALL,
)


def is_json(text: str) -> bool:
    """Tell whether a scenario is JSON, not TOML."""
    return text.lstrip().startswith("{")  # no TOML document begins with a brace


def locate(text: str) -> dict[Path, Place]:
    """Map every path of a text that has been parsed, such as ``("beam", "masses", 0, "at")``, to its place."""
    reader = _Reader(text)
    if is_json(text):
        whole = reader.value(())
        reader.places[()] = Place(whole, whole)
    else:
        reader.tables()
    return reader.places


class _Reader:
    """Passes through a text and notes where its entries stand."""

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
        while self.next():
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
        """Read a key: its names, of which a dotted one has several."""
        names: list[tuple[str, Span]] = []
        while not names or self.skip("."):
            self.next()
            start, key = self.at, self.take(_KEY)
            names.append((self.unquoted(key) if key[0] in "\"'" else key, self.span(start)))
        return names

    def value(self, path: Path) -> Span:
        """Read a value with what is inside it."""
        self.next()
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

    def next(self) -> str:
        """Return the next character behind spaces and comments, empty at the end."""
        self.take(_SPACE)
        return self.text[self.at : self.at + 1]

    def skip(self, character: str) -> bool:
        """Pass a character if it comes next, and tell whether it did."""
        comes = self.next() == character
        self.at += comes
        return comes

    def take(self, pattern: re.Pattern[str]) -> str:
        """Pass what a pattern matches, and return it."""
        match = pattern.match(self.text, self.at)
        assert match is not None  # since the text has been parsed
        self.at = match.end()
        return match[0]

    def span(self, start: int) -> Span:
        """Return the place of the text from `start` to here, cut at the end of its first line."""
        row = bisect_right(self.starts, start) - 1
        first, following = self.starts[row], self.starts[row + 1]
        end = self.at - first if self.at < following else len(self.lines[row].rstrip())
        return Span(row + 1, start - first + 1, end + 1)
