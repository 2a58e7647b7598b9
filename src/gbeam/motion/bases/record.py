"""Flight records: CSV files with a header line, one row per sample, checked and conditioned before they are used."""

from __future__ import annotations

import csv
import difflib
import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.motion.bases.conditioning import (
    FEWEST,
    STANDARD_GRAVITY,
    filtered,
    refuse_unsound,
    spikes,
    without_spikes,
)
from gbeam.motion.profiles.piecewise import PiecewiseLinear

UNITS = {"g": STANDARD_GRAVITY, "m/s^2": 1.0, "m/s²": 1.0}
RATE_UNITS = {"rad/s": 1.0, "deg/s": np.pi / 180}
_UNEVEN, _GAP = 0.01, 1.5  # of the median interval
_NO_COLUMN = "0"


@dataclass(frozen=True)
class Rates:
    """Columns of a record that hold the body's rates about the base axes, with their signs, and their unit."""

    p: str
    q: str
    r: str
    unit: str


@dataclass(frozen=True)
class Conditioning:
    """What is done to a record.

    Parameters
    ----------
    cutoff : float or None
        Of a zero-phase low-pass (fourth-order Butterworth forwards and backwards, −6 dB), Hz.
    resample : float or None
        New sampling rate, Hz.
    despike : bool
        Replace single samples far off their neighbours.
    skip_checks : bool
        Take the record as it is, without looking at its size, rate and dropouts.
    """

    cutoff: float | None = None
    resample: float | None = None
    despike: bool = False
    skip_checks: bool = False


@dataclass(frozen=True)
class FlightRecord:
    """A record ready to be flown.

    Parameters
    ----------
    acceleration : PiecewiseLinear
        m/s², base axes.
    rates : PiecewiseLinear or None
        Angular velocity, rad/s, base axes.
    notes : tuple of str
        What was done to it, and what looks odd.
    """

    acceleration: PiecewiseLinear
    rates: PiecewiseLinear | None = None
    notes: tuple[str, ...] = ()


def read_record(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    conditioning: Conditioning = Conditioning(),
) -> PiecewiseLinear:
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
    conditioning : Conditioning
        By default nothing is done to it.

    Returns
    -------
    PiecewiseLinear
        Vector profile, m/s², over the record's own times.

    Raises
    ------
    InputError
        If the file, a column, a cell or the sampling is wrong, or the record looks unsound; the header is row 1.
    """
    return read_flight(path, time, x, y, z, unit, conditioning=conditioning).acceleration


def read_flight(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    *,
    rates: Rates | None = None,
    conditioning: Conditioning = Conditioning(),
) -> FlightRecord:
    """Read a record with the body's rates, and say what was done to it; see :func:`read_record`.

    Parameters
    ----------
    rates : Rates, optional
        Which columns hold them.
    """
    if unit not in UNITS:
        raise InputError("record.unit", f"is {unit!r}", "choose g or m/s^2")
    if rates is not None and rates.unit not in RATE_UNITS:
        raise InputError("record.rate_unit", f"is {rates.unit!r}", "choose rad/s or deg/s")
    header, rows, numbers = _rows(path)
    clock = _column(header, rows, numbers, "time", time)
    _check_sampling(clock, numbers)
    load = UNITS[unit] * _vector(header, rows, numbers, {"x": x, "y": y, "z": z})
    if not conditioning.skip_checks:
        refuse_unsound(clock, load, (x, y, z), unit, numbers)
    notes = []
    odd = spikes(load)
    if odd.any():
        first = int(np.argmax(odd.any(axis=1)))
        where = f"{int(odd.any(axis=1).sum())} sample(s) that look like spikes, the first at {clock[first]:g} s (row "
        where += f"{numbers[first]})"
        notes.append(
            f"{where}, {'were replaced' if conditioning.despike else 'are kept; despike = true replaces them'}"
        )
        load = without_spikes(clock, load, odd) if conditioning.despike else load
    turning = np.empty((len(clock), 0))
    if rates is not None:
        turning = RATE_UNITS[rates.unit] * _vector(header, rows, numbers, {"p": rates.p, "q": rates.q, "r": rates.r})
    new, both = filtered(clock, np.concatenate([load, turning], axis=1), conditioning.cutoff, conditioning.resample)
    if conditioning.cutoff is not None:
        notes.append(f"low-pass at {conditioning.cutoff:g} Hz, zero phase")
    if conditioning.resample is not None:
        notes.append(f"resampled at {conditioning.resample:g} Hz")
    about = None if rates is None else PiecewiseLinear(new, both[:, 3:])
    return FlightRecord(PiecewiseLinear(new, both[:, :3]), about, tuple(notes))


def _vector(header: list[str], rows: list[list[str]], numbers: list[int], names: dict[str, str]) -> NDArray[np.float64]:
    return np.stack([_component(header, rows, numbers, axis, name) for axis, name in names.items()], axis=-1)


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
    if len(lines) <= FEWEST:
        raise InputError("record.file", f"{path} has {len(lines) - 1} row(s)", f"give {FEWEST} samples or more")
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
