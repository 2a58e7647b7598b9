"""Named columns of a file, whatever its kind: found by name, with a sign, as finite numbers."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.limits import COLUMNS, LARGEST
from gbeam.io.tables.times import Clock, read_clock

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
class Table:
    """Columns of one file."""

    columns: tuple[Column, ...]
    rows: Sequence[int] | None = None  # row of every sample in a text file; None where the file has no rows

    def place(self, i: int) -> str:
        """Place of sample `i` in the file, in words."""
        return f"sample {i + 1}" if self.rows is None else f"row {self.rows[i]}"

    def counted(self, count: int) -> str:
        """So many samples, in the file's words."""
        return f"{count} {'sample' if self.rows is None else 'row'}(s)"

    def column(self, axis: str, name: str) -> Column:
        """Find a column by its name, or else by an alias."""
        columns = [one for one in self.columns if one.name == name]
        columns = columns or [one for one in self.columns if name in one.aliases]
        if len(columns) == 1:
            return columns[0]
        if columns:
            raise InputError(f"record.{axis}", f"names {name!r}, given {len(columns)} times", "name each column once")
        names = [one.name for one in self.columns]
        every = [*names, *(alias for one in self.columns for alias in one.aliases)]
        close = difflib.get_close_matches(name, every, n=1)
        guess = f"did you mean {close[0]!r}? " if close else ""
        more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        listed = ", ".join(names[:_LISTED]) + more
        raise InputError(f"record.{axis}", f"names no column {name!r}", f"{guess}the columns are {listed}")

    def numbers(self, axis: str, name: str, part: slice = slice(None)) -> Floats:
        """Return a column as numbers, shape (t,), finite ones in a part; outside it NaN stands for what is none."""
        samples = self._samples(axis, name)
        return self._finite(axis, name, samples, _numbers(samples), part)

    def times(self, name: str) -> tuple[Floats, Clock | None]:
        """Return the column of times, shape (t,), finite, and the clock where it holds times of day, which are in s."""
        samples = self._samples("time", name)
        known = None if isinstance(samples, np.ndarray) else read_clock(samples)
        clock, values = (None, _numbers(samples)) if known is None else known
        return self._finite("time", name, samples, values, slice(None)), clock

    def _samples(self, axis: str, name: str) -> Sequence[str] | NDArray[Any]:
        column = self.column(axis, name)
        try:
            return column.read()
        except InputError as error:
            raise InputError(f"record.{axis}", f"column {name!r} {error.problem}", error.fix) from None

    def _finite(self, axis: str, name: str, samples: Any, values: Floats, part: slice) -> Floats:
        bad = np.flatnonzero(~(np.abs(values[part]) <= LARGEST))
        if bad.size:
            i = int(bad[0]) + (part.start or 0)
            cell = samples[i]
            if isinstance(cell, str) and not _is_number(cell):
                shown, what = repr(cell) if cell else "empty", "a number"
            else:
                shown, what = str(cell), "a finite number"
            raise InputError(f"record.{axis}", f"{self.place(i)}, column {name!r} is {shown}", f"put {what} there")
        return values

    def vector(self, names: dict[str, str], count: int, part: slice = slice(None)) -> Floats:
        """Stack components, each a column with its sign.

        Parameters
        ----------
        names : dict of str to str
            Column by axis; a leading ``-`` changes the sign, ``0`` is a component that is zero. A column whose own
            name begins with a dash is taken at its name.
        count : int
            Number of samples, t.
        part : slice
            Of the samples, which must be finite.

        Returns
        -------
        (t, 3) array
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
        """Columns of some components or of the time, each with the unit that the file states, or "": :meth:`vector`."""
        for axis, name in names.items():
            _, column = self.signed(name)
            if column is not None:
                yield column, self.column(axis, column).unit

    def signed(self, name: str) -> tuple[float, str | None]:
        """Sign and column of a component; no column of one that is zero."""
        known = {word for one in self.columns for word in (one.name, *one.aliases)}
        if name in known:
            return 1.0, name
        if name == NO_COLUMN:
            return 1.0, None
        return (-1.0, name[1:].strip()) if name.startswith("-") else (1.0, name)


def array_columns(
    name: str, shape: tuple[int, ...], read: Callable[[], NDArray[Any]], *, unit: str = "", matlab: bool = False
) -> list[Column]:
    """Columns of one array of a file: itself if it is a vector, its vectors if it is a matrix, else none."""
    short = name.rpartition("." if matlab else "/")[2]
    long = [size for size in shape if size > 1]
    if len(long) == 1:
        return [Column(name, lambda: read().ravel(), unit, (short,))]
    if len(shape) != 2 or len(long) != 2:
        return []
    across = int(shape[1] <= shape[0])  # the axis that counts the vectors
    if shape[across] > COLUMNS:
        return []

    def vector(k: int) -> Column:
        index = f"{k + matlab},:" if across == 0 else f":,{k + matlab}"
        index = f"({index})" if matlab else f"[{index}]"
        return Column(name + index, lambda: np.take(read(), k, axis=across), unit, (short + index,))

    return [vector(k) for k in range(shape[across])]


def _numbers(samples: Sequence[str] | NDArray[Any]) -> Floats:
    try:
        return np.asarray(samples, dtype=np.float64)
    except ValueError:
        return np.array([_number(cell) for cell in samples])


def _number(cell: str) -> float:
    return float(cell) if _is_number(cell) else math.nan


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
