"""Files of a run: whole or not at all, with a full disk, a dead run's remains, and two runs at once."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import gbeam as gb
from gbeam.cli import publish

Call = Callable[..., Any]


def _make(text: str) -> Callable[[Path], object]:
    def make(hidden: Path) -> None:
        for name in ("a.txt", "b.txt"):
            (hidden / name).write_text(text)

    return make


def test_a_new_folder_appears_whole_and_readable(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "out"
    assert [file.name for file in publish(folder, _make("x"))] == ["a.txt", "b.txt"]
    assert [file.name for file in folder.parent.iterdir()] == ["out"]
    assert folder.stat().st_mode & 0o777 == tmp_path.stat().st_mode & 0o777 | 0o755


def test_another_run_that_made_the_folder_meanwhile(tmp_path: Path) -> None:
    def make(hidden: Path) -> None:
        _make("first")(hidden)
        publish(tmp_path / "out", _make("second"))

    publish(tmp_path / "out", make)
    assert {file.name: file.read_text() for file in (tmp_path / "out").iterdir()} == dict.fromkeys(
        ("a.txt", "b.txt"), "first"
    )


def test_a_full_disk_keeps_what_was_there_and_puts_the_files_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, elsewhere = tmp_path / "out", tmp_path / "tmp"
    elsewhere.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(elsewhere))
    publish(out, _make("old"))

    def make(hidden: Path) -> None:
        (hidden / "a.txt").write_text("new")
        if hidden.parent == out:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        (hidden / "b.txt").write_text("new")

    with pytest.raises(gb.ComputationError, match="No space left on device, and are in") as caught:
        publish(out, make)
    assert caught.value.outcome == "not written"
    assert {file.read_text() for file in out.iterdir()} == {"old"} and len(list(out.iterdir())) == 2
    (refuge,) = elsewhere.iterdir()
    assert {file.read_text() for file in refuge.iterdir()} == {"new"} and str(refuge) in str(caught.value)


@pytest.mark.skipif(os.name != "posix", reason="asks whether a process runs")
def test_what_killed_runs_left_is_removed(tmp_path: Path) -> None:
    def killed(hidden: Path) -> None:
        code = "import os, sys; from pathlib import Path; from gbeam.cli import publish;"
        code += "publish(Path(sys.argv[1]), lambda hidden: os.kill(os.getpid(), 9))"
        assert subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False).returncode == -9
        assert len(list(tmp_path.glob(".gbeam-*"))) == 2
        _make("x")(hidden)

    publish(tmp_path, killed)
    (left,) = tmp_path.glob(".gbeam-*")
    publish(tmp_path, _make("y"))
    assert not left.exists()
    other = tmp_path / ".gbeam-othercomputer-1-abc"
    other.mkdir()
    publish(tmp_path, _make("z"))
    assert other.exists()
    os.utime(other, (time.time() - 7200,) * 2)
    publish(tmp_path, _make("z"))
    assert {file.name for file in tmp_path.iterdir()} == {"a.txt", "b.txt"}


@pytest.mark.skipif(sys.platform != "linux", reason="limits the size of a file")
@pytest.mark.parametrize("most", [0, pytest.param(1000, marks=pytest.mark.thorough), 20_000])
def test_a_full_disk_under_a_run(most: int, fast: Path, gbeam: Call) -> None:
    """The numbers are printed, and the exit status says that there are no files; HDF5 ended the process."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        answer = gbeam("run", fast, "--out", "full")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert answer.status == 1 and "No limits set: largest load" in answer.out and "files in" not in answer.out
    assert answer.err.startswith("gbeam: not written: the files could not be written to full: File too large, nor to ")
    assert [file.name for file in Path().iterdir()] == ["fast.toml"]
