"""Cases computed in other processes: the same bytes as in this one, and workers that die."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb

OVER = {"motion.flight.acceleration.z.level": "2 g:8 g:12"}
# Kills its process in one case: the first time only, or always.
MEASURES = """
import os, signal
from pathlib import Path

def once(case):
    if abs(case.beam.length - 0.25) < 1e-9 and not Path("died").exists():
        Path("died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return case.beam.length

def always(case):
    with open("processes", "a") as file:
        print(os.getpid(), file=file)
    if abs(case.beam.length - 0.25) < 1e-9:
        os.kill(os.getpid(), signal.SIGKILL)
    return case.beam.length
"""
SCRIPT = """
import gbeam as gb
def length(case): return case.beam.length
def main(measure):
    try:
        print(gb.sweep("fast.toml", {"beam.length": "0.2 m:0.3 m:40"}, measure, verb="static", workers=2).counts)
    except gb.InputError as error:
        print(error)
"""
BLOCK = """if __name__ == "__main__":
    def local(case): return 1.0
    """


def test_two_processes_give_the_same_bytes(fast: Path) -> None:
    one = gb.sweep(fast, OVER, ["flight.tip.z"], verb="static")
    two = gb.sweep(fast, OVER, ["flight.tip.z"], verb="static", workers=2)
    assert one.measures["flight.tip.z"].tobytes() == two.measures["flight.tip.z"].tobytes()


def test_a_function_that_no_other_process_knows_is_refused(fast: Path) -> None:
    with pytest.raises(gb.InputError, match="cannot be sent to another process"):
        gb.sweep(fast, OVER, {"length": lambda case: case.beam.length}, workers=2)


@pytest.mark.parametrize(
    ("last", "file", "said"),
    [
        # Of a notebook, or typed in: the processes have no such main program.
        ('main({"length": length})', False, "cannot load (Can't get attribute 'length' on <module '__main__'"),
        (f'{BLOCK}main({{"local": local}})', True, "cannot load (Can't get attribute 'local' on <module '__mp_main__'"),
        ('main({"length": length})', True, 'put what your script does under if __name__ == "__main__":'),
        (f'{BLOCK}main({{"length": length}})', True, "{'done': 40}"),
        ('main(["flight.tip.z"])', True, "{'done': 40}"),  # the processes have no need to run the script again
        ('main(["flight.tip.z"])', False, "{'done': 40}"),
    ],
)
def test_functions_of_the_main_program_are_loaded_or_refused_at_once(
    fast: Path, last: str, file: bool, said: str
) -> None:
    """They ended one process after the other, 609 in 8 minutes, and no case had a figure."""
    Path("script.py").write_text(f"{SCRIPT}{last}\n", encoding="utf-8")
    command = [sys.executable, *(["script.py"] if file else ["-"])]
    done = subprocess.run(command, input=f"{SCRIPT}{last}\n", capture_output=True, text=True, timeout=120)
    assert said in done.stdout and done.stdout.count("\n") == 1, done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_a_worker_that_is_killed_loses_no_case(fast: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("deadly.py").write_text(MEASURES, encoding="utf-8")
    monkeypatch.syspath_prepend(str(fast.parent))
    import deadly  # type: ignore[import-not-found]

    over = {"beam.length": "0.2 m:0.3 m:5"}
    swept = gb.sweep(fast, over, {"once": deadly.once, "always": deadly.always}, workers=2, store="there")
    assert swept.outcome.tolist() == ["done", "done", "failed", "done", "done"]
    assert swept.message[2] == "the process that computed it died"
    swept = gb.sweep(fast, over, {"once": deadly.once}, workers=2)
    assert np.array_equal(swept.measures["once"], np.linspace(0.2, 0.3, 5)) and swept.counts == {"done": 5}


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_a_worker_that_dies_takes_no_other_along(fast: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The batch of a case that ends its process is halved; a process was begun for each case of several batches."""
    Path("deadly.py").write_text(MEASURES, encoding="utf-8")
    monkeypatch.syspath_prepend(str(fast.parent))
    monkeypatch.delitem(sys.modules, "deadly", raising=False)
    import deadly

    swept = gb.sweep(fast, {"beam.length": "0.2 m:0.3 m:301"}, {"always": deadly.always}, workers=2)
    assert swept.counts == {"done": 300, "failed": 1} and swept.outcome[150] == "failed"
    computed = Path("processes").read_text(encoding="utf-8").split()
    assert len(set(computed)) <= 14 and len(computed) < 450  # there were hundreds


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_workers_end_with_a_driver_that_is_killed(fast: Path) -> None:
    words = ["--over", "motion.spin.arm=1:12:5000", "--measure", "flight.tip.z.max_abs", "--workers", "2"]
    command = [sys.executable, "-m", "gbeam", "sweep", str(fast), *words, "--out", "there"]
    driver = subprocess.Popen(command, stderr=subprocess.DEVNULL, start_new_session=True)
    journal, end = Path("there/cases.jsonl"), time.monotonic() + 60
    while not (journal.exists() and journal.read_bytes().count(b"\n") > 5) and time.monotonic() < end:
        time.sleep(0.1)
    os.killpg(driver.pid, 0)
    driver.send_signal(signal.SIGKILL)
    driver.wait()
    end = time.monotonic() + 30
    while time.monotonic() < end:
        try:
            os.killpg(driver.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.killpg(driver.pid, signal.SIGKILL)
    pytest.fail("processes of the sweep are left")
