"""What is done stays done, whatever ends a sweep; a restart does what is missing and gives the same."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.errors import InputError

Call = Callable[..., Any]
OVER = ["motion.flight.acceleration.z.level=2 g:8 g:40"]
MEASURE = ["flight.tip.z"]
STATIC = {"verb": "static", "motion": "flight"}
ARGUMENTS = ("--verb", "static", "--motion", "flight", "--over", *OVER, "--measure", *MEASURE, "--out", "there")


def _whole(fast: Path) -> Any:
    return gb.sweep(fast, OVER, MEASURE, **STATIC).measures["flight.tip.z"]


def test_a_killed_sweep_is_resumed(fast: Path, gbeam: Call) -> None:
    slow = "import time, gbeam.sweeps.computing.evaluate as e, gbeam.sweeps.sweep as s\n"
    slow += "from gbeam.cli import main\ns._LONGEST = 1\n"
    slow += "row = e.Question.row\ndef later(*a):\n    time.sleep(0.05)\n    return row(*a)\ne.Question.row = later\n"
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
    found = gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)
    assert np.array_equal(found.measures["flight.tip.z"], _whole(fast))


def test_a_full_disk_keeps_what_is_done(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def full(handle: int) -> None:
        calls.append(handle)
        if len(calls) > 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("gbeam.sweeps.sweep._LONGEST", 4)
    with monkeypatch.context() as patch:
        patch.setattr("gbeam.sweeps.journal.os.fsync", full)
        answer = gbeam("sweep", fast, *ARGUMENTS)
    assert answer.status == 1 and "No space left" in answer.err
    assert not Path("there/sweep.zarr").exists()
    assert gbeam("sweep", fast, *ARGUMENTS, "--resume").status == 0
    assert Path("there/sweep.zarr").exists()


def test_another_sweeps_store_is_refused_by_what_differs(fast: Path) -> None:
    gb.sweep(fast, OVER, MEASURE, **STATIC, store="there")
    with pytest.raises(InputError, match="its measures differs"):
        gb.sweep(fast, OVER, ["flight.tip.x"], **STATIC, store="there", resume=True)
    with pytest.raises(InputError, match="its values and cases differ"):
        gb.sweep(fast, ["motion.flight.acceleration.z.level=2 g:8 g:20"], MEASURE, **STATIC, store="there", resume=True)
    Path("there/cases.jsonl").write_text("something else\n", encoding="utf-8")
    with pytest.raises(InputError, match="not the store of a sweep"):
        gb.sweep(fast, OVER, MEASURE, **STATIC, store="there", resume=True)


def test_a_store_that_is_being_written_is_refused(fast: Path) -> None:
    Path("there").mkdir()
    lock = Path("there/cases.lock")
    lock.write_text(str(os.getppid()), encoding="utf-8")  # a process that runs
    with pytest.raises(InputError, match="being written by another sweep"):
        gb.sweep(fast, OVER, MEASURE, **STATIC, store="there")
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    lock.write_text(str(ended.pid), encoding="utf-8")
    gb.sweep(fast, OVER, MEASURE, **STATIC, store="there")
    assert not lock.exists()
