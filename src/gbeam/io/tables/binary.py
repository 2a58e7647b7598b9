"""The columns of MAT, HDF5, netCDF and universal files, read in a process of its own."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.confined import confined
from gbeam.io.tables.readers import read_hdf5, read_mat, read_uff
from gbeam.io.tables.table import Column, Table

_READERS: dict[str, Callable[[str, Sequence[str]], Table]] = {
    ".mat": read_mat,
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf"), read_hdf5),
    **dict.fromkeys((".uff", ".unv", ".ufb", ".uf"), read_uff),
}


def is_binary(path: str | os.PathLike[str]) -> bool:
    """Whether a library reads the file, by the end of its name; everything else is text."""
    return Path(path).suffix.lower() in _READERS


def read_binary(path: str | os.PathLike[str], words: Iterable[str] = ()) -> Table:
    """Read the names and units of all columns, and the samples of those that are needed."""
    status = os.stat(path)
    version = status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns
    table = _kept(os.fspath(path), tuple(sorted(set(words))), os.getcwd(), version)
    if isinstance(table, InputError):
        raise table
    return table


@lru_cache(maxsize=4)  # the cases of a sweep have one record, as have the edits of a scenario
def _kept(path: str, words: Sequence[str], folder: str, version: tuple[int, ...]) -> Table | InputError:
    """Return a table, or why it cannot be read, which is not tried twice."""

    def refuse(problem: str) -> InputError:
        return InputError("record.file", f"{path} {problem}", "export the record again, with fewer variables")

    try:
        columns = confined(columns_of, path, words, refuse=refuse)
    except InputError as error:
        return error
    return Table(tuple(_column(**each) for each in columns))


def _column(name: str, unit: str, aliases: Sequence[str], samples: Any = None, refusal: Sequence[str] = ()) -> Column:
    def read() -> Any:
        if refusal:
            raise InputError("", *refusal)
        return samples

    return Column(name, read, unit, tuple(aliases))


def columns_of(path: str, words: list[str]) -> list[dict[str, Any]]:
    """Read the columns of a file in the process that may end as it does."""
    table = _READERS[Path(path).suffix.lower()](path, words)
    needed = set()
    for word in words:
        with suppress(InputError):  # no column, or several: refused where it is looked for
            needed.add(table.column("", table.signed(word)[1] or ""))
    return [
        {"name": each.name, "unit": each.unit, "aliases": each.aliases} | (_samples(each) if each in needed else {})
        for each in table.columns
    ]


def _samples(column: Column) -> dict[str, Any]:
    try:
        return {"samples": np.asarray(column.read(), dtype=np.float64)}
    except MemoryError:
        raise
    except InputError as error:
        return {"refusal": [error.problem, error.fix]}
    except Exception as error:  # a damaged file leads its library to any
        return {"refusal": [f"cannot be read ({error})", "export the record again"]}
