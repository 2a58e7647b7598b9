"""Progress on stderr."""

from __future__ import annotations

import io
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import gbeam as gb
from gbeam import progress
from gbeam.cli import process as console
from gbeam.cli.process import Watch
from tests.specimens import laden


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(console, "PATIENCE", 0.02)
    monkeypatch.setattr(progress, "EVERY", 0.02)


def test_plain_lines_where_there_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with Watch() as watch:
        time.sleep(0.05)
        watch("flight: run\x1b[31m\n", 0.25)
        time.sleep(0.06)
    lines = sys.stderr.getvalue().splitlines()  # type: ignore[attr-defined]
    assert lines[0] == "gbeam: computing" and lines[-1] == "gbeam: flight: run\\x1b[31m\\n: 25%"
    assert len(lines) >= 3


def test_the_last_line_alone_in_a_file_that_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    monkeypatch.setenv(progress.FILE, str(tmp_path / "progress.txt"))
    for what in ("flight: run", "spin: run"):
        with Watch() as watch:
            watch(what, 0.25)
            time.sleep(0.1)
    assert (tmp_path / "progress.txt").read_text() == "spin: run: 25%\n"
    monkeypatch.setenv(progress.FILE, str(tmp_path / "none" / "progress.txt"))
    with Watch() as watch:
        watch("it goes on", 0.5)
        time.sleep(0.05)
    assert sys.stderr.getvalue() == ""  # type: ignore[attr-defined]


def test_time_left_is_that_of_the_phase(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    watch = Watch()
    watch("a", 0.5)
    now[0] = 40.0
    watch("b", 0.0)
    now[0] = 50.0
    watch("b", 0.25)
    assert watch.line() == "b: 25%, 30 s left"
    watch("b", 0.01)  # the same once more, with a smaller step
    now[0] = 60.0
    watch("b", 0.04)
    assert watch.line() == "b: 4%, 4 min left"


def test_bar_on_a_terminal_leaves_the_cursor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", _Terminal())
    monkeypatch.setenv("TERM", "xterm")
    with Watch() as watch:
        watch("spin: run", 0.5)
        begun = time.monotonic()
        while "50%" not in sys.stderr.getvalue() and time.monotonic() - begun < 20:  # type: ignore[attr-defined]
            time.sleep(0.05)  # a busy machine takes its time to import rich
    shown = sys.stderr.getvalue()  # type: ignore[attr-defined]
    assert "spin: run: 50%" in re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", shown)
    assert shown.rindex("\x1b[?25h") > shown.rindex("\x1b[?25l")


def test_what_is_quick_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(console, "PATIENCE", 60.0)
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    begun = time.monotonic()
    with Watch() as watch:
        watch("flight: run", 0.5)
    assert sys.stderr.getvalue() == "" and time.monotonic() - begun < 5  # type: ignore[attr-defined]


def test_progress_true_shows_a_bar_from_the_first_second(monkeypatch: pytest.MonkeyPatch) -> None:
    specimen, shown = laden("FOAM"), []
    monkeypatch.setattr(sys, "stderr", _Terminal())
    monkeypatch.setattr(progress.Bar, "_draw", lambda self: shown.append(self.line()) or self._over.wait(60))
    turn = gb.Flight(z=gb.trapezoid(5.0, jerk=20.0, hold=0.1))
    run = gb.simulate(specimen, turn, duration=0.6, step=0.01, estimate=False, progress=True)
    assert shown == ["computing"]
    assert run == gb.simulate(specimen, turn, duration=0.6, step=0.01, estimate=False, progress=False)


def test_a_bar_counts_the_cases_of_a_sweep() -> None:
    bar = progress.Bar()
    bar(3, 1, 12)
    assert bar.line().startswith("3 of 12 cases, 1 failed: 25%")


def test_a_bar_within_another_is_a_step_of_that_one(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.Bar("reading", patience=60.0) as outer:
        with progress.Bar("reducing") as inner:
            inner("reducing", 0.5)
            assert outer.line().startswith("reducing: 50%")
        assert outer.line() == "reading"
    assert capsys.readouterr().err == ""


def test_plain_lines_need_no_rich() -> None:
    code = "import sys, time; from gbeam.progress import Bar\nwith Bar(): time.sleep(0.2)\nprint('rich' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (ran.stdout, ran.stderr) == ("False\n", "gbeam: computing\n")
