"""Computed cases stay, whatever ends a sweep; a restart does what is missing and gives the same."""

from __future__ import annotations

import errno
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis.strategies import DataObject, binary, data, integers, just, one_of

import gbeam as gb
from gbeam.studies import NAME, Journal

from ..scenarios import UNJUDGED

Call = Callable[..., Any]
Whole = tuple[Any, list[bytes]]
OVER = ["motion.flight.acceleration.z.level=2 g:8 g:40"]
FEW = ["motion.flight.acceleration.z.level=2 g:8 g:3"]
MEASURE = ["flight.tip.z"]
STATIC = {"verb": "static", "motion": "flight"}
ARGUMENTS = ("--verb", "static", "--motion", "flight", "--over", *OVER, "--measure", *MEASURE, "--out", "there")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    """Figures of the sweep in one go, and its store."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "fast.toml").write_text(UNJUDGED, encoding="utf-8")
    figures = gb.sweep(folder / "fast.toml", OVER, MEASURE, **STATIC, store=folder).measures["flight.tip.z"]
    return figures, (folder / NAME).read_bytes().splitlines(keepends=True)


def test_a_killed_sweep_is_resumed(fast: Path, whole: Whole, gbeam: Call) -> None:
    slow = "import time, gbeam.studies.evaluate as e, gbeam.studies.workers as w\n"
    slow += "from gbeam.cli import main\nw.KEPT = 0.0\n"
    slow += "row = e.Inquiry.row\ndef later(*a):\n    time.sleep(0.05)\n    return row(*a)\ne.Inquiry.row = later\n"
    slow += f"main(['sweep', {str(fast)!r}, *{ARGUMENTS!r}])"
    process = subprocess.Popen([sys.executable, "-c", slow], stdout=subprocess.DEVNULL)
    journal = Path("there/cases.jsonl")
    while not journal.exists() or journal.read_bytes().count(b"\n") < 5:
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    lines = journal.read_bytes()
    assert 5 <= lines.count(b"\n") < 41
    journal.write_bytes(lines + b'{"case": 39, "outc')  # as if cut off in the middle of a line
    assert "add --resume" in gbeam("sweep", fast, *ARGUMENTS).err
    assert gbeam("sweep", fast, *ARGUMENTS, "--resume").status == 0
    assert lines[: lines.rfind(b"\n")] in journal.read_bytes()  # what was done is not computed again
    swept = gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    assert np.array_equal(swept.measures["flight.tip.z"], whole[0])


def test_a_full_disk_keeps_what_is_done(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def full(handle: int) -> None:
        calls.append(handle)
        if len(calls) > 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("gbeam.studies.workers.KEPT", 0.0)
    with monkeypatch.context() as patch:
        patch.setattr("gbeam.studies.journal.os.fsync", full)
        answer = gbeam("sweep", fast, *ARGUMENTS)
    assert answer.status == 1 and "No space left" in answer.err
    assert not Path("there/sweep.zarr").exists()
    assert gbeam("sweep", fast, *ARGUMENTS, "--resume").status == 0
    assert Path("there/sweep.zarr").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such limits")
def test_a_disk_that_is_full_in_the_middle_of_a_line(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    import resource

    monkeypatch.setattr("gbeam.studies.workers.KEPT", 0.0)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1500, before[1]))
    try:
        answer = gbeam("sweep", fast, *ARGUMENTS)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert answer.status == 1 and "interrupted: there/cases.jsonl: File too large; what is done is kept" in answer.err
    kept = Path("there/cases.jsonl").read_bytes()
    assert len(kept) == 1500 and not kept.endswith(b"\n")
    assert gbeam("sweep", fast, *ARGUMENTS, "--resume").status == 0
    assert Path("there/cases.jsonl").read_bytes().startswith(kept[: kept.rfind(b"\n") + 1])


def test_another_sweeps_store_is_refused_by_what_differs(fast: Path) -> None:
    gb.sweep(fast, FEW, MEASURE, **STATIC, store="there")
    with pytest.raises(gb.InputError, match="its measures differs"):
        gb.sweep(fast, FEW, ["flight.tip.x"], **STATIC, store="there", resume=True)
    with pytest.raises(gb.InputError, match="its values and cases differ"):
        gb.sweep(fast, ["motion.flight.acceleration.z.level=2 g:8 g:2"], MEASURE, **STATIC, store="there", resume=True)
    Path("there/cases.jsonl").write_text("something else\n", encoding="utf-8")
    with pytest.raises(gb.InputError, match="not the store of a sweep"):
        gb.sweep(fast, FEW, MEASURE, **STATIC, store="there", resume=True)


def test_a_store_that_is_being_written_is_refused(fast: Path) -> None:
    """By the lock of the system, which ends with its process, and not by what stands in its file."""
    Path("there").mkdir()
    lock = Path("there/.lock")
    holding = "import sys, time; from pathlib import Path; from gbeam.guards import hold_lock\n"
    holding += "with hold_lock(Path('there/.lock'), '', ''):\n    print('held', flush=True)\n    time.sleep(60)"
    process = subprocess.Popen([sys.executable, "-c", holding], stdout=subprocess.PIPE)
    assert process.stdout is not None and process.stdout.readline() == b"held\n"
    who = f"process {process.pid} on {platform.node()}"
    assert lock.read_text(encoding="utf-8").strip() == who
    with pytest.raises(gb.InputError, match=f"--out there is in use by {re.escape(who)}; wait"):
        gb.sweep(fast, FEW, MEASURE, **STATIC, store="there")
    lock.write_text("", encoding="utf-8")  # as it is for a moment
    with pytest.raises(gb.InputError, match="in use by another process; wait"):
        gb.sweep(fast, FEW, MEASURE, **STATIC, store="there")
    process.kill()
    process.wait()
    process.stdout.close()
    for left in (f"process {os.getppid()} on {platform.node()}", str(os.getppid()), "", "\0"):  # of a process that runs
        lock.write_text(left, encoding="utf-8")
        gb.sweep(fast, FEW, MEASURE, **STATIC, store="there")


@pytest.mark.skipif(sys.platform == "win32", reason="its locks are others")
def test_a_file_system_without_locks_will_do(fast: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", none)
    gb.sweep(fast, FEW, MEASURE, **STATIC, store="there")


def _stored(whole: Whole) -> tuple[Path, list[bytes]]:
    Path("there").mkdir()
    journal = Path("there/cases.jsonl")
    journal.write_bytes(b"".join(whole[1]))
    return journal, list(whole[1])


def test_damaged_lines_are_named_and_the_others_kept(fast: Path, whole: Whole, gbeam: Call) -> None:
    journal, lines = _stored(whole)
    digit = lines[4].replace(b'"values": [', b'"values": [1')  # whole JSON, and wrong by a factor
    journal.write_bytes(b"".join([*lines[:4], digit, *lines[5:8], b"\x00\xff{]\n", *lines[9:20]]))
    answer = gbeam("sweep", fast, *ARGUMENTS, "--resume")
    assert "2 of the 19 cases kept in there/cases.jsonl were damaged (line 5, 9)" in " ".join(answer.out.split())
    assert "the other 17 are as they were" in " ".join(answer.out.split())
    kept = journal.read_bytes().splitlines(keepends=True)
    assert kept[:7] == [*lines[:4], *lines[5:8]] and len(kept) == 41  # and no damaged one
    swept = gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    assert np.array_equal(swept.measures["flight.tip.z"], whole[0]) and not swept.warnings


def test_what_is_kept_is_never_rewritten_in_place(fast: Path, whole: Whole, monkeypatch: pytest.MonkeyPatch) -> None:
    journal, lines = _stored(whole)
    cut = b"".join(lines[:30]) + lines[30][:20]
    journal.write_bytes(cut)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr("gbeam.studies.journal.os.replace", full)  # as if it had been killed there
        with pytest.raises(gb.ComputationError, match="what is done is kept"):
            gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    assert journal.read_bytes() == cut
    before = journal.stat()
    kept = b"".join(lines[:30])
    journal.write_bytes(kept)
    gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    assert journal.stat().st_ino == before.st_ino and journal.read_bytes().startswith(kept)  # only appended to
    assert {each.name for each in Path("there").iterdir()} <= {"cases.jsonl", ".lock", "cases.new"}


def test_a_sweep_that_was_begun_in_the_meantime_is_not_lost(
    fast: Path, whole: Whole, monkeypatch: pytest.MonkeyPatch
) -> None:
    """True if another's cases would be lost is asked again when the lock is held."""
    journal, lines = _stored(whole)
    begun = b"".join(lines[:10])
    journal.unlink()
    begin = Journal._begin

    def later(self: Journal, resume: bool) -> None:
        journal.write_bytes(begun)
        begin(self, resume)

    monkeypatch.setattr(Journal, "_begin", later)
    with pytest.raises(gb.InputError, match="holds a sweep that is not finished"):
        gb.sweep(fast, OVER, MEASURE, **STATIC, store="there")
    assert journal.read_bytes() == begun


def test_a_store_that_is_removed_while_a_sweep_runs_is_said(
    fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    add, calls = Journal.add, []

    def removing(self: Journal, rows: Any) -> None:
        calls.append(1)
        if len(calls) == 3:
            shutil.rmtree("there")
        add(self, rows)

    monkeypatch.setattr("gbeam.studies.workers.KEPT", 0.0)
    monkeypatch.setattr(Journal, "add", removing)
    answer = gbeam("sweep", fast, *ARGUMENTS)
    assert answer.status == 1 and "there/cases.jsonl was removed while the sweep ran" in answer.err
    assert len(calls) == 3


@pytest.mark.parametrize(
    "content",
    [b"", b"\n", b"{}\n", b"[1]\n", b"null\n{}\n", b'{"crc32": 0}\n', b"\x00" * 4096, b"\xff\xfe{", b"[" * 9999],
)
def test_any_file_in_its_place_is_a_message(fast: Path, gbeam: Call, content: bytes) -> None:
    Path("there").mkdir()
    Path("there/cases.jsonl").write_bytes(content)
    for resume in ((), ("--resume",)):
        answer = gbeam("sweep", fast, *ARGUMENTS, *resume)
        if content:
            assert answer.status == 2 and "not the store of a sweep" in answer.err
        else:  # nothing is lost
            assert answer.status == 0


@pytest.mark.parametrize("name", ["cases.jsonl", ".lock", "cases.new"])
def test_a_folder_in_its_place_is_a_message(fast: Path, gbeam: Call, name: str) -> None:
    Path("there", name).mkdir(parents=True)
    answer = gbeam("sweep", fast, *ARGUMENTS)
    assert answer.status in (1, 2) and "irectory" in answer.err


@given(data())
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_damage_of_a_store_changes_a_figure(fast: Path, whole: Whole, draw: DataObject) -> None:
    """A few bytes changed, cut out or doubled anywhere: refused by name, or the same figures."""
    shutil.rmtree("there", ignore_errors=True)
    journal, lines = _stored(whole)
    text = b"".join(lines)
    at, size = draw.draw(integers(0, len(text) - 1)), draw.draw(integers(0, 300))
    inside = draw.draw(one_of(binary(max_size=4), just(text[at : at + 2 * size]), just(b"\n")))
    journal.write_bytes(text[:at] + inside + text[at + size :])
    try:
        swept = gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    except gb.InputError as error:
        assert error.where == "--out"
        return
    assert np.array_equal(swept.measures["flight.tip.z"], whole[0]) and swept.counts == {"done": 40}


def test_a_figure_that_a_case_does_not_have_is_kept_as_none(fast: Path) -> None:
    """Not as zero: of what is resumed the figures are those of a sweep in one go, and so are its statistics."""
    over, figures = {"motion.spin.control_point": "100 mm, 400 mm, 200 mm"}, ["spin.tip.z.max_abs", "verdict.spread"]
    at_once = gb.sweep(fast, over, figures, store="there")
    again = gb.sweep(fast, over, figures, store="there", resume=True)
    assert at_once.outcome.tolist() == ["done", "refused", "done"]
    for name in figures:
        assert np.isnan(at_once.measures[name]).tolist()[1]
        np.testing.assert_array_equal(again.measures[name], at_once.measures[name])
