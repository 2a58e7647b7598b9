"""Runs: queued, cancelled, ended by their limits, and there again after a restart."""

from __future__ import annotations

import asyncio
import errno
import json
import os
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

import gbeam as gb
from gbeam.app import LIMITED, Jobs, changes, files
from gbeam.app import jobs as module

from ..guards.test_importing import SCENARIO, sprung, trap
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


async def _begun(jobs: Jobs, number: str) -> None:
    """Wait until a run that sleeps has said how far it is."""
    while "10%" not in jobs.state(number)["progress"]:
        await asyncio.sleep(0.05)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that are done at once."""
    monkeypatch.setattr(module, "_command", lambda _: [sys.executable, "-c", "print('{}')", "--json"])
    monkeypatch.setattr(module, "PAUSE", 0.05)


@pytest.fixture
def sleeping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs that sleep, with a child of their own, instead of computing."""
    code = "import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)']);"
    code += "open('progress.txt', 'w').write('flight: run: 10%'); time.sleep(600)"
    monkeypatch.setattr(module, "_command", lambda _: [sys.executable, "-c", code])
    monkeypatch.setattr(module, "PAUSE", 0.1)


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
        with pytest.raises(gb.InputError):
            jobs.file(number, name)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ('{"outcome": "limits exceeded"}', "limits exceeded"),
        ('{"error": []}', "failed"),
        ("in words", "failed"),
        ('{"outcome": "diverged", "state": "diverged"}', "diverged"),
        ('{"outcome": "done", "state": "NOT ACCEPTED"}', "NOT ACCEPTED"),
        (
            '{"outcome": "done", "state": "NOT ACCEPTED, machine limits exceeded"}',
            "NOT ACCEPTED, machine limits exceeded",
        ),
        ('{"outcome": "some cases not accepted"}', "some cases not accepted"),
        ('{"outcome": "done", "state": "done, largest peak missed"}', "done, largest peak missed"),
        ('{"outcome": "done", "state": "PASS"}', "done"),
    ],
)
def test_a_result_that_is_not_what_was_asked_for_says_so(tmp_path: Path, answer: str, said: str) -> None:
    (tmp_path / "answer.json").write_text(answer)
    assert module._state(tmp_path, "failed") == said


def test_a_scenario_that_a_verb_writes_into_stays_as_it_came_beside_what_it_becomes(tmp_path: Path) -> None:
    turning = '"table", times = [0, 0.2, 0.4], values = ["5 g", "5 g", "7 g"]'
    text = FAST.replace('inverse = "flat"', 'inverse = "flat"  # kept\nsmoothing = "60 ms"')
    text, numbers = text.replace('"constant", level = "6 g"', turning), []

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
        await _begun(jobs, first)
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
def test_a_run_whose_folder_is_deleted_is_forgotten(tmp_path: Path, sleeping: None) -> None:
    async def act(jobs: Jobs) -> None:
        numbers = [jobs.submit(FAST, name, []) for name in "abc"]
        await _begun(jobs, numbers[0])
        group = jobs._process[1].pid  # type: ignore[index]
        shutil.rmtree(tmp_path / numbers[1])  # before its turn
        shutil.rmtree(tmp_path / numbers[0])
        await _begun(jobs, numbers[2])
        assert not _processes(group) and [each["id"] for each in jobs.list()] == [numbers[2]]
        shutil.rmtree(tmp_path)  # all of them
        await asyncio.sleep(0.5)
        await _until(jobs, jobs.submit(FAST, "d", []), "running")

    _with(tmp_path, act)


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", '{"state": 3}', '{"state": "queued", "verb": "app"}', "\ufeff{}", "[" * 100_000, None],
    ids=["empty", "cut", "list", "number", "verb", "mark", "deep", "missing"],
)
def test_a_damaged_run_is_said_to_be_and_others_go_on(tmp_path: Path, content: str | None, quick: None) -> None:
    numbers = [Jobs(tmp_path).submit(FAST, name, []) for name in "ab"]
    state = tmp_path / numbers[0] / "state.json"
    state.unlink()
    if content is not None:
        state.write_text(content, encoding="utf-8")

    async def act(jobs: Jobs) -> None:
        await _until(jobs, numbers[1], "done")
        damaged = jobs.list()[1]
        assert damaged["id"] == numbers[0] and damaged["state"] == "damaged" and "scenario.toml" in damaged["files"]
        third = jobs.submit(FAST, "c", [])
        (tmp_path / third / "state.json").write_text(content or "")  # also while it waits or runs
        await asyncio.sleep(0.3)
        assert jobs.state(third)["state"] in ("damaged", "done")
        await _until(jobs, jobs.submit(FAST, "d", []), "done")

    _with(tmp_path, act)


def test_a_folder_in_place_of_a_file_fails_one_run(tmp_path: Path, quick: None) -> None:
    numbers = [Jobs(tmp_path).submit(FAST, name, []) for name in "ab"]
    (tmp_path / numbers[0] / "answer.json").mkdir()

    async def act(jobs: Jobs) -> None:
        await _until(jobs, numbers[1], "done")
        assert jobs.state(numbers[0])["state"] == "failed"

    _with(tmp_path, act)


def test_runs_go_on_after_a_mistake_in_gbeam(
    tmp_path: Path, quick: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wrong(_: object) -> list[str]:
        monkeypatch.undo()
        raise KeyError("a mistake")

    sound = module._command
    monkeypatch.setattr(module, "_command", wrong)

    async def act(jobs: Jobs) -> None:
        first, second = jobs.submit(FAST, "a", []), jobs.submit(WRONG, "b", [])
        assert await _until(jobs, first, "failed", "done") == "failed"
        await _until(jobs, second, "refused")

    _with(tmp_path, act)
    assert sound is not wrong and "a mistake" in capsys.readouterr().err


@pytest.mark.parametrize("trouble", [errno.ENOSPC, errno.EMFILE])
def test_the_queue_waits_for_a_disk_and_forgets_nothing(
    tmp_path: Path, quick: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], trouble: int
) -> None:
    sound, short = module.write, [False]

    def write(file: Path, content: bytes) -> None:
        if short[0]:
            raise OSError(trouble, "there is none left")
        sound(file, content)
        short[0] = b'"running"' in content  # from there on

    monkeypatch.setattr(module, "write", write)

    async def act(jobs: Jobs) -> None:
        first, second = jobs.submit(FAST, "a", []), jobs.submit(FAST, "b", [])
        await _until(jobs, first, "done")
        while "waits: there is none left" not in jobs.state(second)["progress"]:
            await asyncio.sleep(0.02)
        with pytest.raises(OSError, match="none left"):
            jobs.submit(FAST, "c", [])
        assert [each["state"] for each in jobs.list()] == ["queued", "done"]
        assert [json.loads(file.read_text())["state"] for file in sorted(tmp_path.glob("*/state.json"))] == [
            "running", "queued",
        ]  # fmt: skip
        monkeypatch.setattr(module, "write", sound)
        await _until(jobs, second, "done")

    _with(tmp_path, act)
    assert [json.loads(file.read_text())["state"] for file in tmp_path.glob("*/state.json")] == ["done", "done"]
    assert not [*tmp_path.glob(".*")] and capsys.readouterr().err.count("none left") == 1


def test_runs_are_computed_in_the_order_in_which_they_came(tmp_path: Path) -> None:
    jobs = Jobs(tmp_path)
    numbers = [jobs.submit(FAST, "", []) for _ in range(6)]
    assert numbers == sorted(numbers) and [each["id"] for each in jobs.list()] == numbers[::-1]


def test_a_file_is_whole_or_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[str] = []
    replace, sync = os.replace, os.fsync
    monkeypatch.setattr(os, "fsync", lambda handle: (order.append("sync"), sync(handle)))
    monkeypatch.setattr(os, "replace", lambda *names: (order.append("replace"), replace(*names)))
    files.write(tmp_path / "state.json", b"one")
    assert order == ["sync", "replace"]

    def fail(handle: int) -> None:
        raise OSError(errno.ENOSPC, "full")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="full"):
        files.write(tmp_path / "state.json", b"two")
    assert [each.name for each in tmp_path.iterdir()] == ["state.json"]
    assert (tmp_path / "state.json").read_text() == "one"


@POSIX
def test_all_of_a_run_is_for_its_owner_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import os; os.mkdir('out'); open('out/result.nc', 'w').write('x'); print('{}')"
    monkeypatch.setattr(module, "_command", lambda _: [sys.executable, "-c", code, "--json"])
    before = os.umask(0)  # of those who let everybody read
    try:
        record = files.store(tmp_path / "records", "a.csv", b"t,z", lambda file: tmp_path / "records" / file.name)
        numbers: list[str] = []

        async def act(jobs: Jobs) -> None:
            numbers.append(jobs.submit(FAST, "", [record], "place", ["--write"]))
            await _until(jobs, numbers[0], "done")

        _with(tmp_path / "runs", act)
    finally:
        os.umask(before)
    place = tmp_path / "runs" / numbers[0]
    every = [record.parent, record, place, *place.rglob("*")]
    names = {"a.csv", "scenario.toml", ".before", "state.json", "answer.json", "messages.txt", "out", "result.nc"}
    assert {each.name for each in every} >= names
    assert [str(each) for each in every if each.stat().st_mode & 0o077] == []


def test_runs_of_one_title_are_told_apart(tmp_path: Path) -> None:
    jobs = Jobs(tmp_path)
    assert jobs.last_text("fast") == ""
    jobs.submit(FAST, "fast", [])
    jobs.submit(WRONG, "another", [], changes="length")
    assert jobs.last_text("fast") == FAST and [each["changes"] for each in jobs.list()] == ["length", ""]
    after = FAST.replace("300 mm", "310 mm").replace("damping_ratio = 0.01\n", "")
    assert changes(FAST, FAST) == "as before"
    assert changes(FAST, after) == "beam.length = 310 mm, no beam.damping_ratio"
    many = "title = 'a'\n" + "".join(f"[motion.m{i}]\nkind = 'flight'\n" for i in range(9))
    said = changes("title = 'a'", many)
    assert said == "motion.m0.kind = flight, motion.m1.kind = flight, motion.m2.kind = flight, and 6 more"
    assert changes("", f"title = {'x' * 99!r}") == f"title = {'x' * 40}…" and changes("[", "") == ""


@POSIX
def test_a_run_ends_after_its_time(tmp_path: Path, sleeping: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "SECONDS", 0.3)

    async def act(jobs: Jobs) -> None:
        assert await _until(jobs, jobs.submit(FAST, "", []), "out of time", "interrupted") == "out of time"

    _with(tmp_path, act)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not limit a process's address space")
def test_a_run_has_so_much_memory_only(tmp_path: Path) -> None:
    hungry = f"from gbeam.cli import entry\nentry.main = lambda: len(b'0' * (2 << 30))\n{LIMITED}"
    command = [sys.executable, "-P", "-c", hungry, str(1 << 30), "60"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode != 0 and "MemoryError" in ended.stderr


def test_a_run_imports_nothing_that_was_uploaded(tmp_path: Path) -> None:
    """Not even of an earlier version's folder, which took files of any name, beside it or where it is computed."""
    (tmp_path / "records").mkdir()
    trap(tmp_path / "records")
    records = [*(tmp_path / "records").glob("*.*")]

    async def act(jobs: Jobs) -> None:
        number = jobs.submit(SCENARIO, "a", records, "static")
        for each in records:
            shutil.copy(each, tmp_path / "runs" / number)
        assert await _until(jobs, number, "done", "refused", "failed", "ended") == "done"
        assert "answer.json" in jobs.state(number)["files"]

    _with(tmp_path / "runs", act)
    assert sprung(tmp_path) == []


def _processes(group: int) -> list[str]:
    """The processes of a group that are left, zombies apart."""
    done = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True).stdout
    rows = (line.split(None, 2) for line in done.splitlines())
    return [row[2] for row in rows if len(row) == 3 and int(row[0]) == group and not row[1].startswith("Z")]
