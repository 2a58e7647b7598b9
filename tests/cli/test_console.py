"""Progress on stderr."""

from __future__ import annotations

import inspect
import io
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import gbeam as gb
from gbeam import progress
from gbeam.cli import Watch
from gbeam.cli import process as console
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


QUICK = ["response.duration=2 s", "response.residual_from=1 s", "response.step=20 ms", "response.estimate=false"]


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


LONG = {
    "buckling_acceleration", "campbell", "compare_models", "critical_load", "critical_speed", "critical_speed_map",
    "equilibrium_path", "fit", "linearize", "modes", "optimise", "place", "plan", "rerun", "sensitivity",
    "shape_command", "shape_hub_command", "simulate", "simulate_batch", "static", "study", "sweep",
}  # fmt: skip


def test_whatever_may_take_long_tells_how_far_it_is(tmp_path: Path) -> None:
    public = {name: getattr(gb, name) for name in gb.__all__ if inspect.isfunction(getattr(gb, name))}
    assert {name for name, each in public.items() if "progress" in inspect.signature(each).parameters} == LONG
    strip = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    specimen, flight, hub = gb.assemble(strip, "FOAM", z=2), gb.Flight(z=20.0), gb.Hub(radius=0.5)
    machine = gb.Centrifuge(flight, arm=3.3, control_point=0.2, gravity=False, span=(0.0, 0.6))
    settings = gb.ResponseSettings(duration=0.6, step=0.002, estimate=False)
    gb.study(gb.read_scenario("examples/hubbeam2009_slew_2p8.toml", QUICK)).save(tmp_path / "result.nc")
    for ask in (
        lambda tell: gb.static(specimen, flight, progress=tell),
        lambda tell: gb.modes(specimen, hub, progress=tell),
        lambda tell: gb.equilibrium_path(specimen, flight, vary="motion", progress=tell),
        lambda tell: gb.linearize(specimen, hub, progress=tell),
        lambda tell: gb.plan("", machine, progress=tell),
        lambda tell: gb.place(
            specimen, flight, gb.choice_of(machine, limited=False), settings, {"tip": 1.0}, current=machine, check=True,
            progress=tell,
        ),
        lambda tell: list(gb.simulate_batch([(specimen, flight)] * 2, settings, together=2, progress=tell)),
        lambda tell: gb.rerun(tmp_path / "result.nc", progress=tell),
    ):  # fmt: skip
        said: list[tuple[str, float]] = []
        ask(lambda *news, said=said: said.append(news))
        assert len(said) > 1 and all(what and 0 <= share <= 1 for what, share in said)
    assert said[-1][0].startswith("slew: ")


def test_a_batch_shows_its_bar_until_the_last_response(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is an iterator: the bar was gone before the first case was begun."""
    lines: list[str] = []
    monkeypatch.setattr(progress.Bar, "_show", lambda self: self._over.wait(60) and lines.append(self.line()))
    turn = gb.Flight(z=gb.trapezoid(5.0, jerk=20.0, hold=0.1))
    cases = [(laden("FOAM"), turn)] * 2
    settings = gb.ResponseSettings(duration=0.6, step=0.01, estimate=False)
    for _ in gb.simulate_batch(cases, settings, together=2, progress=True):
        assert not lines
    assert lines == ["2 of 2 cases: 100%"]


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
