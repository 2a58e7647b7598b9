"""Diagnostics of a scenario, with their places, which print like a compiler's messages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from gbeam.errors import InputError
from gbeam.printable import on_one_line, printable, shortened

LONGEST_MESSAGE = 1000  # characters: it may list thirty columns
_WIDTH = 180  # characters of the line of the file


@dataclass(frozen=True)
class Diagnostic:
    """One error in a scenario."""

    file: str  # the scenario's, as it was named
    path: str  # ``beam.masses[0].at``; empty for the file as a whole
    message: str  # what is wrong
    hint: str = ""  # what would be right; may be empty
    line: int | None = None  # from 1, as the columns; None if the file cannot be read, or of an override
    column: int | None = None
    end: int | None = None  # the column after the last
    source_line: str | None = None
    override: str | None = None  # the ``key=value`` of ``--set`` that it came from

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}:{self.column}"
        if self.override is not None:
            place = f"--set {self.override}"
        parts = (shortened(place), shortened(self.path), shortened(self.message, LONGEST_MESSAGE))
        lines = [on_one_line(": ".join(part for part in parts if part))]
        margin = "    "
        if self.source_line is not None and self.column is not None:
            number = f"{self.line}"
            margin += " " * len(number)
            line, offset = self._excerpt(self.source_line, self.column - 1)
            # Tabs stay, so that the caret stands under its column however wide they are shown.
            indent = "".join(c if c == "\t" else " " for c in printable(line[:offset]))
            marked = printable(line[offset : offset + max((self.end or 0) - self.column, 1)])
            lines += [f"    {number} | {printable(line)}", f"{margin} | {indent}{'^' * max(len(marked), 1)}"]
            margin += " "
        if self.hint:
            lines.append(f"{margin}= {on_one_line(shortened(self.hint, LONGEST_MESSAGE))}")
        return "\n".join(lines)

    @staticmethod
    def _excerpt(line: str, column: int) -> tuple[str, int]:
        """Part of a line to show, which may be a megabyte, and the index of the column in that part."""
        if len(line) <= _WIDTH:
            return line, column
        start = min(max(column - _WIDTH // 3, 0), len(line) - _WIDTH)
        return line[start : start + _WIDTH], column - start


class ScenarioError(InputError):
    """The scenario is wrong (exit status 2).

    It tells everything that is wrong at once, each at its place in the file, which it keeps wherever it is seen from.
    Its own `where`, `problem` and `fix` are those of the first.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(sorted(diagnostics, key=lambda d: (d.line or 0, d.column or 0)))
        first = self.diagnostics[0]
        super().__init__(first.path, first.message, first.hint)
        self.args = ("\n".join(str(d) for d in self.diagnostics),)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.diagnostics,)

    def at(self, where: str) -> ScenarioError:
        """Return the error itself: its places are the file's."""
        return self

    def as_json(self) -> list[dict[str, str | int | None]]:
        """Return the diagnostics as objects for JSON; without the line of the file where that is very long."""
        objects = [asdict(diagnostic) for diagnostic in self.diagnostics]
        for facts in objects:
            if len(facts["source_line"] or "") > LONGEST_MESSAGE:
                facts["source_line"] = None
        return objects
