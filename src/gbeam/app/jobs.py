"""Runs, one folder each: queued, computed one after the other in a process of their own, and kept."""

from __future__ import annotations

import asyncio
import json
import os
import re
import secrets
import shutil
import signal
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from gbeam.app.files import names, regular
from gbeam.app.verbs import VERBS
from gbeam.errors import InputError
from gbeam.results.imitation.criteria import GOOD

ID = re.compile(r"\d{8}-\d{6}-[0-9a-f]{8}")
MEMORY = 16 * 2**30  # bytes of address space, of which compiled programs reserve far more than they use
SECONDS = 3600  # of processor time, and of time altogether
QUEUED = 100
_STATE, _LOG, _ANSWER, _WORDS = "state.json", "progress.txt", "answer.json", "words.txt"
_SCENARIO = "scenario.toml"
_BEFORE = ".before"  # has the scenario as it came, of a verb that writes into it
# What may be downloaded, by its name there, and where it is; besides, of what the verb writes, files of these kinds.
DOWNLOADS = {
    _SCENARIO: _SCENARIO,
    _ANSWER: _ANSWER,
    _WORDS: _WORDS,
    "messages.txt": _LOG,
    "found.toml": "found.toml",
    "command.json": "out/command.json",
}
KINDS = (".nc", ".csv", ".mat")


class Jobs:
    """The runs of one folder, and the queue."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._queue: asyncio.Queue[str] = asyncio.Queue()
        self._process: tuple[str, asyncio.subprocess.Process] | None = None
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Take up what an earlier server left in the queue, and begin."""
        for each in reversed(self.list()):
            if each["state"] == "queued":
                self._queue.put_nowait(each["id"])
            elif each["state"] == "running":  # its process ended with the server
                self._note(each["id"], state="interrupted")
        self._task = asyncio.create_task(self._work())

    async def stop(self) -> None:
        """End the process that runs; its run is interrupted."""
        if self._task is not None:
            self._task.cancel()
            with suppress(asyncio.CancelledError):
                await self._task

    def submit(
        self,
        text: str,
        title: str,
        records: Sequence[Path],
        verb: str = "run",
        arguments: Sequence[str] = (),
        case: str = "",
    ) -> str:
        """Queue a verb on a scenario, with copies of its records; return its id.

        Parameters
        ----------
        text, title : str
            Of the scenario.
        records : sequence of Path
        verb : str
        arguments : sequence of str
            Of the verb.
        case : str
            Which case of which sweep it is; one that is there already is not run again.

        Raises
        ------
        InputError
            If too many wait.
        """
        known = next((each["id"] for each in self.list() if case and each.get("case") == case), None)
        if known is not None:
            return str(known)
        if self._queue.qsize() >= QUEUED:
            raise InputError("runs", f"wait already, {QUEUED} of them", "cancel some")
        number = f"{datetime.now():%Y%m%d-%H%M%S}-{secrets.token_hex(4)}"
        place = self.folder / number
        place.mkdir(parents=True)
        for record in records:
            shutil.copyfile(record, place / record.name, follow_symlinks=False)
        (place / _SCENARIO).write_text(text, encoding="utf-8")  # whatever the records are called
        if "--write" in arguments:
            (place / _BEFORE).mkdir()
            (place / _BEFORE / _SCENARIO).write_text(text, encoding="utf-8")
        self._note(number, state="queued", title=title, verb=verb, case=case, arguments=list(arguments))
        self._queue.put_nowait(number)
        return number

    def cancel(self, number: str) -> None:
        """End a run, or take it out of the queue."""
        state = self.state(number)["state"]
        if state == "queued":
            self._note(number, state="cancelled")
        elif state == "running" and self._process is not None and self._process[0] == number:
            self._note(number, state="cancelled")
            _end(self._process[1])

    def list(self) -> list[dict[str, Any]]:
        """All runs, the latest first."""
        if not self.folder.is_dir():
            return []
        known = [each.name for each in self.folder.iterdir() if ID.fullmatch(each.name) and (each / _STATE).is_file()]
        return [self.state(number) for number in sorted(known, reverse=True)]

    def state(self, number: str) -> dict[str, Any]:
        """What is known of a run: its state, title, last line of progress, and the files that it has.

        Raises
        ------
        InputError
            If there is none.
        """
        place = self._place(number)
        known: dict[str, Any] = json.loads((place / _STATE).read_text(encoding="utf-8"))
        log = place / _LOG
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines() if log.is_file() else []
        return {"id": number, **known, "progress": lines[-1][:300] if lines else "", "files": [*_files(place)]}

    def file(self, number: str, name: str) -> Path:
        """The path of a file of a run.

        Raises
        ------
        InputError
            If there is none of that name.
        """
        found = _files(self._place(number))
        if name not in found:
            raise InputError("file", "is none of this run's", f"choose of {', '.join(found)}")
        return regular(found[name].parent, found[name].name)

    def _place(self, number: str) -> Path:
        place = self.folder / number if ID.fullmatch(number) else None
        if place is None or place.is_symlink() or not (place / _STATE).is_file():
            raise InputError("run", "is not there", "choose one of the list")
        return place

    def _note(self, number: str, **facts: Any) -> None:
        file = self.folder / number / _STATE
        known = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
        new = file.with_suffix(".new")
        new.write_text(json.dumps(known | facts), encoding="utf-8")
        os.replace(new, file)

    async def _work(self) -> None:
        while True:
            number = await self._queue.get()
            if self.state(number)["state"] == "queued":
                await self._run(number)

    async def _run(self, number: str) -> None:
        place = self.folder / number
        self._note(number, state="running")
        command = _command(self.state(number))
        environment = {**os.environ, "GBEAM_PROGRESS": "0.5", "PYTHONUNBUFFERED": "1"}
        if "--report" in command:  # which has the figures
            environment["GBEAM_FIGURES"] = "none"
        with (place / _LOG).open("wb") as log, (place / _stdout(command)).open("wb") as answer:
            process = await asyncio.create_subprocess_exec(
                *command,
                cwd=place,
                env=environment,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=answer,
                stderr=log,
                start_new_session=True,
            )
            self._process = number, process
            try:
                status = await asyncio.wait_for(process.wait(), SECONDS)
                outcome = {0: _state(place, "done"), 1: _state(place, "failed"), 2: "refused"}.get(status, "ended")
            except TimeoutError:
                outcome = "out of time"
                _end(process)
            except asyncio.CancelledError:  # the server ends
                _end(process)
                self._note(number, state="interrupted")
                raise
            finally:
                self._process = None
        if self.state(number)["state"] == "running":
            self._note(number, state=outcome)


def _command(state: Mapping[str, Any]) -> list[str]:
    """A verb with its result as a report and as JSON; in words where it has no report."""
    result = ["--report", "--json"] if VERBS[state["verb"]].report else []
    arguments = [state["verb"], _SCENARIO, *state["arguments"], "--out", "out", *result]
    return [sys.executable, "-m", "gbeam.app.limited", str(MEMORY), str(SECONDS), *arguments]


def _state(place: Path, otherwise: str) -> str:
    """How an answer ended, in a few words: as its report says."""
    try:
        answer = json.loads((place / _ANSWER).read_text(encoding="utf-8"))
        state = str(answer.get("state") or answer["outcome"])
    except (OSError, ValueError, KeyError):  # words, or nothing
        return otherwise
    return "done" if state in GOOD else state


def _stdout(command: Sequence[str]) -> str:
    return _ANSWER if "--json" in command else _WORDS


def _files(place: Path) -> dict[str, Path]:
    """The files of a run by the names under which they are downloaded; its report has one name whatever the verb."""
    fixed = {name: file for name, inside in DOWNLOADS.items() if _holds(file := place / inside)}
    before = place / _BEFORE / _SCENARIO
    if before.is_file():
        changed = before.read_bytes() != fixed[_SCENARIO].read_bytes()
        fixed |= {_SCENARIO: before} | ({"placed.toml": fixed[_SCENARIO]} if changed else {})
    out = place / "out"
    written = {name: out / name for name in names(out)}
    report = next((file for name, file in written.items() if name.endswith(".html")), None)
    made = fixed if report is None else fixed | {"report.html": report}
    kinds = KINDS if report else (*KINDS, ".png")  # a report has the figures
    return made | {name: file for name, file in written.items() if name.endswith(kinds)}


def _holds(file: Path) -> bool:
    """Whether there is a file that is not empty."""
    return file.is_file() and file.stat().st_size > 0


def _end(process: asyncio.subprocess.Process) -> None:
    """Kill a process and all that it has started."""
    with suppress(ProcessLookupError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
