"""Columns of text files, and times of day as times of a record."""

from __future__ import annotations

import codecs
import csv
import os
import re
from collections import Counter
from collections.abc import Callable
from statistics import mode

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.limits import BINARY_BYTES, TEXT_BYTES, in_bytes, refuse_large_file
from gbeam.io.table import Clock, Column, Table, is_clock
from gbeam.motion.records.conditioning import FEWEST, UNEVEN
from gbeam.motion.records.units import UNITS, Unit, is_unit, unit_in_name

Span = tuple[float | str | None, float | str | None]

SLOWEST = 5.0  # Hz
_FASTEST, _BRIEF = 1000.0, 10.0  # Hz, s: flight loads need no such rate, and last longer
_USUAL = (1e-3, 0.2)  # s: intervals of flight records
_ROUND = 1 + 1e-9
_GAP = 1.9  # of the median interval: a sample is missing, and no clock that jitters is as late


def check_sampling(time: Floats, place: Callable[[int], str], *, jitter: bool) -> float:
    """Refuse times (t,) s that stand still, go back, jump or, unless `jitter` is allowed, are uneven; return the
    largest distance, s, from even times.
    """
    steps = np.diff(time)

    def later(i: int) -> str:
        return f"{time[i + 1]:g} s at {place(i + 1)}, after {time[i]:g} s"

    back = np.flatnonzero(steps <= 0)
    if back.size:
        verb = "repeats" if steps[back[0]] == 0 else "goes back to"
        raise InputError("record.time", f"{verb} {later(int(back[0]))}", "sort the rows and delete repeated ones")
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * median)
    if gaps.size:
        i = int(gaps[0])
        raise InputError(
            "record.time",
            f"has a gap of {steps[i]:g} s from {time[i]:g} s to {time[i + 1]:g} s ({place(i + 1)}); "
            f"the interval is {median:g} s",
            "fill in the missing samples or cut the record there",
        )
    off = np.abs(steps - median)
    uneven = np.flatnonzero(off > UNEVEN * median)
    if uneven.size and not jitter:
        i = int(uneven[0])
        rate = float(f"{(len(time) - 1) / (time[-1] - time[0]):.3g}")
        raise InputError(
            "record.time",
            f"is sampled unevenly: {later(i)}, is {steps[i]:g} s where the interval is {median:g} s",
            f'add resample = "{rate:g} Hz": at equal intervals, by a spline through the samples',
        )
    samples = np.arange(len(time))
    even = np.polynomial.Polynomial.fit(samples, time, 1)(samples)
    return float(np.abs(time - even).max()) if uneven.size else 0.0


def check_interval(time: Floats, unit: Unit) -> None:
    """Refuse an interval of times (t,) s that no record of a flight has, and say which unit would make it one."""
    step, length = float(np.median(np.diff(time))), float(time[-1] - time[0])
    trust = 'if it is right as it is, add skip_checks = ["sampling"]'
    sizes, number = UNITS["time"], step / unit.size
    likely = [
        other for other, size in sizes.items() if size != unit.size and _USUAL[0] <= number * size * _ROUND <= _USUAL[1]
    ]
    hint = f"is the time in {likely[0]}? then {unit.instead('time_unit', likely[0])}; " if likely else ""
    if step > 1 / SLOWEST:
        raise InputError(
            "record.time",
            f"has a sample every {step:g} s ({1 / step:g} Hz), too coarse for the corners of a manoeuvre",
            f"{hint}export the record at 20 Hz or more; {trust}",
        )
    if step < 1 / _FASTEST and length < _BRIEF:
        raise InputError(
            "record.time",
            f"lasts {length:.3g} s with a sample every {step:.3g} s ({1 / step:.4g} Hz), which no flight load needs",
            f"{hint}{trust}",
        )


def part_within(clock: Floats, of_day: Clock | None, span: Span, counted: Callable[[int], str]) -> slice:
    """Return the samples within a span of a record's times (t,) s."""
    if span == (None, None):
        return slice(0, len(clock))
    first, last = float(clock[0]), float(clock[-1])
    interval = float(np.median(np.diff(clock)))
    shown = f"{first:g} to {last:g} s" if of_day is None else f"0 to {last:g} s, 0 s being {of_day.first}"

    def read(key: str, value: float | str | None, otherwise: float) -> float:
        if value is None:
            return otherwise
        number = of_day.seconds(value) if isinstance(value, str) and of_day is not None else value
        if number is None or isinstance(number, str):
            raise InputError(f"record.{key}", f"is {value!r}", f"give a time of the record's own clock, {shown}")
        if not first - interval <= number <= last + interval:
            what = value if isinstance(value, str) else f"{value:g} s"
            raise InputError(f"record.{key}", f"is {what}, and the record lasts {shown}", "give a time of it")
        return float(number)

    begin, end = read("from", span[0], first), read("to", span[1], last)
    slack = 1e-6 * interval
    inside = np.flatnonzero((clock >= begin - slack) & (clock <= end + slack))
    if inside.size < FEWEST:
        problem = f"leaves {counted(inside.size)} from {begin:g} to {end:g} s"
        fix = f"give more of {shown}: {FEWEST} samples at least"
        raise InputError(f"record.{'from' if span[1] is None else 'to'}", problem, fix)
    return slice(int(inside[0]), int(inside[-1]) + 1)


_DELIMITERS = (",", ";", "\t", " ")  # the first that fits best; a space is any white space
_COMMENT = re.compile(r"\s*(#|%|//|;)+\s*")
_BEFORE_BRACKET = re.compile(r" (?=[\[(])")
_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?|[+-]?(nan|inf)", re.IGNORECASE)
_BRACKETS = re.compile(r"(.*?)\s*[\[(]([^\])]*)[\])]")
_BYTE_ORDER_MARKS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_BLANK = " \t\f,;"  # spreadsheets write empty rows as delimiters alone
_LINE_END = re.compile(r"\r\n|\r|\n")
_NOT_TEXT = re.compile(r"[\x00-\x08\x0e-\x1f]")
_SAMPLE = 40  # lines from which the delimiter is judged

Row = tuple[int, list[str]]


def read_text(path: str | os.PathLike[str]) -> Table:
    """Read a table of text.

    Columns are separated by commas, semicolons, tabs or white space, with a decimal point or comma; UTF-8, UTF-16 or
    Latin-1. Lines that begin with ``#``, ``%``, ``//`` or, before the data, ``;`` are comments; the last of them names
    the columns if nothing else does. A row of units may follow the names, or a name may end in one: ``a_z [g]``.
    """
    lines = [(i, line) for i, line in enumerate(_LINE_END.split(_decoded(path)), start=1) if line.strip(_BLANK)]
    if not lines:
        raise InputError("record.file", f"{path} is empty", "give a CSV file with a header line")
    body = [line for _, line in lines[len(lines) // 2 :] if not _COMMENT.match(line)][:_SAMPLE]
    delimiter, width = _dialect(path, body)
    rows = [(number, _cells(line, delimiter)) for number, line in lines]
    first = next((i for i, (_, cells) in enumerate(rows) if len(cells) == width and _is_data(cells)), len(rows))
    header, units = _header(path, [line for _, line in lines[:first]], delimiter, width)
    indices = _indices(header)
    data = [row for row, (_, line) in zip(rows[first:], lines[first:], strict=True) if not _comment(line, ";")]
    for number, cells in data:
        if len(cells) != len(header):
            raise InputError(
                "record.file", f"row {number} has {len(cells)} cells, the header {len(header)}", "complete the row"
            )
    return Table(
        tuple(
            _column(name, unit, data, i, indexed=name in indices)
            for i, (name, unit) in enumerate(zip(header, units, strict=True))
        ),
        [number for number, _ in data],
    )


def _decoded(path: str | os.PathLike[str]) -> str:
    """Text of a file, in the encoding of its mark, or UTF-8, or Latin-1."""
    try:
        fix = f"cut the record, or save it as HDF5, of which {in_bytes(BINARY_BYTES)} are read"
        refuse_large_file("record.file", path, TEXT_BYTES, fix)
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise InputError(
            "record.file", f"{path} cannot be read ({error.strerror})", "give the path of a CSV file"
        ) from None
    encodings = [name for mark, name in _BYTE_ORDER_MARKS.items() if data.startswith(mark)]
    if not encodings and b"\0" in data[:4]:  # UTF-16 without its mark
        encodings = ["utf-16-be" if data[0] == 0 else "utf-16-le"]
    for encoding in encodings or ["utf-8", "latin-1"]:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not _NOT_TEXT.search(text):
            return text
    raise InputError("record.file", f"{path} is not CSV text", "save it as CSV, UTF-8")


def _dialect(path: str | os.PathLike[str], body: list[str]) -> tuple[str, int]:
    """Delimiter and number of columns for which the most cells of some lines are numbers or times of day."""
    best, delimiter, width = 0.0, "", 0
    for candidate in _DELIMITERS:
        rows = [_cells(line, candidate) for line in body]
        usual = mode(len(cells) for cells in rows) if rows else 0
        numbers = sum(_count(cells) for cells in rows if len(cells) == usual)
        share = numbers / max(usual * len(rows), 1)
        if usual > 1 and share > best:
            best, delimiter, width = share, candidate, usual
    if not width:
        if body and all(_NUMBER.fullmatch(line.strip()) for line in body):
            raise InputError("record.file", f"{path} has one column", "give a column of times and one per component")
        raise InputError("record.file", f"{path} is not CSV text with rows of numbers", "save it as CSV, UTF-8")
    return delimiter, width


def _cells(line: str, delimiter: str) -> list[str]:
    """Cells of a line, stripped and unquoted."""
    if delimiter == " ":  # a unit in brackets belongs to the name before it
        line = _BEFORE_BRACKET.sub("\0", " ".join(line.split()))
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        except csv.Error:  # a cell of more than 128 kB
            cells = line.split(delimiter)
    else:
        cells = line.split(delimiter)
    return [cell.strip().replace("\0", " ") for cell in cells]


def _count(cells: list[str]) -> int:
    """Number of cells with a number or a time of day."""
    return sum(_NUMBER.fullmatch(cell) is not None or is_clock(cell) for cell in cells)


def _is_data(cells: list[str]) -> bool:
    return 2 * _count(cells) >= sum(map(bool, cells))


def _comment(line: str, delimiter: str) -> str | None:
    """Text of a comment; None if a line is none. A line of semicolons may be one whose first cell is empty."""
    mark = _COMMENT.match(line)
    return None if mark is None or (delimiter == ";" == mark[1]) else line[mark.end() :]


def _header(path: str | os.PathLike[str], lines: list[str], delimiter: str, width: int) -> tuple[list[str], list[str]]:
    """Names and units of the columns, from the lines before the first of numbers."""
    headers: list[tuple[bool, list[str]]] = []
    for line in lines:
        comment = _comment(line, delimiter)
        cells = _cells(line if comment is None else comment, delimiter)
        if len(cells) == width - 1 and comment is None:  # every row of data ends in a delimiter
            cells = [*cells, ""]
        if len(cells) == width and not _is_data(cells):
            headers.append((comment is not None, cells))
    plain = [i for i, (commented, _) in enumerate(headers) if not commented]
    if not headers:
        problem = f"{path} has no header line with {width} names, as many as the data has columns"
        raise InputError("record.file", problem, "name the columns in the line above the data")
    last = plain[-1] if plain else len(headers) - 1
    header = headers[last][1]
    if last > 0 and any(is_unit(cell) for cell in header):
        return headers[last - 1][1], header
    return header, [""] * width


def _indices(header: list[str]) -> set[str]:
    """Names that end in an index in brackets, ``acc[0]``; ``n_z [1]`` is a number of g, if no other has an index."""
    numbered = {name: match for name in header if (match := _BRACKETS.fullmatch(name)) and match[2].strip().isdecimal()}
    stems = Counter(match[1] for match in numbered.values())
    return {
        name
        for name, match in numbered.items()
        if match[2].strip() != "1" or stems[match[1]] > 1 or unit_in_name(match[1])
    }


def _column(header: str, unit: str, data: list[Row], i: int, *, indexed: bool) -> Column:
    """Column `i` of the data, with a decimal point; its unit may stand in brackets behind its name."""
    bracket = None if indexed else _BRACKETS.fullmatch(header)
    aliases: tuple[str, ...] = ()
    if bracket is not None:
        aliases, unit = (bracket[1],), unit or bracket[2]

    def read() -> list[str]:
        cells = [row[i] for _, row in data]
        if any("," in cell for cell in cells) and not any("." in cell for cell in cells):
            return [cell.replace(",", ".") for cell in cells]
        return cells

    return Column(header, read, unit, aliases)
