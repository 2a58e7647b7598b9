"""Columns of text files."""

from __future__ import annotations

import codecs
import csv
import os
import re
from collections import Counter
from itertools import zip_longest
from statistics import mode

from gbeam.errors import InputError
from gbeam.guards.limits import BINARY_BYTES, TEXT_BYTES, in_bytes, refuse_large_file
from gbeam.io.table import Column, Stated, Table, is_clock
from gbeam.motion.records.units import bracketed, is_unit, unit_in_name

# Usual endings of such files; :func:`read_text` reads any other, too.
ENDINGS = (".asc", ".csv", ".dat", ".log", ".lvm", ".prn", ".tab", ".tsv", ".txt")
_DELIMITERS = (",", ";", "\t", " ")  # the first that fits best; a space is any white space
_COMMENT = re.compile(r"\s*(#|%|//|;)+\s*")
_BEFORE_BRACKET = re.compile(r" (?=[\[(])")
_NUMBER = re.compile(r"[+-]?(\d++([.,]\d*+)?|[.,]\d++)([ed][+-]?\d++|[+-]\d{3})?|[+-]?(nan|inf)", re.IGNORECASE)
_BYTE_ORDER_MARKS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_BLANK = " \t\f,;"  # spreadsheets write empty rows as delimiters alone
_LINE_END = re.compile(r"\r\n|\r|\n")
_NOT_TEXT = re.compile(r"[\x00-\x08\x0e-\x1f]")
_LABVIEW, _END = "LabVIEW Measurement", "***End_of_Header***"
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
    is_labview = rows[0][1][0] == _LABVIEW
    ends = [i + 1 for i, (_, cells) in enumerate(rows) if is_labview and cells[0] == _END]
    start = max(ends[:2], default=0)  # of names and data: the heads of the file and of its first piece lie before
    data_rows = (i for i in range(start, len(rows)) if len(rows[i][1]) == width and _is_data(rows[i][1]))
    first = next(data_rows, len(rows))
    header, units = _header(path, [line for _, line in lines[start:first]], delimiter, width)
    indices = _indices(header)
    data = [row for row, (_, line) in zip(rows[first:], lines[first:], strict=True) if not _comment(line, ";")]
    for number, cells in data:
        if len(cells) not in (width, len(header)):
            raise InputError(
                "record.file", f"row {number} has {len(cells)} cells, the header {len(header)}", "complete the row"
            )
    labview_units, stated, remarks = _labview({cells[0]: cells[1:] for _, cells in rows[:start]}, len(data))
    units = [unit or labview_unit for unit, labview_unit in zip_longest(units, labview_units[:width], fillvalue="")]
    columns = (
        _column(name, unit, data, i, indexed=name in indices)
        for i, (name, unit) in enumerate(zip(header[:width], units, strict=False))
    )
    return Table(tuple(columns), [number for number, _ in data], stated, remarks)


def _labview(header: dict[str, list[str]], count: int) -> tuple[list[str], tuple[Stated, ...], tuple[str, ...]]:
    """Units of the columns, sample rate and remarks from the entries of LabVIEW's header, by their names.

    The file has one column of X or none. The header's number of samples is that of the first piece, or of the whole.
    """
    labels, time = header.get("Y_Unit_Label", []), ["s" if header.get("X_Dimension", [])[:1] == ["Time"] else ""]
    x_columns = "".join(header.get("X_Columns", ["One"])[:1])
    units = {"One": time + labels, "No": labels}.get(x_columns, []) if labels else []
    try:
        stated = tuple(Stated.read("Delta_X", float(header["Delta_X"][0]), "/"))
        samples = int(header["Samples"][0])
    except (KeyError, ValueError, IndexError):
        return units, (), ()
    remark = f"the file's header states {samples} samples, and it holds {count}"
    return units, stated, (remark,) if samples != count else ()


def _decoded(path: str | os.PathLike[str]) -> str:
    """Text of a file, in the encoding of its byte order mark, or UTF-8 or Latin-1. InputError if it is no text."""
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
    """Delimiter, and number of columns, for which the largest share of cells are numbers or times of day."""
    best_share, delimiter, width = 0.0, "", 0
    for candidate in _DELIMITERS:
        rows = [_cells(line, candidate) for line in body]
        usual = mode(len(cells) for cells in rows) if rows else 0
        numbers = sum(_count(cells) for cells in rows if len(cells) == usual)
        share = numbers / max(usual * len(rows), 1)
        if usual > 1 and share > best_share:
            best_share, delimiter, width = share, candidate, usual
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
    """Text of a comment, or None if a line is none. A line of semicolons may be one whose first cell is empty."""
    mark = _COMMENT.match(line)
    return None if mark is None or (delimiter == ";" == mark[1]) else line[mark.end() :]


def _header(path: str | os.PathLike[str], lines: list[str], delimiter: str, width: int) -> tuple[list[str], list[str]]:
    """Names and units of the columns, from the lines before the first row of numbers.

    The last line with as many cells as columns names them, or gives units to the names in the line above. A comment
    counts only where no plain line does.
    """
    headers: list[tuple[bool, list[str]]] = []
    for line in lines:
        comment = _comment(line, delimiter)
        cells = _cells(line if comment is None else comment, delimiter)
        if len(cells) == width - 1 and comment is None:  # every row of data ends in a delimiter
            cells = [*cells, ""]
        extra_name = len(cells) == width + 1 and delimiter != " "  # of a last column that is empty
        if extra_name and comment is None and line is lines[-1] and not _is_data(cells):
            return cells, [""] * width
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
    """Names that end in an index in brackets, ``acc[0]``. ``n_z [1]`` is a number of g, if no other has an index."""
    numbered = {name: pair for name in header if (pair := bracketed(name)) and pair[1].isdecimal()}
    stems = Counter(stem for stem, _ in numbered.values())
    return {name for name, (stem, index) in numbered.items() if index != "1" or stems[stem] > 1 or unit_in_name(stem)}


def _column(header: str, unit: str, data: list[Row], i: int, *, indexed: bool) -> Column:
    """Column `i` of the data, read with a decimal point. A unit may follow the name in brackets."""
    bracket = None if indexed else bracketed(header)
    aliases: tuple[str, ...] = ()
    if bracket is not None:
        aliases, unit = (bracket[0],), unit or bracket[1]

    def read() -> list[str]:
        cells = [row[i] for _, row in data]
        if any("," in cell for cell in cells) and not any("." in cell for cell in cells):
            return [cell.replace(",", ".") for cell in cells]
        return cells

    return Column(header, read, unit, aliases)
