"""The table that a record's file holds."""

from __future__ import annotations

import os
from collections.abc import Iterable

from gbeam.errors import InputError
from gbeam.guards.limits import BINARY_BYTES, refuse_large_file
from gbeam.io.tables.binary import is_binary, read_binary
from gbeam.io.tables.table import Table
from gbeam.motion.bases.records.text import read_text


def read_table(path: str | os.PathLike[str], words: Iterable[str] = ()) -> Table:
    """Read the columns of a record, and the samples of those that are needed."""
    try:
        refuse_large_file("record.file", path, BINARY_BYTES, "cut the record, or export it at a lower rate")
        return read_binary(path, words) if is_binary(path) else read_text(path)
    except OSError as error:
        problem = f"{path} cannot be read ({error.strerror})"
        raise InputError("record.file", problem, "give the path of a record") from None
