"""Streams that are closed or full, defects, and text from outside that a terminal would obey."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from gbeam.cli.process import shorten_warnings
from gbeam.cli.program import report_defect
from gbeam.progress import INTERVAL

Call = Callable[..., Any]
ESCAPE = "\x1b[31m"


def _closed(number: int, *arguments: object) -> subprocess.CompletedProcess[str]:
    """The command line in a process of its own, with one stream closed."""
    command = ["sh", "-c", f'exec "$0" "$@" {number}>&-', sys.executable, "-m", "gbeam", *map(str, arguments)]
    unhurried = os.environ | {INTERVAL: "100000"}  # of progress, which a busy machine shows
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60, env=unhurried)


@pytest.mark.skipif(os.name != "posix", reason="needs a shell")
def test_closed_streams(fast: Path) -> None:
    without_output = _closed(1, "check", fast, "--json")
    assert (without_output.returncode, without_output.stdout) == (1, "")
    assert without_output.stderr == "gbeam: standard output is closed: the answer could not be printed\n"
    without_errors = _closed(2, "check", fast, "--set", "beam.length=x", "--json")
    assert without_errors.returncode == 2 and without_errors.stdout.startswith("{\n")


def test_a_defect_is_named_with_its_traceback_in_a_file(
    gbeam: Call, fast: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise KeyError(f"no{ESCAPE}such")

    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("gbeam.analysis.case.describe", fail)
    answer = gbeam("check", fast, "--json")
    assert answer.status == 3 and answer.json["outcome"] == "defect"
    assert "gbeam: defect: KeyError: " in answer.err and "issue" in answer.err and "\x1b" not in answer.err
    traceback = Path(answer.json["traceback"]).read_text(encoding="utf-8")
    assert str(traceback).startswith("gbeam 0.") and f"gbeam check {fast}" in traceback and "KeyError" in traceback


def test_a_defect_whose_file_cannot_be_written_is_printed(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "none"))
    assert report_defect(ValueError("x"), ["check"], as_json=False) == 3
    assert "ValueError: x\n" in capsys.readouterr().err


def test_too_little_memory_is_an_outcome(gbeam: Call, fast: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise MemoryError("Unable to allocate 3 TiB")

    monkeypatch.setattr("gbeam.analysis.case.describe", fail)
    answer = gbeam("check", fast, "--json")
    assert answer.status == 1 and answer.json["outcome"] == "out of memory"
    assert answer.err == "gbeam: out of memory: the computation needs more than there is (Unable to allocate 3 TiB)\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", f"{ESCAPE}.toml"],
        ["check", "fast.toml", "--set", f"beam.{ESCAPE}=1"],
        ["check", "fast.toml", "--set", f"beam.length=1 {ESCAPE}"],
        ["check", "fast.toml", "--set", f'title="a{ESCAPE}\x9b"'],
        ["check", "fast.toml", "--out", f"fast.toml/{ESCAPE}"],
        ["modes", "fast.toml", "--motion", ESCAPE],
        [f"{ESCAPE}"],
    ],
    ids=repr,
)
def test_a_terminal_obeys_nothing_from_outside(gbeam: Call, fast: Path, arguments: list[str]) -> None:
    for words in (arguments, [*arguments, "--json"]):
        answer = gbeam(*words)
        assert answer.status == 2 and answer.err
        assert not {"\x1b", "\x9b"} & set(answer.out + answer.err)


def test_warnings_of_libraries_are_a_line_and_said_once(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("warnings.showwarning", warnings.showwarning)
    shorten_warnings()
    for name in "ab":
        text = f"Error reading persistent compilation cache entry for '{name}': error: Error -3\nwhile"
        warnings.showwarning(UserWarning(text), UserWarning, "", 1)
    said = "the cache of compiled programs cannot be used, they are compiled again: error: Error -3"
    assert capsys.readouterr().err == f"gbeam: warning: {said}\\nwhile\n"
