"""Files that end, block or fill the libraries that read them are refused, and the process that asked goes on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import processes as module
from gbeam.guards import read_confined

from ..calling import Answer, gbeam, spent
from ..scenarios import FLIGHT, SPECIMEN, model
from .damaged import RECORD, TIME, crashing_mat, endless_hdf5, large_mat

__all__ = ["gbeam"]

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="signals and limits of processes are POSIX's")
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="other systems limit no address space")
Call = Callable[..., Answer]


def _scenario(folder: Path, file: str) -> Path:
    acceleration = FLIGHT.splitlines()[-1]
    path = folder / "s.toml"
    text = SPECIMEN + model("FOAM", 0, 0, 1) + FLIGHT.replace(acceleration, RECORD.replace("FILE", file))
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the project's folder, where this file's readers are: none is imported from the current one."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Readers have a second of processor time."""
    monkeypatch.setattr(module, "READER_SECONDS", 1)
    monkeypatch.setattr(module, "_PATIENCE", 60)  # a busy machine is no error


@POSIX
def test_a_file_that_ends_its_library_is_refused_at_its_place(tmp_path: Path, gbeam: Call) -> None:
    crashing_mat(tmp_path / "r.mat")
    answer = gbeam("check", _scenario(tmp_path, "r.mat"), "--json")
    assert answer.status == 2
    (error,) = answer.json["error"]
    assert error["path"] == "motion.flight.record.file" and "SIGSEGV" in error["message"]


@POSIX
def test_a_file_that_is_read_for_ever_is_refused(tmp_path: Path, gbeam: Call, hurried: None) -> None:
    endless_hdf5(tmp_path / "r.nc")
    begun = spent()
    answer = gbeam("check", _scenario(tmp_path, "r.nc"))
    assert answer.status == 2 and "more than 1 s of processor time to read" in answer.err
    for verb in ("report", "rerun"):
        answer = gbeam(verb, tmp_path / "r.nc")
        assert answer.status == 2 and "r.nc takes more than 1 s of processor time to read" in answer.err
    assert 2.5 < spent() - begun < 30  # three times one second, which the kernel counts in hundredths
    begun = spent()
    assert gbeam("check", _scenario(tmp_path, "r.nc")).status == 2  # which is known by now
    assert spent() == begun


@POSIX
def test_a_reader_that_waits_for_ever_is_ended_by_the_clock(
    tmp_path: Path, hurried: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_PATIENCE", 2)
    with pytest.raises(gb.InputError, match=r"is not read within 2 s"):
        read_confined(_wait, tmp_path, refuse=lambda problem: gb.InputError("x", problem, "y"))


@LINUX
def test_only_the_variables_that_are_needed_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "READER_BYTES", 600 * 2**20)
    large_mat(tmp_path / "r.mat")
    columns = {"x": "0", "y": "0", "unit": "g"}
    flown = gb.read_record(tmp_path / "r.mat", time="t", z="az", **columns)
    np.testing.assert_array_equal(flown.times, TIME)
    with pytest.raises(gb.InputError, match=r"record.file .*r.mat takes more than 6.. MB of memory to read"):
        gb.read_record(tmp_path / "r.mat", time="rec.t", z="az", **columns)


@POSIX
def test_the_app_shows_what_a_damaged_record_does_and_goes_on(tmp_path: Path, hurried: None) -> None:
    pytest.importorskip("fastapi")
    from gbeam.app import described, head

    crashing_mat(tmp_path / "r.mat")
    endless_hdf5(tmp_path / "r.nc")
    for name in ("r.mat", "r.nc"):
        with pytest.raises(gb.InputError):
            head(tmp_path / name)
        text = _scenario(tmp_path, name).read_text(encoding="utf-8")
        (problem,) = described(text, tmp_path)["errors"]
        assert problem["path"] == "motion.flight.record.file" and problem["line"]


def test_the_server_of_the_app_opens_no_such_file_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fastapi")
    import h5py
    import scipy.io

    from gbeam.app import SAMPLES, head, load_curves
    from gbeam.io import read_stored

    acceleration = FLIGHT.splitlines()[-1]
    values = {"t": TIME, "az": np.ones(len(TIME))}
    scipy.io.savemat(tmp_path / "r.mat", values)
    with h5py.File(tmp_path / "r.h5", "w") as file:
        for name, each in values.items():
            file[name] = each

    def opened(*_: Any, **__: Any) -> None:
        raise AssertionError("opened in the process of the server")

    for module_, name in ((h5py, "File"), (scipy.io, "loadmat"), (scipy.io, "whosmat"), (scipy.io, "netcdf_file")):
        monkeypatch.setattr(module_, name, opened)
    for name in ("r.mat", "r.h5"):
        assert set(head(tmp_path / name)["columns"]) == {"t", "az"}
        text = SPECIMEN + model("FOAM", 0, 0, 1) + FLIGHT.replace(acceleration, RECORD.replace("FILE", name))
        assert len(load_curves(text, tmp_path)["time"]) == SAMPLES
    assert set(read_stored(tmp_path / "r.h5").variables) == {"t", "az"}  # as of a run's histories


@LINUX
def test_a_reader_ends_with_the_process_that_asked(tmp_path: Path) -> None:
    endless_hdf5(tmp_path / "r.nc")
    asked = subprocess.Popen(
        [sys.executable, "-m", "gbeam", "report", "r.nc"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    try:
        while not (children := _children(asked.pid)):
            time.sleep(0.02)
        time.sleep(0.5)  # it has begun to read
        asked.send_signal(signal.SIGTERM)
        assert asked.communicate(timeout=10) == (None, "gbeam: terminated\n") and asked.returncode == 143
    finally:
        asked.kill()
    late = time.monotonic() + 10  # a busy machine is no error
    while any(_runs(child) for child in children) and time.monotonic() < late:
        time.sleep(0.02)
    assert not any(_runs(child) for child in children)


def test_answers_come_as_they_were_returned(tmp_path: Path) -> None:
    answer = read_confined(_answer, tmp_path, 3, refuse=lambda problem: gb.InputError("x", problem, "y"))
    assert answer["text"] == "µ\ud800" and answer["nothing"] is None and answer["path"] == os.fspath(tmp_path)
    assert answer["texts"].tolist() == [["a", ""], ["b", "c"]] and answer["texts"].dtype == object
    for name, dtype in (("numbers", "<f8"), ("bytes", "|S2"), ("scalar", "<i4"), ("big", ">f4")):
        assert answer[name].dtype.str == dtype
        np.testing.assert_array_equal(answer[name], _answer("", 3)[name])


def test_what_a_reader_says_is_said_again(tmp_path: Path) -> None:
    def refuse(problem: str) -> gb.InputError:
        return gb.InputError("x", problem, "y")

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with pytest.raises(gb.InputError) as refused:
            read_confined(_refuse, tmp_path, refuse=refuse)
    assert [str(each.message) for each in said] == ["twice"]
    assert (refused.value.where, refused.value.problem, refused.value.fix) == ("here", "is wrong", "mend it")
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        read_confined(_fail, tmp_path, refuse=refuse)


@LINUX
def test_a_reader_that_cannot_start_is_no_fault_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_START", "raise SystemExit(1)")
    with pytest.raises(gb.ComputationError, match="is there no memory for it"):
        read_confined(_answer, tmp_path, 3, refuse=lambda problem: gb.InputError("x", problem, "y"))


def _wait(path: str) -> None:
    time.sleep(60)


def _answer(path: str, number: int) -> dict[str, Any]:
    print("no part of the answer")
    return {
        "path": path,
        "text": "µ\ud800",
        "nothing": None,
        "texts": np.array([["a", ""], ["b", "c"]], dtype=object),
        "numbers": np.arange(6.0).reshape(number, 2),
        "bytes": np.array([b"ab", b"c"]),
        "scalar": np.int32(-7),
        "big": np.array([1.5], dtype=">f4"),
    }


def _refuse(path: str) -> None:
    warnings.warn("twice", stacklevel=1)
    raise gb.InputError("here", "is wrong", "mend it")


def _fail(path: str) -> float:
    return 1 / 0


def _runs(process: int) -> bool:
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except OSError:
        return False


def _children(process: int) -> list[int]:
    try:
        text = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="utf-8")
    except OSError:
        return []
    return [int(each) for each in text.split()]
