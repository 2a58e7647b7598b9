"""Streams that are closed or full, defects, and text from outside that a terminal would obey."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from gbeam.cli import arguments as arguments_of
from gbeam.cli import report_defect, shorten_warnings, verbs
from gbeam.guards import SCENARIO_BYTES
from gbeam.progress import INTERVAL
from gbeam.scenario import standard_input

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


@pytest.mark.skipif(os.name != "posix", reason="needs a pipe without a reader")
def test_files_are_written_whatever_becomes_of_the_output(hub: Path, tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    # Unbuffered, as what is longer than the buffer: the first line fails before anything is written.
    command = [sys.executable, "-u", "-m", "gbeam", "modes", hub.name, "--out", "d", "--report"]
    done = subprocess.run(command, stdout=writer, stderr=writer, cwd=tmp_path, check=False, timeout=60)
    os.close(writer)
    assert done.returncode == 0
    assert {"modes.json", "modes.html"} <= {file.name for file in (tmp_path / "d").iterdir()}


@pytest.fixture
def piped(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """Give standard input a text, which is read once a process."""

    def give(text: str) -> None:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text.encode()), encoding="utf-8"))
        standard_input.cache_clear()

    yield give
    standard_input.cache_clear()


def test_a_scenario_from_standard_input_is_the_files(
    gbeam: Call, hub: Path, tmp_path: Path, piped: Callable[[str], None]
) -> None:
    piped(hub.read_text(encoding="utf-8"))
    answer = gbeam("modes", "-", "--report")
    assert answer.status == 0 and answer.out == gbeam("modes", hub).out
    file = tmp_path / "out" / "stdin" / "modes.json"
    assert json.loads(file.read_text(encoding="utf-8"))["provenance"]["command"] == "gbeam modes - --report"
    piped("")
    assert gbeam("rerun", file).status == 0  # reads no standard input


# Arguments of every verb that takes a scenario, besides that.
NEEDED = {"fit": ["--data", "data.csv"], "optimize": ["--minimise", "tip.z.max_abs"]}
OF_SCENARIOS = [verb for verb in verbs() if any(each.name == "SCENARIO" for each in arguments_of(verb))]


@pytest.mark.parametrize("verb", OF_SCENARIOS)
def test_every_verb_reads_standard_input_and_names_it(
    gbeam: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, piped: Callable[[str], None], verb: str
) -> None:
    monkeypatch.chdir(tmp_path)
    piped("[beam]\nlenth = 1\n")
    answer = gbeam(verb, "-", *NEEDED.get(verb, []))
    assert answer.status == 2 and "<stdin>:2:1: beam.lenth: unknown key\n    2 | lenth = 1\n" in answer.err


def test_files_named_on_standard_input_are_relative_to_the_current_folder(
    gbeam: Call, fast: Path, piped: Callable[[str], None]
) -> None:
    rows = "".join(f"{i / 100},{1 + (i % 50) / 50}\n" for i in range(101))
    (fast.parent / "record.csv").write_text(f"time,z\n{rows}")
    flight, *_ = fast.read_text(encoding="utf-8").partition("[motion.spin]")
    constant = 'acceleration = { z = { profile = "constant", level = "6 g" } }'
    record = 'record = { file = "FILE", time = "time", x = "0", y = "0", z = "z", unit = "g" }'
    for file, status in (("record.csv", 0), ("none.csv", 2)):
        piped(f'{flight.replace(constant, record.replace("FILE", file))}[response]\nstep = "1 ms"\n')
        answer = gbeam("check", "-")
        assert answer.status == status, answer.err
        assert status == 0 or ("<stdin>:" in answer.err and "none.csv" in answer.err)


def test_nothing_is_written_back_into_standard_input(gbeam: Call, fast: Path, piped: Callable[[str], None]) -> None:
    piped(fast.read_text(encoding="utf-8"))
    answer = gbeam("place", "-", "--write")
    assert answer.status == 2 and "--write has no file to write into" in answer.err and "name its file" in answer.err


def test_more_than_a_scenario_has_is_not_read_from_standard_input(gbeam: Call, piped: Callable[[str], None]) -> None:
    piped("#" * (SCENARIO_BYTES + 5))
    answer = gbeam("check", "-")
    assert answer.status == 2 and answer.err.startswith("<stdin>: has more than 1.05 MB\n")


def test_a_defect_is_named_with_its_traceback_in_a_file(
    gbeam: Call, fast: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise KeyError(f"no{ESCAPE}such")

    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("gbeam.analysis.describe.describe", fail)
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

    monkeypatch.setattr("gbeam.analysis.describe.describe", fail)
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
