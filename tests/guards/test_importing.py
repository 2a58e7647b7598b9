"""Files in the current folder, beside a scenario or uploaded, named as modules of Python are: none is ever imported."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Set
from importlib.metadata import packages_distributions
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from gbeam.guards import HOME, path_of_children, path_without

from ..scenarios import FLIGHT, SPECIMEN, model
from .damaged import RECORD, TIME

# All that an import may look for, and what Python itself looks for as it starts.
EVERY = {*sys.stdlib_module_names, *packages_distributions(), "gbeam", "sitecustomize", "usercustomize"}
FLOWN = FLIGHT.replace(FLIGHT.splitlines()[-1], RECORD.replace("FILE", "r.mat").replace(" }", ', to = "0.5 s" }'))
SCENARIO = SPECIMEN + model("FOAM", 0, 0, 1) + FLOWN + "[response]\n"
SWEEP = "sweep s.toml --verb static --over beam.length=0.25m:0.3m:6 --measure flight.tip.z --workers 2 --out swept"
# As pip writes the command; of command lines, one after the other.
INSTALLED = """
import sys
from gbeam.cli import main
for words in sys.argv[1].split("; "):
    sys.argv[1:] = words.split()
    if status := main():
        sys.exit(f"{words}: exit status {status}")
"""


def trap(folder: Path, names: Iterable[str] = EVERY) -> None:
    """Write modules that leave a file when they are imported, and a scenario whose record a reader has to open."""
    for name in names:
        code = f"open({str(folder / name)!r} + '.ran', 'w').close()\n"
        (folder / f"{name}.py").write_text(code, encoding="utf-8")
    scipy.io.savemat(folder / "r.mat", {"t": TIME, "az": np.ones(len(TIME))})
    (folder / "s.toml").write_text(SCENARIO, encoding="utf-8")


def sprung(folder: Path) -> list[str]:
    """Names of the modules that were imported."""
    return sorted(each.stem for each in folder.rglob("*.ran"))


def called(folder: Path, *words: object, **more: str) -> subprocess.CompletedProcess[str]:
    """A process of Python in a folder."""
    return subprocess.run(
        [sys.executable, *map(str, words)], cwd=folder, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"} | more,
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


@pytest.fixture
def command(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The installed command, in a folder of its own."""
    file = tmp_path_factory.mktemp("bin") / "gbeam"
    file.write_text(INSTALLED, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def before() -> Set[str]:
    """Names of the modules that Python imports, or tries to, for ``-m`` and to find gbeam, from wherever they are."""
    code = "import runpy, sys, gbeam, gbeam.cli; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    return {"gbeam", "sitecustomize", "usercustomize", "nt", "_winapi", *loaded}


def test_the_command_imports_nothing_of_the_folder_that_it_is_called_in(tmp_path: Path, command: Path) -> None:
    """A sweep ran random.py, queue.py, signal.py, inspect.py and numpy.py, or ended as a defect by an honest one."""
    trap(tmp_path)
    calls = "check s.toml; run s.toml --out out --report; report out/result.nc; rerun out/result.nc"
    done = called(tmp_path, command, f"{calls}; {SWEEP}")
    assert (done.returncode, sprung(tmp_path)) == (0, []), done.stderr
    done = called(tmp_path, "-P", "-m", "gbeam", "check", "s.toml")
    assert (done.returncode, sprung(tmp_path)) == (0, []), done.stderr


def test_what_python_does_not_take_from_there_itself_is_not(tmp_path: Path, command: Path, before: Set[str]) -> None:
    """The current folder is on the path by ``-m``, and by an empty entry of PYTHONPATH."""
    trap(tmp_path, EVERY - before)
    done = called(tmp_path, "-m", "gbeam", *SWEEP.split())
    assert (done.returncode, sprung(tmp_path)) == (0, []), done.stderr
    done = called(tmp_path, command, "check s.toml", PYTHONPATH=os.pathsep.join(["", HOME]))
    assert (done.returncode, sprung(tmp_path)) == (0, []), done.stderr


def test_settings_of_plots_are_not_those_of_the_current_folder(tmp_path: Path) -> None:
    """They have Matplotlib run LaTeX, and up to version 3.10.8 code."""
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\n", encoding="utf-8")
    code = "from gbeam.cli import main; main(); from matplotlib import rcParams; print(rcParams['text.usetex'])"
    done = called(tmp_path, "-c", code, "--version")
    assert done.stdout.splitlines()[1:] == ["False"], done.stderr


def test_the_path_has_no_folder_of_the_user_but_gbeams_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folders = [tmp_path / name for name in ("current", "script", "libraries", "also")]
    for folder in folders[:3]:
        folder.mkdir()
    current, script, libraries, also = map(str, folders)
    folders[3].symlink_to(current)
    monkeypatch.chdir(current)
    monkeypatch.setattr(sys.modules["__main__"], "__file__", f"{script}/s.py", raising=False)
    monkeypatch.setattr(sys, "path", ["", ".", "../script", current, script, HOME, libraries, also, f"{current}/gone"])
    assert path_without(".") == [script, HOME, libraries, f"{current}/gone"]
    assert path_of_children() == [HOME, libraries, f"{current}/gone"]
    monkeypatch.chdir(HOME)  # as of the source
    assert path_without(".") == [current, script, HOME, libraries, also, f"{current}/gone"]


def test_workers_are_not_started_where_python_would_not_keep_the_folder_off(tmp_path: Path) -> None:
    trap(tmp_path, ["random", "queue"])
    (tmp_path / "elsewhere").mkdir()
    code = "from gbeam.studies import Workers\nWorkers(2, ())"
    (tmp_path / "elsewhere" / "s.py").write_text(code, encoding="utf-8")
    done = called(tmp_path, "-E", "elsewhere/s.py")
    assert "--workers would import from the current folder: Python runs with -E" in done.stderr
    assert not sprung(tmp_path)
