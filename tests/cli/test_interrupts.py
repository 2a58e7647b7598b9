"""Ctrl-C and a request to terminate: 130 and 143, one line, nothing left behind. fuzz/faults.py has twenty times."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc to see when signals are handled")


def _handles_signals(process: int) -> bool:
    caught = next(
        line
        for line in Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
        if line.startswith("SigCgt:")
    )
    return bool(int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1)


@pytest.mark.parametrize(
    ("number", "delay", "line"),
    [(signal.SIGINT, 0.0, "interrupted"), (signal.SIGTERM, 0.4, "terminated"), (signal.SIGINT, 0.8, "interrupted")],
)
def test_ends_at_once(number: int, delay: float, line: str, fast: Path) -> None:
    # A job in the background ignores SIGINT, which its children inherit: undone before the command starts.
    undo = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"
    command = [sys.executable, "-m", "gbeam", "run", str(fast), "--set", "response.duration=100 s"]
    process = subprocess.Popen(
        [sys.executable, "-c", undo, *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    while not _handles_signals(process.pid):
        time.sleep(0.002)
    time.sleep(delay)
    process.send_signal(number)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (128 + number, "", f"gbeam: {line}\n")
    assert os.listdir() == ["fast.toml"]
