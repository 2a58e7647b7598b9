"""One case in a process of its own: with limits on time and memory, and what it gave."""

from __future__ import annotations

import gc
import os
import resource
import signal
import sys
import tempfile
import time
import warnings
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any

from fuzz.cases import ROOT, Case

SECONDS = 10  # of processor time
PATIENCE = 60  # s: a machine that does other things as well
MEMORY = 2 * 2**30


@dataclass(frozen=True)
class Answer:
    """Answer to a case: exit status (negative: the signal that ended it), streams, seconds, bytes, files made."""

    status: int
    out: str
    err: str
    seconds: float
    memory: int
    files: tuple[str, ...]
    traceback: str


def warm_up() -> None:
    """Import what most cases need, once: a fork has it."""
    for name in ("h5py", "scipy.interpolate", "scipy.io"):
        import_module(name)
    from fuzz.results import ANSWERS, written
    from gbeam.cli import main

    scenario = str(ROOT / "examples" / "hubbeam2009_slew_3.toml")
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        for verb in (*ANSWERS, "run"):
            written(verb)
        main(["check", scenario, "--json"])
        for words in ([], ["--set", "beam.length=x"], ["--set", "beam.length=99 inch"]):
            for verb in ("check", "static", "modes", "campbell", "critical-speed", "linearize"):
                main([verb, scenario, *words])
    gc.freeze()  # forks do not copy what is never collected
    assert "jax" not in sys.modules, "a process that JAX has threads in cannot be forked"


def call(case: Case, folder: Path, seconds: int = SECONDS, patience: int = PATIENCE, memory: int = MEMORY) -> Answer:
    """Run a case in an empty folder, within so much processor time, time and memory."""
    for name, data in case.files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    before = set(folder.rglob("*"))
    with tempfile.TemporaryDirectory() as aside:
        out, err = Path(aside, "out"), Path(aside, "err")
        start = time.monotonic()
        child = os.fork()
        if child == 0:
            _child(case.arguments, folder, aside, out, err, (seconds, patience, memory))
        _, status, usage = os.wait4(child, 0)
        files = tuple(sorted(str(each.relative_to(folder)) for each in set(folder.rglob("*")) - before))
        defects = [each.read_text() for each in Path(aside).glob("gbeam-defect-*")]
        return Answer(
            os.waitstatus_to_exitcode(status), _text(out), _text(err),
            time.monotonic() - start, 1024 * usage.ru_maxrss, files, "\n".join(defects),
        )  # fmt: skip


def _child(arguments: list[str], folder: Path, aside: str, out: Path, err: Path, limits: tuple[int, int, int]) -> None:
    """Become the command line; never returns."""
    seconds, patience, memory = limits
    status = 70
    try:
        os.chdir(folder)
        tempfile.tempdir = aside
        for number, file in ((1, out), (2, err)):
            os.dup2(os.open(file, os.O_CREAT | os.O_WRONLY), number)
        sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
        sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.alarm(patience)
        _show_words_on_files()
        if arguments[:1] == ["app"]:
            from fuzz.app import play as main
        else:
            from gbeam.cli import main

        status = main(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
    except SystemExit as error:
        status = error.code if isinstance(error.code, int) else 71
    except BaseException:
        import traceback

        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _show_words_on_files() -> None:
    """Print what a library says of a file as the program does; another warning keeps its place in the source."""
    from gbeam.cli import shorten_warnings

    as_python = warnings.showwarning
    shorten_warnings()
    on_a_line = warnings.showwarning

    def show(message: Any, category: type[Warning], *place: Any) -> None:
        (on_a_line if category is UserWarning else as_python)(message, category, *place)

    warnings.showwarning = show


def _text(file: Path) -> str:
    return file.read_bytes().decode("utf-8", "replace") if file.exists() else ""
