"""Blocks of which a report is made: tables, sentences and sections as data, drawn in words here and by the page."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from gbeam.constants import DEGREE, RPM, STANDARD_GRAVITY
from gbeam.printable import raised
from gbeam.report.words import columns, number, percent, rounding

Facts = Mapping[str, Any]  # of the JSON, with None for what is not finite
# Units in which tables have numbers that JSON has in SI.
_SHOWN = {
    "mm": 1e3,
    "ms": 1e3,
    "MPa": 1e-6,
    "µm/m": 1e6,
    "g": 1 / STANDARD_GRAVITY,
    "g/s": 1 / STANDARD_GRAVITY,
    "deg": 1 / DEGREE,
    "rpm": 1 / RPM,
}

_NUMERIC = re.compile(r"[-+±–<]?\s*\d.*|–?")


@dataclass(frozen=True)
class Cell:
    """A cell of a table with a tone, or a bar beside it."""

    text: str
    tone: str = ""
    share: float = math.nan  # of the bar, 0 to 1; NaN for none


Value = Cell | str | float | None  # of a cell; numbers get four digits
Column = str | Callable[[Any], Value]  # path in a row with a format, such as `tip.x:.6g`, or what makes a cell of it
Columns = dict[str, Column]  # by their heads


@dataclass(frozen=True)
class Table:
    """Rows of cells below their heads; of what is longer than `most` a terminal has the first rows only."""

    heads: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    most: int | None = None
    detail: bool = False  # whether it is for a page only

    def numeric(self, column: int) -> bool:
        """Return True if all cells of a column are numbers, which stand to the right."""
        return all(_NUMERIC.fullmatch(row[column].text) for row in self.rows)


@dataclass(frozen=True)
class Sentence:
    """A sentence."""

    text: str
    tone: str = ""


@dataclass(frozen=True)
class Items:
    """Sentences one below the other, in a page as a list."""

    lines: tuple[str, ...]
    tone: str = ""


@dataclass(frozen=True)
class Verbatim:
    """Text to be copied."""

    text: str


@dataclass(frozen=True)
class Place:
    """Place of the figures, or of the viewer, in a page."""

    of: Literal["figures", "viewer"]
    hint: str = ""


@dataclass(frozen=True)
class Section:
    """Blocks below a title; nothing where no block has anything."""

    title: str
    blocks: tuple[Block, ...]
    titled: bool = False  # whether a terminal has the title, too
    folded: str = ""  # words that a page shows instead until they are clicked, if any
    detail: bool = False  # whether it is for a page only
    tone: str = ""  # of the title in a terminal
    verbose: bool = False  # whether a terminal has it with --verbose only


Block = Table | Sentence | Items | Verbatim | Place | Section
Blocks = Iterator[Block]
FIGURES = Place("figures")


def table(
    rows: Iterable[Any],
    cells: Mapping[str, Column],
    caption: str = "",
    optional: Iterable[str] = (),
    scale: float = 0.0,
    **options: Any,
) -> Table:
    """Return a table of rows of JSON. `cells` are its columns by their heads. `optional` ones are left out where empty.

    Numbers at paths are in SI: a head such as "stress, MPa" converts them. A number that is only a rounding error
    beside the largest one of the same unit, or beside a larger `scale`, is shown as zero.
    """
    forms = ["" if callable(column) else column.partition(":")[2] for column in cells.values()]
    units = ["" if callable(column) else _unit(head) for head, column in cells.items()]
    values = [[_value(row, column) for column in cells.values()] for row in rows]
    scales = dict.fromkeys(units, 0.0)
    for row_values in values:
        for unit, value in zip(units, row_values, strict=True):
            if isinstance(value, (int, float)):
                scales[unit] = max(scales[unit], abs(value))

    def cell(value: Value, form: str, unit: str) -> Cell:
        if unit and isinstance(value, (int, float)):
            value = 0.0 if abs(value) <= rounding(scales[unit], scale) else factor(unit) * value
        return _cell(value, form)

    cell_rows = [tuple(map(cell, row, forms, units)) for row in values]
    kept_columns, heads = [], []
    for k, head in enumerate(cells):
        if head not in optional or any(row[k].text not in " –" for row in cell_rows):
            kept_columns.append(k)
            heads.append(head.strip())
    shown_rows = tuple(tuple(row[k] for k in kept_columns) for row in cell_rows)
    return Table(tuple(heads), shown_rows, caption, **options)


def _unit(head: str) -> str:
    return head.strip().rpartition(", ")[2] if ", " in head else ""


def factor(unit: str) -> float:
    """Return how many of a unit, or of the unit at the end of a head, make one of SI."""
    return _SHOWN.get(_unit(unit) or unit, 1.0)


def pairs(rows: Iterable[tuple[str, Value]], caption: str = "") -> Table:
    """Return a table of names and values, without heads."""
    return Table(("", ""), tuple((Cell(name), _cell(value)) for name, value in rows), caption)


def name_rows(rows: Facts) -> list[Facts]:
    """Return the rows of a JSON object as a list, each with its key as ``name``."""
    return [{"name": name, **row} for name, row in rows.items()]


def number_rows(rows: Iterable[Facts]) -> list[Facts]:
    """Return the rows of a JSON list, each with its number from one as ``number``."""
    return [{"number": str(k), **row} for k, row in enumerate(rows, 1)]


_APART = ("form", "units", "provenance", "warnings", "notes", "files", "title", "outcome", "state", "lines")


def quantities(
    facts: Facts, units: Mapping[str, str] | None = None, place: str = "", words: Mapping[str, str] | None = None
) -> Iterator[Block]:
    """Yield any JSON as blocks: a table of its plain values, and a section for each list of rows and each object.

    `units` and `words` are by path. `place` is the path of `facts`.
    """

    units = facts.get("units", {}) if units is None else units
    entries = {key: value for key, value in facts.items() if key not in _APART and value not in (None, "")}
    cells: dict[str, Column] = {
        "": lambda key: key.replace("_", " "),
        " ": lambda key: entries[key],
        "  ": lambda key: raised(units.get(place + key, "")),
        "   ": lambda key: (words or {}).get(place + key, ""),
    }
    yield table(
        [key for key, value in entries.items() if not isinstance(value, (dict, list))], cells, optional=("   ",)
    )
    for key, value in entries.items():
        if key == "motions":
            for name, motion in value.items():
                blocks = tuple(quantities(motion, units, f"{place}motions.*.", words))
                yield Section(f"motion {name}", blocks, titled=True)
            continue
        if isinstance(value, dict) and not all(isinstance(entry, dict) for entry in value.values()):
            yield Section(key.replace("_", " "), tuple(quantities(value, units, f"{place}{key}.", words)), titled=True)
            continue
        named_rows = isinstance(value, dict)
        rows = [{"": name, **row} for name, row in value.items()] if named_rows else value
        if isinstance(rows, list) and rows and all(isinstance(row, dict) for row in rows):
            path = f"{place}{key}.*." if named_rows else f"{place}{key}[i]."
            columns: dict[str, Column] = {}
            for column, entry in rows[0].items():
                if not isinstance(entry, (dict, list)):
                    unit = raised(units.get(path + column, ""))
                    columns[", ".join(filter(None, (column.replace("_", " "), unit)))] = column
            yield Section(key.replace("_", " "), (table(rows, columns, most=24),), titled=True)


def _value(row: Any, column: Column) -> Value:
    """Value of a column in a row: by the column's function, or at its path. None where a key of the path is missing."""
    if callable(column):
        return column(row)
    value = row
    for key in column.partition(":")[0].split("."):
        if isinstance(value, Mapping):
            value = value.get(key)
        elif value is not None:
            value = value[int(key)]
    result: Value = value
    return result


def _cell(value: Value, form: str = "") -> Cell:
    """Cell of a value: a dash for None and for what is not finite; numbers by the format `form`, or
    with four digits.
    """
    match value:
        case Cell():
            return value
        case bool():
            return Cell("yes" if value else "no")
        case str() | int():
            return Cell(str(value))
        case None:
            return Cell("–")
    if not math.isfinite(value):
        return Cell("–")
    if form == "%":
        return Cell(percent(value))
    return Cell(f"{value:{form}}".rstrip(".") if form else number(value))


def six(value: float | str | None) -> Cell:
    """Cell of a value that is to be copied, with six digits."""
    return _cell(value, ".6g")


def in_words(blocks: Iterable[Block], *, verbose: bool = True) -> list[tuple[str, str]]:
    """Return blocks as lines of text, each with its tone. Sections and captioned tables stand between empty lines."""
    lines: list[tuple[str, str]] = []
    for line, tone in _lines(blocks, verbose):
        if line or (lines and lines[-1][0]):
            lines.append((line, tone))
    return lines if not lines or lines[-1][0] else lines[:-1]


_BLANK = ("", "")


def _lines(blocks: Iterable[Block], verbose: bool) -> Iterator[tuple[str, str]]:
    """Lines of blocks for a terminal, each with its tone. Empty lines stand around sections."""
    for block in blocks:
        match block:
            case Section(verbose=True) if not verbose:
                continue
            case Table(detail=False) if block.rows:
                yield from _rows(block)
            case Sentence():
                yield block.text, block.tone
            case Items():
                prefix = f"  {block.tone}: " if block.tone in ("warning", "note") else ""
                yield from ((f"{prefix}{line}", block.tone) for line in block.lines)
            case Verbatim():
                yield f"  {block.text}", ""
            case Section(detail=False, titled=False):
                yield from [_BLANK, *_lines(block.blocks, verbose), _BLANK]
            case Section(detail=False):
                inner_lines = ((f"  {line}".rstrip(), tone) for line, tone in _lines(block.blocks, verbose))
                yield from [_BLANK, (block.title, block.tone), *inner_lines, _BLANK]


def _rows(block: Table) -> Iterator[tuple[str, str]]:
    """Lines of a table for a terminal, each with its tone.

    A row with a bad cell is bad. Where the terminal is so narrow that rows are folded, they have no tone.
    """
    shown_rows = block.rows[: block.most]
    flush_left = {k for k in range(len(block.heads)) if not block.numeric(k)}
    lines = columns(list(block.heads), [[cell.text for cell in row] for row in shown_rows], flush_left)
    bad_rows = [any(cell.tone == "bad" for cell in row) for row in shown_rows]
    tones = ["faint", *("bad" if bad else "" for bad in bad_rows)]
    folded = len(lines) != len(tones)
    toned_lines = list(zip(lines, [""] * len(lines) if folded else tones, strict=True))
    if not folded and not any(block.heads):
        toned_lines = toned_lines[1:]
    if block.most is not None and len(block.rows) > block.most:
        toned_lines.append((f"and {len(block.rows) - block.most} more: see --json", ""))
    if block.caption:
        indented = [(f"  {line}", tone) for line, tone in toned_lines]
        toned_lines = [_BLANK, (f"{block.caption}:", ""), *indented, _BLANK]
    yield from toned_lines
