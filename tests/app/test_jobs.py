"""Runs: queued, cancelled, ended by their limits, and there again after a restart."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
import time
import tomllib
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from gbeam.app import jobs as module
from gbeam.app.jobs import Jobs
from gbeam.errors import InputError

from ..scenarios import FAST

WRONG = FAST.replace('"300 mm"', '"300 kg"')
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX's")


def _with(folder: Path, act: Callable[[Jobs], Awaitable[None]]) -> None:
    """Start the queue of a folder, act, and stop it, as a server does."""

    async def whole() -> None:
        jobs = Jobs(folder)
        jobs.start()
        try:
            await act(jobs)
        finally:
            await jobs.stop()

    asyncio.run(whole())


async def _until(jobs: Jobs, number: str, *states: str) -> str:
    begun = time.monotonic()
    while (state := str(jobs.state(number)["state"])) not in states:
        assert time.monotonic() - begun < 60, jobs.state(number)
        await asyncio.sleep(0.05)
    return state


@pytest.fixture
def sleeping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that sleep, with a child of their own, instead of computing."""
    code = "import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)']);"
    code += "print('gbeam: flight: run: 10%', file=sys.stderr, flush=True); time.sleep(600)"
    monkeypatch.setattr(module, "_command", lambda _: [sys.executable, "-c", code])


def test_runs_are_kept_and_wrong_ones_say_why(tmp_path: Path) -> None:
    numbers: list[str] = []

    async def act(jobs: Jobs) -> None:
        numbers.append(jobs.submit(WRONG, "wrong", []))
        assert await _until(jobs, numbers[0], "refused", "failed", "ended") == "refused"

    _with(tmp_path, act)
    again = Jobs(tmp_path)
    (run,) = again.list()
    assert run["id"] == numbers[0] and run["title"] == "wrong" and "answer.json" in run["files"]
    assert '"300 kg" is a mass' in again.file(numbers[0], "messages.txt").read_text()
    assert json.loads(again.file(numbers[0], "answer.json").read_text())["error"]


def test_files_of_a_run_are_known_kinds_in_its_folder(tmp_path: Path) -> None:
    jobs = Jobs(tmp_path)
    number = jobs.submit(FAST, "a", [], "fit")
    out = tmp_path / number / "out"
    out.mkdir()
    for name in ("fit.nc", "fit.png", "fit.svg", "fit.json", "command.json"):
        (out / name).write_text(name)
    (out / "link.nc").symlink_to(tmp_path / "elsewhere.nc")
    (out / "folder.nc").mkdir()
    assert set(jobs.state(number)["files"]) == {"scenario.toml", "fit.nc", "fit.png", "command.json"}
    (out / "fit.html").write_text("whatever the verb is called")
    assert set(jobs.state(number)["files"]) == {"scenario.toml", "fit.nc", "report.html", "command.json"}
    assert jobs.file(number, "report.html") == out / "fit.html"
    for name in ("link.nc", "folder.nc", "fit.svg", "state.json", "../scenario.toml", "fit.html"):
        with pytest.raises(InputError):
            jobs.file(number, name)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ('{"outcome": "limits exceeded"}', "limits exceeded"),
        ('{"error": []}', "failed"),
        ("in words", "failed"),
        ('{"outcome": "diverged", "state": "diverged"}', "diverged"),
        ('{"outcome": "done", "state": "not accepted"}', "not accepted"),
        ('{"outcome": "done", "state": "machine limits exceeded"}', "machine limits exceeded"),
        ('{"outcome": "some cases not accepted"}', "some cases not accepted"),
        ('{"outcome": "done", "state": "done, largest load peak missed"}', "done, largest load peak missed"),
        ('{"outcome": "done", "state": "accepted"}', "done"),
    ],
)
def test_a_result_that_is_not_what_was_asked_for_says_so(tmp_path: Path, answer: str, said: str) -> None:
    (tmp_path / "answer.json").write_text(answer)
    assert module._state(tmp_path, "failed") == said


def test_a_scenario_that_a_verb_writes_into_stays_as_it_came_beside_what_it_becomes(tmp_path: Path) -> None:
    text = FAST.replace('inverse = "flat"', 'inverse = "flat"  # kept')
    numbers = []

    async def act(jobs: Jobs) -> None:
        for arguments in (["--no-proof", "--write"], ["--no-proof"]):
            numbers.append(jobs.submit(text, "", [], "place", arguments))
            assert await _until(jobs, numbers[-1], "done", "failed", "refused", "ended") == "done"

    _with(tmp_path, act)
    jobs = Jobs(tmp_path)
    first, second = numbers
    assert jobs.file(first, "scenario.toml").read_text() == jobs.file(second, "scenario.toml").read_text() == text
    placed = jobs.file(first, "placed.toml").read_text()
    before, after = (tomllib.loads(each)["motion"].pop("spin") for each in (text, placed))
    assert after["control_point"] != before["control_point"] and {"arm"} <= {*before} <= {*after}
    assert "placed.toml" not in jobs.state(second)["files"]


@POSIX
def test_a_run_is_cancelled_with_all_that_it_started(tmp_path: Path, sleeping: None) -> None:
    async def act(jobs: Jobs) -> None:
        first, second = jobs.submit(FAST, "a", []), jobs.submit(FAST, "b", [])
        await _until(jobs, first, "running")
        while "10%" not in jobs.state(first)["progress"]:
            await asyncio.sleep(0.05)
        group = jobs._process[1].pid  # type: ignore[index]
        jobs.cancel(second)  # before its turn
        jobs.cancel(first)
        await asyncio.sleep(0.5)
        assert [each["state"] for each in jobs.list()] == ["cancelled", "cancelled"]
        assert not _processes(group)

    _with(tmp_path, act)


@POSIX
def test_what_a_server_leaves_is_interrupted_or_taken_up(
    tmp_path: Path, sleeping: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbers: list[str] = []

    async def leave(jobs: Jobs) -> None:
        numbers.extend(jobs.submit(WRONG, name, []) for name in "ab")
        await _until(jobs, numbers[0], "running")

    _with(tmp_path, leave)
    assert sorted(each["state"] for each in Jobs(tmp_path).list()) == ["interrupted", "queued"]
    monkeypatch.undo()

    async def take_up(jobs: Jobs) -> None:
        assert await _until(jobs, numbers[1], "refused")

    _with(tmp_path, take_up)


@POSIX
def test_a_run_ends_after_its_time(tmp_path: Path, sleeping: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "SECONDS", 0.3)

    async def act(jobs: Jobs) -> None:
        assert await _until(jobs, jobs.submit(FAST, "", []), "out of time", "interrupted") == "out of time"

    _with(tmp_path, act)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit a process's address space")
def test_a_run_has_so_much_memory_only(tmp_path: Path) -> None:
    hungry = tmp_path / "gbeam.py"  # found first, in place of the package
    hungry.write_text("import os\nprint(len(b'0' * (2 << 30)))\n")
    limited = Path(module.__file__).with_name("limited.py")
    command = [sys.executable, str(limited), str(1 << 30), "60"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode != 0 and "MemoryError" in ended.stderr


def _processes(group: int) -> list[str]:
    """The processes of a group that are left, zombies apart."""
    found = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True).stdout
    rows = (line.split(None, 2) for line in found.splitlines())
    return [row[2] for row in rows if len(row) == 3 and int(row[0]) == group and not row[1].startswith("Z")]
