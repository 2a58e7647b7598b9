"""What is wrong with a scenario, and where: records that print like a compiler's messages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass

from gbeam.errors import GbeamError


@dataclass(frozen=True)
class Diagnostic:
    """One thing that is wrong.

    Parameters
    ----------
    file : str
        The scenario file, as it was named.
    path : str
        Path of the quantity, ``beam.masses[0].at``; empty for the file as a whole.
    message : str
        What is wrong.
    hint : str
        What would be right; may be empty.
    line, column, end : int or None
        Where, from 1; `end` is the column after the last. None if it came from `override`, or the file cannot
        be read.
    source_line : str or None
        The line of the file.
    override : str or None
        The ``key=value`` of ``--set`` that it came from.
    """

    file: str
    path: str
    message: str
    hint: str = ""
    line: int | None = None
    column: int | None = None
    end: int | None = None
    source_line: str | None = None
    override: str | None = None

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}:{self.column}"
        if self.override is not None:
            place = f"--set {self.override}"
        lines = [": ".join(part for part in (place, self.path, self.message) if part)]
        margin = "    "
        if self.source_line is not None and self.column is not None:
            number = f"{self.line}"
            margin += " " * len(number)
            # Tabs stay, so that the caret stands under its column however wide they are shown.
            indent = "".join(c if c == "\t" else " " for c in self.source_line[: self.column - 1])
            carets = "^" * max((self.end or 0) - self.column, 1)
            lines += [f"    {number} | {self.source_line}", f"{margin} | {indent}{carets}"]
            margin += " "
        if self.hint:
            lines.append(f"{margin}= {self.hint}")
        return "\n".join(lines)


class ScenarioError(GbeamError):
    """The scenario is wrong (exit status 2): everything that is wrong with it, at once.

    Parameters
    ----------
    diagnostics : iterable of Diagnostic
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(sorted(diagnostics, key=lambda d: (d.line or 0, d.column or 0)))
        super().__init__("\n".join(str(d) for d in self.diagnostics))

    def as_json(self) -> list[dict[str, str | int | None]]:
        """Return the diagnostics as objects for JSON."""
        return [asdict(d) for d in self.diagnostics]
