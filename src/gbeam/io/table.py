"""Named columns of a file, whatever its kind: found by name, with a sign, as finite numbers or times of day."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.limits import COLUMNS, LARGEST
from gbeam.printable import closest

CLOCK = (
    r"(?:(?P<date>\d{4}-\d\d-\d\d)(?:T| +)|(?P<day>\d{1,3}):)?"
    r"(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d):(?P<second>[0-5]\d|60)(?:[.,](?P<fraction>\d{1,9}))?"
    r" ?(?:Z|UTC|(?P<ahead>[+-]\d\d):?(?P<also>\d\d)?)?"
)
_CLOCK = re.compile(CLOCK)
# As loggers write it: 2024-3-23--13-41-38-830, 23.03.2024 13:41:38,83, 3/23/2024 1:41:38.830 PM, 13:41:38:830.
_LOGGED = re.compile(
    r"(?:(?:(?P<year>\d{4})[-/.](?P<month>\d{1,2})[-/.](?P<date>\d{1,2})|(?P<either>\d{1,2}/\d{1,2}/\d{4})"
    r"|(?P<date_first>\d{1,2})\.(?P<then_month>\d{1,2})\.(?P<then_year>\d{4}))(?P<dated>--|[T_-]| +))?"
    r"(?P<hour>\d{1,2})(?P<between>[:-])(?P<minute>\d{1,2})(?P=between)(?P<second>\d{1,2})"
    r"(?:[.,](?P<fraction>\d{1,9})|[:_-](?P<thousandths>\d{1,3}))?(?: ?(?P<half>[AP])\.?M\.?)?",
    re.IGNORECASE,
)
_SECOND, _DAY = 10**9, 86_400 * 10**9  # ns
_Reading = tuple[int | None, int]  # the day, where it is known, and ns from its midnight


@dataclass(frozen=True)
class Clock:
    """A clock of which a record's first time is zero seconds."""

    first: str  # that time, as the file has it

    def seconds(self, text: str) -> float | None:
        """Return the seconds from the first time to a text, within a day if a date is missing,
        or None if it is none.
        """
        first, reading = _reading(self.first), _reading(text)
        return None if first is None or reading is None else _nanoseconds(first, reading) / _SECOND


def is_clock(text: str) -> bool:
    """True if a text is a time of day."""
    return _CLOCK.fullmatch(text) is not None or _logged(text) is not None


def read_clock(cells: Sequence[str]) -> tuple[Clock, NDArray[np.float64]] | None:
    """Clock of a column, and its times, s, from the first, or None if the first cell has none.

    A time is NaN where a cell has none.
    """
    first = _reading(cells[0]) if len(cells) else None
    if first is None:
        return None
    readings = (_reading(cell) for cell in cells)
    seconds = np.array([np.nan if reading is None else _nanoseconds(first, reading) / _SECOND for reading in readings])
    if first[0] is None:  # without days, times that jump by more than half a day have passed midnight
        finite = np.isfinite(seconds)
        seconds[finite] = np.unwrap(seconds[finite], period=_DAY / _SECOND)
    return Clock(cells[0]), seconds


def _nanoseconds(first: _Reading, reading: _Reading) -> int:
    """Nanoseconds from one reading to another, within a day where the day of either is not known."""
    passed = reading[1] - first[1]
    return passed % _DAY if first[0] is None or reading[0] is None else (reading[0] - first[0]) * _DAY + passed


def _reading(text: str) -> _Reading | None:
    """Day, if known, and time from its midnight, ns, in UTC if the text has a zone, or None if it is no time of day."""
    match = _CLOCK.fullmatch(text)
    if match is None:
        return _logged(text)
    day = int(match["day"]) if match["day"] else None
    if match["date"]:
        day = _day(match["date"])
        if day is None:
            return None
    ahead = match["ahead"] or "+0"
    minutes = int(match["minute"]) - (60 * int(ahead) + int(f"{ahead[0]}{match['also'] or 0}"))
    seconds = 3600 * int(match["hour"]) + 60 * minutes + int(match["second"])
    return day, seconds * _SECOND + int((match["fraction"] or "").ljust(9, "0"))


def _logged(text: str) -> _Reading | None:
    """Day, if known, and time from its midnight, ns, of texts as loggers write them, or None if a text is no such time.

    Of 3/4/2024 nobody knows which is the month: it counts as the time of day alone.
    """
    match = _LOGGED.fullmatch(text)
    if match is None or (match["between"] == "-" and not match["dated"]):
        return None
    parts = [match["year"] or match["then_year"], match["month"] or match["then_month"]]
    parts += [match["date"] or match["date_first"]]
    day = None if None in parts else _day("-".join(part.zfill(2) for part in parts))
    hour, minute, second = (int(match[name]) for name in ("hour", "minute", "second"))
    if match["half"]:
        hour = hour % 12 + 12 * (match["half"] in "Pp") if 1 <= hour <= 12 else 24
    if hour > 23 or minute > 59 or second > 60 or (None not in parts and day is None):
        return None
    fraction = match["fraction"] or (match["thousandths"] or "").zfill(3)
    return day, ((60 * hour + minute) * 60 + second) * _SECOND + int(f"{fraction:0<9}")


@lru_cache(maxsize=2)  # days of a record
def _day(text: str) -> int | None:
    try:
        return date.fromisoformat(text).toordinal()
    except ValueError:
        return None


Floats = NDArray[np.float64]

NO_COLUMN = "0"
_LISTED = 30  # names in a message


@dataclass(frozen=True)
class Column:
    """One column of a record."""

    name: str  # as in the file
    read: Callable[[], Sequence[str] | NDArray[Any]]  # returns the samples: text as in the file, or numbers
    unit: str = ""  # as the file spells it; empty if it states none
    aliases: tuple[str, ...] = ()  # other names it goes by, such as ``a_z`` for ``a_z [g]``


@dataclass(frozen=True)
class Stated:
    """Sample rate that a file states, of the columns whose names begin so."""

    name: str  # as in the file
    rate: float  # Hz
    of: str = ""

    @classmethod
    def read(cls, path: str, value: float, separator: str) -> Iterator[Stated]:
        """Yield the rate that a number at a path in a file is by its name: ``imu/fs`` in Hz, ``dt`` in s."""
        group, _, name = path.rpartition(separator)
        if states_rate(name) and 0 < value < math.inf:
            yield cls(path, value if _letters(name) in _RATES else 1 / value, group)


def states_rate(name: str) -> bool:
    """True if a number of this name is a sample rate, or the time between samples."""
    return _letters(name) in _RATES | _STEPS


def _letters(name: str) -> str:
    return re.sub("[^a-z]", "", name.lower())


_SAMPLE = ("sample", "sampling")
_RATES = {"fs", "srate", "sfreq"} | {stem + end for stem in _SAMPLE for end in ("rate", "freq", "frequency")}
_STEPS = {"dt", "ts", "deltat", "deltax", "wfincrement"}
_STEPS |= {stem + end for stem in _SAMPLE for end in ("time", "interval", "period")}


@dataclass(frozen=True)
class Table:
    """Columns of one file."""

    columns: tuple[Column, ...]
    rows: Sequence[int] | None = None  # row of every sample in a text file; None where the file has no rows
    stated: tuple[Stated, ...] = ()
    remarks: tuple[str, ...] = ()  # of what looks odd in the file

    def place(self, i: int) -> str:
        """Place of sample `i` in the file, in words."""
        return f"sample {i + 1}" if self.rows is None else f"row {self.rows[i]}"

    def counted(self, count: int) -> str:
        """So many samples, in the file's words."""
        return f"{count} {'sample' if self.rows is None else 'row'}(s)"

    def column(self, axis: str, name: str) -> Column:
        """Return a column by its name, or else by an alias. InputError if none or several have it."""
        columns = [column for column in self.columns if column.name == name]
        columns = columns or [column for column in self.columns if name in column.aliases]
        if len(columns) == 1:
            return columns[0]
        if columns:
            raise InputError(f"record.{axis}", f"names {name!r}, given {len(columns)} times", "name each column once")
        names = [column.name for column in self.columns]
        candidates = [*names, *(alias for column in self.columns for alias in column.aliases)]
        closest_name = closest(name, candidates)
        guess = f"did you mean {closest_name!r}? " if closest_name else ""
        rest_words = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        names_in_words = ", ".join(names[:_LISTED]) + rest_words
        raise InputError(f"record.{axis}", f"names no column {name!r}", f"{guess}the columns are {names_in_words}")

    def numbers(self, axis: str, name: str, part: slice = slice(None)) -> Floats:
        """Return a column as numbers (t,), NaN where a cell is none; InputError unless all are finite in `part`."""
        samples = self._samples(axis, name)
        return self._finite(axis, name, samples, _numbers(samples), part)

    def cells(self, axis: str, name: str) -> NDArray[np.str_]:
        """Return a column as words (t,), numbers in their shortest form, so that 3, "3" and "3.0" are alike."""
        samples = self._samples(axis, name)
        values, cell_of_sample = np.unique(np.asarray(samples), return_inverse=True)
        return np.array([as_word(str(value)) for value in values], dtype=np.str_)[cell_of_sample.reshape(-1)]

    def times(self, name: str) -> tuple[Floats, Clock | None, str]:
        """Return the column of times (t,), all finite, the clock of times of day, and the first as the file has it.

        Times of day are counted from the first, s.
        """
        samples = self._samples("time", name)
        by_clock = None if isinstance(samples, np.ndarray) else read_clock(samples)
        clock, values = (None, _numbers(samples)) if by_clock is None else by_clock
        first = str(samples[0]) if len(samples) else ""
        return self._finite("time", name, samples, values, slice(None)), clock, first

    def count(self, names: dict[str, str]) -> int:
        """Number of samples of the first column among components, named as in :meth:`vector`."""
        for axis, name in names.items():
            _, column = self.signed(name)
            if column:
                return len(self._samples(axis, column))
        return 0

    def _samples(self, axis: str, name: str) -> Sequence[str] | NDArray[Any]:
        column = self.column(axis, name)
        try:
            return column.read()
        except InputError as error:
            raise InputError(f"record.{axis}", f"column {name!r} {error.problem}", error.fix) from None

    def _finite(self, axis: str, name: str, samples: Any, values: Floats, part: slice) -> Floats:
        """Return the values. InputError, with the place in the file, unless they are finite within `part`."""
        bad_rows = np.flatnonzero(~(np.abs(values[part]) <= LARGEST))
        if bad_rows.size:
            i = int(bad_rows[0]) + (part.start or 0)
            cell = samples[i]
            if isinstance(cell, str) and math.isnan(_number(cell)) and cell.lower().lstrip("+-") != "nan":
                cell_text, expected = repr(cell) if cell else "empty", "a number"
            else:
                cell_text, expected = str(cell), "a finite number"
            raise InputError(
                f"record.{axis}", f"{self.place(i)}, column {name!r} is {cell_text}", f"put {expected} there"
            )
        return values

    def rates(self, names: Iterable[str]) -> dict[str, float]:
        """Return the sample rates, Hz, that the file states of columns, named with their signs, by their own names."""
        columns = [column for _, column in map(self.signed, names) if column is not None]
        own_names = [self.column("", column).name for column in columns]
        rates = {}
        for stated in self.stated:
            if any(name.startswith(stated.of) for name in own_names):
                rates[stated.name] = stated.rate
        return rates

    def vector(self, names: dict[str, str], count: int, part: slice = slice(None)) -> Floats:
        """Stack components by axis, columns with their signs, (count, 3), whose `part` must be finite.

        A leading ``-`` changes the sign, unless the column's own name begins with one. ``0`` is a component of zeros.
        """
        parts = []
        for axis, name in names.items():
            sign, column = self.signed(name)
            values = np.zeros(count) if column is None else sign * self.numbers(axis, column, part)
            if len(values) != count:
                raise InputError(
                    f"record.{axis}", f"column {column!r} has {len(values)} samples, the time {count}", "name another"
                )
            parts.append(values)
        return np.stack(parts, axis=-1)

    def stated_units(self, names: dict[str, str]) -> Iterator[tuple[str, str]]:
        """Yield the columns of components or of the time, as in :meth:`vector`, with their stated units, or ""."""
        for axis, name in names.items():
            _, column = self.signed(name)
            if column is not None:
                yield column, self.column(axis, column).unit

    def signed(self, name: str) -> tuple[float, str | None]:
        """Sign and column of a component, from its name. A component that is zero has no column."""
        own_names = {word for column in self.columns for word in (column.name, *column.aliases)}
        if name in own_names:
            return 1.0, name
        if name == NO_COLUMN:
            return 1.0, None
        return (-1.0, name[1:].strip()) if name.startswith("-") else (1.0, name)


def array_columns(
    name: str, shape: tuple[int, ...], read: Callable[[], NDArray[Any]], *, unit: str = "", matlab: bool = False
) -> list[Column]:
    """Columns of one array of a file: itself if it is a vector, one for each vector if it is a matrix, else none."""
    last_word = name.rpartition("." if matlab else "/")[2]
    sizes = [size for size in shape if size > 1]
    if len(sizes) == 1:
        return [Column(name, lambda: read().ravel(), unit, (last_word,))]
    if len(shape) != 2 or len(sizes) != 2:
        return []
    axis = int(shape[1] <= shape[0])  # the axis that counts the vectors
    if shape[axis] > COLUMNS:
        return []

    def vector(k: int) -> Column:
        index = f"{k + matlab},:" if axis == 0 else f":,{k + matlab}"
        index = f"({index})" if matlab else f"[{index}]"
        return Column(name + index, lambda: np.take(read(), k, axis=axis), unit, (last_word + index,))

    return [vector(k) for k in range(shape[axis])]


def _numbers(samples: Sequence[str] | NDArray[Any]) -> Floats:
    """Return samples as numbers, NaN for text that is none."""
    try:
        return np.asarray(samples, dtype=np.float64)
    except ValueError:
        return np.array([_number(cell) for cell in samples])


def as_word(cell: str) -> str:
    """Return a cell without spaces around it, a number in its shortest form."""
    number = _number(cell.strip())
    return cell.strip() if math.isnan(number) else f"{number:.12g}"


_FORTRAN = re.compile(r"([+-]?(?:\d++(?:\.\d*+)?|\.\d++))(?:[dD]([+-]?\d++)|([+-]\d{3}))")  # 1.5D+02, 1.5+102


def _number(cell: str) -> float:
    """Number in a cell, or NaN if there is none."""
    match = _FORTRAN.fullmatch(cell)
    try:
        return float(f"{match[1]}e{match[2] or match[3]}" if match else cell)
    except ValueError:
        return math.nan
