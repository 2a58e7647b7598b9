"""Runs, one folder each: queued, computed one after the other in a process of their own, and kept.

The states in the folders are the queue: a run whose folder is deleted is forgotten, even while it waits or runs. While
the disk is full, or descriptors are used up, the queue waits.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import secrets
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from gbeam.app.files import SHORT, ensure_folder, names, private, regular, write
from gbeam.app.verbs import INPUT, verbs
from gbeam.errors import InputError
from gbeam.guards.importing import variables
from gbeam.results.criteria import GOOD

ID = re.compile(r"\d{8}-\d{6}-[0-9a-f]{8}")
LIMITED = "import sys; from gbeam.cli.entry import limited; sys.exit(limited())"
MEMORY = 16 * 2**30  # bytes of address space, of which compiled programs reserve far more than they use
SECONDS = 3600  # of processor time, and of wall-clock time
QUEUED = 100
PAUSE = 1.0  # s until a resource that is used up is tried again, and between checks that a run's folder exists
DAMAGED = "damaged"  # state of a run whose state cannot be read
_STATE, _LOG, _MESSAGES, _ANSWER = "state.json", "progress.txt", "messages.txt", "answer.json"
_SCENARIO = "scenario.toml"
_BEFORE = ".before"  # folder with a copy of the scenario, where the verb writes into it
# Files that may be downloaded, by name, and their places in a run's folder; so may what the verb writes as KINDS.
DOWNLOADS = (
    (_SCENARIO, _SCENARIO),  # of earlier runs
    (_SCENARIO, f"{INPUT}/{_SCENARIO}"),
    (_ANSWER, _ANSWER),
    (_MESSAGES, _MESSAGES),
    ("found.toml", f"{INPUT}/found.toml"),
    ("command.json", "out/command.json"),
)
KINDS = (".nc", ".csv", ".mat")


class Jobs:
    """The runs of one folder, and the queue."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = threading.RLock()  # requests are answered in threads
        self._unsaved: dict[str, dict[str, Any]] = {}  # facts by run that the disk did not take
        self._process: tuple[str, asyncio.subprocess.Process] | None = None
        self._cancelled = ""  # run to be ended
        self._trouble = ""  # for which the queue waits to pass
        self._task: asyncio.Task[None] | None = None
        self._more = asyncio.Event()  # set by a new run
        self._loop: asyncio.AbstractEventLoop | None = None

    def start(self) -> None:
        """Begin to work, first on runs that an earlier server left in the queue."""
        for incomplete in self.folder.glob(".new-*"):  # an earlier server ended while it was written
            shutil.rmtree(incomplete, ignore_errors=True)
        for job in self.list():
            if job["state"] == "running":  # its process ended with the server
                self._note(job["id"], state="interrupted")
        self._loop = asyncio.get_running_loop()
        self._task = asyncio.create_task(self._work())

    async def stop(self) -> None:
        """End the process that runs; its run is interrupted."""
        if self._task is not None:
            self._task.cancel()
            with suppress(asyncio.CancelledError):
                await self._task
        for number in [*self._unsaved]:
            self._note(number)

    def submit(
        self,
        text: str,
        title: str,
        records: Sequence[Path],
        verb: str = "run",
        arguments: Sequence[str] = (),
        case: str = "",
        changes: str = "",
    ) -> str:
        """Queue a verb on a scenario, with copies of its records; return its id.

        A `case` of a sweep that has a run already gets the id of that. `changes` are from the last run of its title.
        """
        time_now = datetime.now()  # first in the id, as runs are computed in the order of their ids
        number = f"{time_now:%Y%m%d-%H%M%S}-{time_now.microsecond:05x}{secrets.randbelow(0x1000):03x}"
        facts = {"title": title, "verb": verb, "case": case, "changes": changes, "arguments": list(arguments)}
        hidden = ensure_folder(self.folder / f".new-{number}")
        try:
            inputs = ensure_folder(hidden / INPUT)
            for record in records:
                write(inputs / record.name, record.read_bytes())
            scenario = text.encode("utf-8")
            write(inputs / _SCENARIO, scenario)
            if "--write" in arguments:
                write(ensure_folder(hidden / _BEFORE) / _SCENARIO, scenario)
            write(hidden / _STATE, json.dumps({"state": "queued", **facts}).encode())
            with self._lock:
                jobs = self.list()
                existing = next((job["id"] for job in jobs if case and job["case"] == case), None)
                if existing is not None:
                    return str(existing)
                if sum(job["state"] == "queued" for job in jobs) >= QUEUED:
                    raise InputError("runs", f"wait already, {QUEUED} of them", "cancel some")
                hidden.rename(self.folder / number)
        finally:
            shutil.rmtree(hidden, ignore_errors=True)  # unless it was renamed
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._more.set)
        return number

    def last_text(self, title: str) -> str:
        """Return the text of the scenario of the last run of a title, or empty without one."""
        numbers = (job["id"] for job in self.list() if job["title"] == title and _SCENARIO in job["files"])
        number = next(numbers, None)
        return "" if number is None else self.file(number, _SCENARIO).read_text(encoding="utf-8", errors="replace")

    def cancel(self, number: str) -> None:
        """End a run, or take it out of the queue."""
        with self._lock:
            state = self.state(number)["state"]
            if state == "queued":
                self._note(number, state="cancelled")
            elif state == "running":
                self._cancelled = number
                if self._process is not None and self._process[0] == number:
                    _end(self._process[1])

    def list(self) -> list[dict[str, Any]]:
        """Return the states of all runs, the latest first."""
        if not self.folder.is_dir():
            return []
        jobs = []
        for number in sorted((entry.name for entry in self.folder.iterdir() if ID.fullmatch(entry.name)), reverse=True):
            with suppress(InputError, FileNotFoundError):  # deleted in the meantime
                jobs.append(self.state(number))
        return jobs

    def state(self, number: str) -> dict[str, Any]:
        """Return the state, title, last line of progress and files of a run."""
        place = self._place(number)
        state = _read(place / _STATE) | self._unsaved.get(number, {})
        if state["state"] == "queued":
            progress = f"waits: {self._trouble}" if self._trouble else ""
        else:
            progress = _last_line(place / _LOG)
        return {"id": number, **state, "progress": progress, "files": [*_files(place)]}

    def file(self, number: str, name: str) -> Path:
        """Return the path of a file of a run; InputError if it has no such file."""
        files = _files(self._place(number))
        if name not in files:
            raise InputError("file", "is none of this run's", f"choose of {', '.join(files)}")
        return regular(files[name].parent, files[name].name)

    def complain(self, trouble: str) -> None:
        """Print on the terminal what the queue waits for, once until that has changed."""
        if trouble != self._trouble:
            self._trouble = trouble
            with suppress(OSError):
                print(f"gbeam: waits until this has passed: {trouble}", file=sys.stderr, flush=True)

    def _place(self, number: str) -> Path:
        """Folder of a run; InputError if there is none."""
        place = self.folder / number if ID.fullmatch(number) else None
        if place is None or place.is_symlink() or not place.is_dir():
            raise InputError("run", "is not there", "choose one of the list")
        return place

    def _note(self, number: str, **facts: Any) -> bool:
        """Add facts to the state of a run; if the disk does not take them, keep them in memory and return false."""
        file = self.folder / number / _STATE
        with self._lock:
            unsaved = self._unsaved.pop(number, {}) | facts
            try:
                write(file, json.dumps(_read(file) | unsaved).encode())
            except FileNotFoundError:  # the run was deleted
                return True
            except OSError as error:
                self._unsaved[number] = unsaved
                self.complain(error.strerror or str(error))
                return False
        return True

    async def _work(self) -> None:
        """Compute the queued runs, the earliest first, and wait for more."""
        while True:
            number = ""
            try:
                saved = all([self._note(unsaved) for unsaved in [*self._unsaved]])
                number = next((job["id"] for job in reversed(self.list()) if job["state"] == "queued"), "")
                if number and await self._run(number):
                    continue
                if not number and saved:
                    self._trouble = ""
                    self._more.clear()
                    await self._more.wait()
                    continue
            except InputError:  # the run was deleted
                continue
            except OSError as error:
                self.complain(error.strerror or str(error))
            except Exception:  # a defect: the other runs go on
                traceback.print_exc()
                if number:
                    self._note(number, state="failed")
            await asyncio.sleep(PAUSE)

    async def _run(self, number: str) -> bool:
        """Compute a run to its end; return false if it cannot begin and stays in the queue."""
        place = self._place(number)
        with self._lock:
            facts = _read(place / _STATE)
            if self.state(number)["state"] != "queued":
                return True  # just cancelled
            if not self._note(number, state="running"):
                self._unsaved.pop(number)
                return False
        try:
            process = await _begun(place, _command(facts))
        except OSError as error:
            temporary = error.errno in SHORT
            self._note(number, state="queued" if temporary else "failed")
            if temporary:
                raise
            return True
        self._trouble = ""
        self._process = number, process
        if self._cancelled == number:  # while the process started
            _end(process)
        try:
            state = await self._ended(place, process)
        except asyncio.CancelledError:  # the server ends
            self._note(number, **facts | {"state": "interrupted"})
            raise
        finally:
            _end(process)
            self._process = None
        if place.is_dir():
            self._note(number, **facts | {"state": state})
        return True

    async def _ended(self, place: Path, process: asyncio.subprocess.Process) -> str:
        """Wait until a process has ended, its time is over or its folder deleted; return the final state of its run."""
        end = asyncio.ensure_future(process.wait())
        deadline = asyncio.get_running_loop().time() + SECONDS
        while not end.done():
            left = deadline - asyncio.get_running_loop().time()
            if left <= 0 or not place.is_dir():
                return "out of time"  # or deleted, and the state is not kept
            await asyncio.wait([end], timeout=min(left, PAUSE))
        if self._cancelled == place.name:
            return "cancelled"
        by_status = {0: "done", 1: "failed", 2: "refused"}.get(end.result(), "ended")
        while end.result() in (0, 1):
            try:
                return _state(place, by_status)
            except OSError as error:
                self.complain(error.strerror or str(error))
                await asyncio.sleep(PAUSE)
        return by_status


async def _begun(place: Path, command: Sequence[str]) -> asyncio.subprocess.Process:
    """Start a command in a run's folder, so that only the owner can read its files."""
    environment = os.environ | variables()
    environment |= {"GBEAM_PROGRESS": "0.5", "GBEAM_PROGRESS_FILE": _LOG, "PYTHONUNBUFFERED": "1"}
    environment["GBEAM_FIGURES"] = "none"  # the report has them
    with private(place / _MESSAGES) as messages, private(place / _ANSWER) as answer:
        return await asyncio.create_subprocess_exec(
            *command,
            cwd=place,
            env=environment,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=answer,
            stderr=messages,
            start_new_session=True,
            umask=0o077,
        )


def _read(file: Path) -> dict[str, Any]:
    """Facts in the state of a run; the default ones, with the state damaged, if they cannot be read or are wrong."""
    damaged = {"state": DAMAGED, "title": "", "verb": "run", "case": "", "changes": "", "arguments": []}
    try:
        facts = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        if error.errno in SHORT:
            raise
        return damaged
    except (ValueError, RecursionError):
        return damaged
    if not isinstance(facts, dict) or any(not isinstance(facts.get(key), type(damaged[key])) for key in damaged):
        return damaged
    texts = all(isinstance(argument, str) for argument in facts["arguments"])
    return facts if facts["verb"] in verbs() and texts else damaged


def _last_line(log: Path) -> str:
    try:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    except FileNotFoundError:
        return ""
    return lines[-1][:300] if lines else ""


def _command(state: Mapping[str, Any]) -> list[str]:
    """Command that runs the verb of a run, within limits, and writes a report and JSON."""
    arguments = [state["verb"], f"{INPUT}/{_SCENARIO}", *state["arguments"], "--out", "out", "--report", "--json"]
    return [sys.executable, "-P", "-c", LIMITED, str(MEMORY), str(SECONDS), *arguments]


def _state(place: Path, default: str) -> str:
    """State of a run by its answer, such as done or not accepted; `default` if the answer does not say it."""
    try:
        answer = json.loads((place / _ANSWER).read_text(encoding="utf-8"))
        state = str(answer.get("state") or answer["outcome"])
    except OSError as error:
        if error.errno in SHORT:
            raise
        return default
    except (ValueError, LookupError, TypeError, AttributeError):  # no JSON, or another form
        return default
    return "done" if state in GOOD else state


def _files(place: Path) -> dict[str, Path]:
    """Files of a run by the names under which they are downloaded. Every verb's report is report.html."""
    files = {}
    for name, path in DOWNLOADS:
        file = place / path
        if file.is_file() and file.stat().st_size:
            files[name] = file
    original = place / _BEFORE / _SCENARIO
    if original.is_file() and _SCENARIO in files:  # a verb may have changed the scenario
        changed = files[_SCENARIO]
        files[_SCENARIO] = original
        if original.read_bytes() != changed.read_bytes():
            files["placed.toml"] = changed
    results = place / "out"
    outputs = {name: results / name for name in names(results)}
    reports = [file for name, file in outputs.items() if name.endswith(".html")]
    if reports:
        files["report.html"] = reports[0]
    kinds = KINDS if reports else (*KINDS, ".png")  # a report has the figures
    return files | {name: file for name, file in outputs.items() if name.endswith(kinds)}


def _end(process: asyncio.subprocess.Process) -> None:
    """Kill a process and those that it has started, unless it has ended."""
    if process.returncode is not None:
        return
    with suppress(ProcessLookupError):
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
