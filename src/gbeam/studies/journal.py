"""Store of a sweep under way, a file with one line per case, which survives any end of the process.

The first line identifies the sweep. Every line ends with its checksum, seeded with that of the first one, and is
synchronised before the next batch begins. Lines are only appended; if some are damaged, the undamaged ones are
written to a new file, which replaces the old one, and the other cases are computed again.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from io import FileIO
from pathlib import Path
from typing import Any

import gbeam
from gbeam.errors import ComputationError, InputError
from gbeam.guards.processes import hold_lock
from gbeam.studies.cases import Cases
from gbeam.studies.evaluate import Inquiry, Row

NAME = "cases.jsonl"
LOCK = ".lock"
_LINE = re.compile(rb'(\{.*), "crc32": (\d{1,10})\}\n')
Line = dict[str, Any] | None  # None: damaged
_LISTED = 5  # damaged lines that are named
_ANOTHER = "name another folder"


class Journal:
    """Store of the finished cases of a sweep in a folder; the mapping `sweep` identifies the sweep."""

    def __init__(self, folder: Path, sweep: Mapping[str, Any]) -> None:
        self.folder, self._file = folder, folder / NAME
        self._sweep: dict[str, Any] = json.loads(json.dumps(sweep))
        self.figures: Sequence[Any] = ()  # keys, unit and kind of each figure of a case
        self.warnings: tuple[str, ...] = ()
        self._out: FileIO | None = None
        self._seed = 0  # of the rows' checksums: the first line's

    @property
    def finished(self) -> bool:
        """True if the folder holds no sweep, or all cases of the sweep that it holds, this one or another, are done."""
        first_line, rows = self._stored_lines()
        return not first_line or len({row["case"] for row in rows if row}) >= first_line["cases"]

    def read(self) -> list[Row]:
        """Return the cases that are done, none without a store. InputError if the store is another sweep's."""
        first_line, rows = self._stored_lines()
        if not first_line:
            return []
        differing = [key for key in self._sweep if first_line.get(key) != self._sweep[key]]
        if differing:
            raise InputError(
                "--out",
                f"{self.folder} holds another sweep: its {' and '.join(differing)} "
                f"{'differ' if len(differing) > 1 else 'differs'}",
                _ANOTHER,
            )
        self.figures = list(first_line["figures"])
        damaged = [str(number) for number, row in enumerate(rows, 2) if row is None]
        if damaged:
            numbers = ", ".join(damaged[:_LISTED]) + (", …" if len(damaged) > _LISTED else "")
            self.warnings = (
                f"{len(damaged)} of the {len(rows)} cases kept in {self._file} were damaged (line {numbers}) and "
                f"computed again; the other {len(rows) - len(damaged)} are as they were",
            )
        return [_row(row) for row in rows if row is not None]

    @contextmanager
    def writing(self, *, resume: bool) -> Iterator[None]:
        """Open the store for `add`. InputError if another process has it open, or if its cases would be overwritten."""
        with ExitStack() as resources:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError("--out", f"{self.folder} cannot be made ({error.strerror})", _ANOTHER) from None
            resources.enter_context(hold_lock(self.folder / LOCK, "--out", f"wait for its end, or {_ANOTHER}"))
            with self._saving():
                self._begin(resume)
                self._out = resources.enter_context(open(self._file, "ab", buffering=0))
            yield

    def add(self, rows: Iterable[Row]) -> None:
        """Append rows and synchronise the file. ComputationError if the disk refuses, or the file was removed."""
        assert self._out is not None
        text = b""
        for row in rows:
            values = [value if math.isfinite(value) else None for value in row.values]
            line = {"case": row.case, "outcome": row.outcome, "message": row.message, "values": values}
            text += _line(line, self._seed)
        with self._saving():
            while text:
                text = text[self._out.write(text) :]
            os.fsync(self._out.fileno())
        if not self._still_there(self._out.fileno()):
            message = f"{self._file} was removed while the sweep ran: nothing of what was done is kept"
            raise ComputationError("interrupted", message)

    def _still_there(self, handle: int) -> bool:
        """True if the path of the store still is the open file, neither removed nor replaced."""
        try:
            return os.path.samestat(os.stat(self._file), os.fstat(handle))
        except OSError:
            return False

    def _begin(self, resume: bool) -> None:
        """Write the first line of a new store, or remove the damaged lines of one that is resumed."""
        if resume:
            self.read()  # again: another process may have written since
        else:
            refuse_unfinished(self)
        lines = _parsed(self._file.read_bytes()) if resume and self._file.exists() else []
        intact = [line for line, values in lines if values] or [_line({**self._sweep, "figures": list(self.figures)})]
        self._seed = json.loads(intact[0])["crc32"]
        if lines and len(intact) == len(lines):
            return
        # A new file takes the place of the old one at once: an interruption leaves one of them whole.
        new_file = self._file.with_suffix(".new")
        with open(new_file, "wb") as stream:
            stream.writelines(intact)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(new_file, self._file)
        if os.name == "posix":  # synchronise the file's name too
            folder = os.open(self.folder, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)

    def _stored_lines(self) -> tuple[Line, list[Line]]:
        """First line and rows of the file, without damaged rows at its end, which were cut off,
        or None without a file.
        """
        try:
            lines = _parsed(self._file.read_bytes()) if self._file.exists() else []
        except OSError as error:
            raise InputError("--out", f"{self._file} cannot be read ({error.strerror})", _ANOTHER) from None
        first_line, *rows = [values for _, values in lines] or [None]
        if lines and (first_line is None or "figures" not in first_line):
            problem = f"{self._file} is not the store of a sweep, or its first line is damaged"
            raise InputError("--out", problem, f"remove it, or {_ANOTHER}")
        while rows and rows[-1] is None:
            rows.pop()
        return first_line, rows

    @contextmanager
    def _saving(self) -> Iterator[None]:
        """Turn an OSError inside into a ComputationError that says how to go on."""
        try:
            yield
        except OSError as error:
            message = f"{self._file}: {error.strerror or error}; what is done is kept: --resume does the rest"
            raise ComputationError("interrupted", message) from None


def _line(values: Mapping[str, Any], seed: int = 0) -> bytes:
    """A line of the store: JSON of the values, with the checksum of its text as the last value."""
    text = json.dumps(values).encode()[:-1]
    return text + b', "crc32": %d}\n' % zlib.crc32(text, seed)


def _parsed(data: bytes) -> list[tuple[bytes, Line]]:
    """Lines with their values, None if damaged; only the first line if that is damaged."""
    lines = data.splitlines(keepends=True)
    if not lines:
        return []
    first_line = _read(lines[0], 0)
    parsed = [(lines[0], first_line)]
    if first_line:
        parsed += [(line, _read(line, first_line["crc32"])) for line in lines[1:]]
    return parsed


def _read(line: bytes, seed: int) -> Line:
    match = _LINE.fullmatch(line)
    if match is None or zlib.crc32(match[1], seed) != int(match[2]):
        return None
    values: dict[str, Any] = json.loads(line)
    return values


def _row(line: Mapping[str, Any]) -> Row:
    values = tuple(math.nan if value is None else float(value) for value in line["values"])
    return Row(int(line["case"]), values, str(line["outcome"]), str(line["message"]))


def identity(inquiry: Inquiry, cases: Cases, measures: Sequence[str], histories: Sequence[Any]) -> dict[str, Any]:
    """Identity of a sweep, for JSON: version, scenario, question, values that vary, and measures."""
    digest = hashlib.sha256()
    for variation in cases.variations:
        for text in variation.texts:
            digest.update(text.encode() + b"\n")
    return {
        "version": gbeam.__version__,
        **inquiry.template.identity,
        "question": [inquiry.verb, inquiry.motion, inquiry.at, dict(inquiry.options)],
        "parameters": [variation.path for variation in cases.variations],
        "values": digest.hexdigest(),
        "measures": list(measures),
        "histories": list(histories),
        "cases": len(cases),
    }


def open_journal(
    store: str | os.PathLike[str] | None, resume: bool, sweep: Mapping[str, Any]
) -> tuple[Journal | None, list[Row]]:
    """Journal of a sweep, None without a store, and the rows that it has. InputError if cases would be lost."""
    if store is None:
        if resume:
            raise InputError("--resume", "stands without a store", "name the folder with --out")
        return None, []
    journal = Journal(Path(store), sweep)
    if resume:
        return journal, journal.read()
    refuse_unfinished(journal)
    return journal, []


def refuse_unfinished(journal: Journal) -> None:
    """Raise InputError if the store holds cases that would be lost."""
    if not journal.finished:
        problem = f"{journal.folder} holds a sweep that is not finished"
        raise InputError("--out", problem, f"add --resume, or {_ANOTHER}")
