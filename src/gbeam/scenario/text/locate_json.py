"""Where each key and value stands in a JSON text (tree-sitter's JSON grammar lacks 1e+16 and NaN)."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from gbeam.scenario.values.paths import Path, Place, Span

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]:,]|[^\s{}\[\]:,"]+')


def locate_json(text: str) -> dict[Path, Place]:
    """Map every path to its place."""
    reader = _Reader(text)
    reader.value((), None)
    return reader.places


class _Reader:
    """Reads token after token and notes the places it passes."""

    def __init__(self, text: str) -> None:
        self.lines = text.split("\n")
        self.tokens = self._tokens()
        self.places: dict[Path, Place] = {}

    def _tokens(self) -> Iterator[tuple[str, Span]]:
        for number, line in enumerate(self.lines, start=1):
            for match in _TOKEN.finditer(line):
                yield match[0], Span(number, match.start() + 1, match.end() + 1)

    def value(self, path: Path, key: Span | None) -> None:
        """Read the next value."""
        token, span = next(self.tokens)
        self.value_from(path, key, token, span)

    def value_from(self, path: Path, key: Span | None, token: str, span: Span) -> None:
        """Read the value whose first token has been taken."""
        last = span
        if token in ("[", "{"):
            index = 0
            for inner, last in self.tokens:
                if inner in ("]", "}"):
                    break
                if inner == ",":
                    continue
                if token == "[":
                    self.value_from((*path, index), None, inner, last)
                    index += 1
                else:
                    next(self.tokens)  # the colon
                    self.value((*path, json.loads(inner)), last)
        end = last.end if last.line == span.line else len(self.lines[span.line - 1].rstrip()) + 1
        whole = Span(span.line, span.column, end)
        self.places[path] = Place(key or whole, whole)
