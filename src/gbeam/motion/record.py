"""Flight records: CSV files with a header line, one row per sample, checked before they are used."""

from __future__ import annotations

import csv
import difflib
import os

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.motion.piecewise import PiecewiseLinear

STANDARD_GRAVITY = 9.80665  # m/s²
UNITS = {"g": STANDARD_GRAVITY, "m/s^2": 1.0, "m/s²": 1.0}
_UNEVEN, _GAP = 0.01, 1.5  # of the median interval
_NO_COLUMN = "0"


def read_record(path: str | os.PathLike[str], time: str, x: str, y: str, z: str, unit: str) -> PiecewiseLinear:
    """Read an acceleration (or specific-force) record.

    Parameters
    ----------
    path : path
        CSV file, commas, UTF-8; its first line names the columns.
    time : str
        Name of the column of times, s.
    x, y, z : str
        Names of the columns that hold the components in base axes; a leading ``-`` changes the sign (aircraft
        records have z down), ``0`` stands for a component that is zero.
    unit : str
        ``g`` (9.80665 m/s²) or ``m/s^2``.

    Returns
    -------
    PiecewiseLinear
        Vector profile, m/s², over the record's own times.

    Raises
    ------
    InputError
        If the file, a column, a cell or the sampling is wrong; the header is row 1.
    """
    if unit not in UNITS:
        raise InputError("record.unit", f"is {unit!r}", "choose g or m/s^2")
    header, rows, numbers = _rows(path)
    clock = _column(header, rows, numbers, "time", time)
    _check_sampling(clock, numbers)
    components = [_component(header, rows, numbers, axis, name) for axis, name in (("x", x), ("y", y), ("z", z))]
    return PiecewiseLinear(clock, UNITS[unit] * np.stack(components, axis=-1))


def _rows(path: str | os.PathLike[str]) -> tuple[list[str], list[list[str]], list[int]]:
    """Header, rows of cells and their numbers in the file; blank lines are left out."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file)
            lines = [(reader.line_num, [cell.strip() for cell in line]) for line in reader if line]
    except OSError as error:
        raise InputError(
            "record.file", f"{path} cannot be read ({error.strerror})", "give the path of a CSV file"
        ) from None
    except (UnicodeDecodeError, csv.Error):
        raise InputError("record.file", f"{path} is not CSV text", "save the record as CSV, UTF-8") from None
    if not lines:
        raise InputError("record.file", f"{path} is empty", "give a CSV file with a header line")
    header = lines[0][1]
    if len(header) == 1:
        raise InputError("record.file", f"{path} has one column, {header[0]!r}", "separate columns with commas")
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            raise InputError(
                "record.file",
                f"row {number} has {len(cells)} cells, the header {len(header)}",
                "complete the row",
            )
    if len(lines) < 5:
        raise InputError("record.file", f"{path} has {len(lines) - 1} row(s)", "give 4 samples or more")
    return header, [cells for _, cells in lines[1:]], [number for number, _ in lines[1:]]


def _column(header: list[str], rows: list[list[str]], numbers: list[int], axis: str, name: str) -> NDArray[np.float64]:
    """Return one column as numbers."""
    where = f"record.{axis}"
    if name not in header:
        close = difflib.get_close_matches(name, header, n=1)
        guess = f"did you mean {close[0]!r}? " if close else ""
        raise InputError(where, f"names no column {name!r}", f"{guess}the columns are {', '.join(header)}")
    if header.count(name) > 1:
        raise InputError(where, f"names {name!r}, given {header.count(name)} times", "name each column once")
    place = header.index(name)
    values = np.empty(len(rows))
    for i, (number, cells) in enumerate(zip(numbers, rows, strict=True)):
        cell = cells[place]
        try:
            values[i] = float(cell)
        except ValueError:
            shown = repr(cell) if cell else "empty"
            raise InputError(where, f"row {number}, column {name!r} is {shown}", "put a number there") from None
        if not np.isfinite(values[i]):
            raise InputError(where, f"row {number}, column {name!r} is {cell}", "put a finite number there")
    return values


def _component(
    header: list[str], rows: list[list[str]], numbers: list[int], axis: str, name: str
) -> NDArray[np.float64]:
    """Return a component with its sign; a column whose own name begins with a dash is taken at its name."""
    if name == _NO_COLUMN and name not in header:
        return np.zeros(len(rows))
    if name.startswith("-") and name not in header:
        return -_column(header, rows, numbers, axis, name[1:].strip())
    return _column(header, rows, numbers, axis, name)


def _check_sampling(time: NDArray[np.float64], numbers: list[int]) -> None:
    """Refuse times that stand still, go back, jump or wander."""
    steps = np.diff(time)

    def at(i: int) -> str:
        return f"{time[i + 1]:g} s at row {numbers[i + 1]}, after {time[i]:g} s"

    back = np.flatnonzero(steps <= 0)
    if back.size:
        verb = "repeats" if steps[back[0]] == 0 else "goes back to"
        raise InputError("record.time", f"{verb} {at(int(back[0]))}", "sort the rows and delete repeated ones")
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * median)
    if gaps.size:
        i = int(gaps[0])
        raise InputError(
            "record.time",
            f"has a gap of {steps[i]:g} s from {time[i]:g} s to {time[i + 1]:g} s (row {numbers[i + 1]}); "
            f"the interval is {median:g} s",
            "fill in the missing samples or cut the record there",
        )
    uneven = np.flatnonzero(np.abs(steps - median) > _UNEVEN * median)
    if uneven.size:
        i = int(uneven[0])
        raise InputError(
            "record.time",
            f"is sampled unevenly: {at(i)}, is {steps[i]:g} s where the interval is {median:g} s",
            "resample the record at equal intervals",
        )
