"""The store of a sweep that is under way: one line per case, which survives whatever ends the process.

The first line says which sweep it is. Lines are synchronised before the next batch begins; one that was cut off in the
middle is computed again.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import gbeam
from gbeam.errors import ComputationError, InputError
from gbeam.sweeps.cases import Cases
from gbeam.sweeps.computing.evaluate import Question, Row

NAME = "cases.jsonl"
LOCK = "cases.lock"


class Journal:
    """Cases as they are done.

    Parameters
    ----------
    folder : Path
        Made when the first case is written.
    sweep : mapping
        What the sweep is: equal for the same sweep, told apart by its keys where it is another.
    """

    def __init__(self, folder: Path, sweep: Mapping[str, Any]) -> None:
        self._file, self._lock = folder / NAME, folder / LOCK
        self._sweep: dict[str, Any] = json.loads(json.dumps(sweep))
        self.figures: Sequence[Any] = ()  # keys and unit of each, as the cases done have them
        self._out: TextIO | None = None

    @property
    def exists(self) -> bool:
        """Whether there is one in the folder."""
        return self._file.exists()

    @property
    def finished(self) -> bool:
        """Whether all the cases of the one in the folder, whichever sweep it is, are done; or there is none."""
        if not self.exists:
            return True
        lines = self._file.read_bytes().split(b"\n")
        try:
            return len(lines) - 2 >= int(json.loads(lines[0])["cases"])
        except (ValueError, KeyError, TypeError):
            return False  # what it is, is not ours to overwrite

    def read(self) -> list[Row]:
        """The cases done.

        Raises
        ------
        InputError
            If it is another sweep's.
        """
        lines = self._file.read_text(encoding="utf-8").split("\n")
        try:
            first = json.loads(lines[0])
        except json.JSONDecodeError:
            first = None
        if not isinstance(first, dict):
            raise InputError("--out", f"{self._file} is not the store of a sweep", "name another folder")
        differing = [key for key in self._sweep if first.get(key) != self._sweep[key]]
        if differing:
            raise InputError(
                "--out",
                f"{self._file.parent} holds another sweep: its {' and '.join(differing)} "
                f"{'differ' if len(differing) > 1 else 'differs'}",
                "name another folder",
            )
        self.figures = list(first.get("figures", []))
        # What follows the last line's end was cut off.
        return [_row(json.loads(line)) for line in lines[1:-1] if line]

    @contextmanager
    def writing(self, *, new: bool) -> Iterator[None]:
        """Hold the store for writing; what another process holds is refused.

        Raises
        ------
        InputError
            If another process writes to it.
        ComputationError
            If it cannot be written.
        """
        self._file.parent.mkdir(parents=True, exist_ok=True)
        self._take()
        try:
            if new:
                first = json.dumps({**self._sweep, "figures": list(self.figures)})
                self._file.write_text(first + "\n", encoding="utf-8")
            else:
                whole = self._file.read_bytes()
                self._file.write_bytes(whole[: whole.rfind(b"\n") + 1])
            with open(self._file, "a", encoding="utf-8") as self._out:
                yield
        except OSError as error:
            message = f"{self._file}: {error.strerror or error}; what is done is kept: --resume does the rest"
            raise ComputationError("interrupted", message) from None
        finally:
            self._out = None
            self._lock.unlink(missing_ok=True)

    def add(self, rows: Iterable[Row]) -> None:
        """Write some cases."""
        assert self._out is not None
        for row in rows:
            values = [value if math.isfinite(value) else None for value in row.values]
            line = {"case": row.case, "outcome": row.outcome, "message": row.message, "values": values}
            self._out.write(json.dumps(line, ensure_ascii=False) + "\n")
        self._out.flush()
        os.fsync(self._out.fileno())

    def _take(self) -> None:
        """Make the lock file; one whose process is no more is taken over."""
        for _ in range(2):
            try:
                with open(self._lock, "x", encoding="utf-8") as lock:
                    lock.write(str(os.getpid()))
                return
            except FileExistsError:
                text = self._lock.read_text(encoding="utf-8").strip()
                if text.isdigit() and _alive(int(text)):
                    problem = f"{self._file.parent} is being written by another sweep, process {text}"
                    raise InputError("--out", problem, "wait for its end, or name another folder") from None
                self._lock.unlink(missing_ok=True)
        raise InputError("--out", f"{self._lock} cannot be made", "name another folder")


def _row(line: Mapping[str, Any]) -> Row:
    values = tuple(math.nan if value is None else float(value) for value in line["values"])
    return Row(int(line["case"]), values, str(line["outcome"]), str(line["message"]))


def _alive(process: int) -> bool:
    if os.name == "nt":  # signal 0 ends a process there
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def identity(question: Question, cases: Cases, measures: Sequence[str], histories: Sequence[Any]) -> dict[str, Any]:
    """What makes two sweeps the same: version, scenario, what varies, and what is measured."""
    digest = hashlib.sha256()
    for each in cases.variations:
        for text in each.texts:
            digest.update(text.encode() + b"\n")
    return {
        "version": gbeam.__version__,
        "scenario": hashlib.sha256(question.source.text.encode()).hexdigest(),
        "changes": [each.text for each in question.source.overrides],
        "question": [question.verb, question.motion, question.at],
        "parameters": [each.path for each in cases.variations],
        "values": digest.hexdigest(),
        "measures": list(measures),
        "histories": list(histories),
        "cases": len(cases),
    }


def opened(
    store: str | os.PathLike[str] | None, resume: bool, sweep: Mapping[str, Any]
) -> tuple[Journal | None, list[Row]]:
    """The store of a sweep, and the cases done in it.

    Raises
    ------
    InputError
        If there is nothing to resume, or something that would be lost.
    """
    if store is None:
        if resume:
            raise InputError("--resume", "stands without a store", "name the folder with --out")
        return None, []
    folder = Path(store)
    journal = Journal(folder, sweep)
    if resume:
        return journal, journal.read() if journal.exists else []
    if not journal.finished:
        raise InputError(
            "--out", f"{folder} holds a sweep that is not finished", "add --resume, or name another folder"
        )
    return journal, []
