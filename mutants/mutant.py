"""A mutant: one deliberate error in the source, and the tests that have to notice it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "gbeam"
LISTS = sorted(Path(__file__).parent.glob("*.toml"))
TIME_LIMIT = 300  # s
CAUGHT, SURVIVED, BROKEN = "caught", "SURVIVED", "BROKEN"


@dataclass(frozen=True)
class Mutant:
    """A textual replacement in one file.

    Parameters
    ----------
    name : str
        What is wrong.
    file : str
        Under src/gbeam.
    old, new : str
        The text, which stands there exactly once, and what replaces it.
    tests : tuple of str
        What pytest is given: a narrow selection, of which one has to fail.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def mutated(self, text: str) -> str:
        """The file's text with the error in it.

        Raises
        ------
        ValueError
            If the text to replace does not stand there exactly once, or the replacement changes nothing.
        """
        count = text.count(self.old)
        if count != 1 or self.old == self.new:
            raise ValueError(f"{self.name}: {self.old!r} stands {count} times in {self.file}")
        return text.replace(self.old, self.new)


@dataclass(frozen=True)
class Verdict:
    """Verdict on a mutant: its outcome, the first test that failed or why it is broken, and the seconds it took."""

    mutant: Mutant
    outcome: str
    by: str
    seconds: float


def mutants() -> list[Mutant]:
    """Mutants of all lists, in their order."""
    tables = [table for path in LISTS for table in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]]
    return [Mutant(**{**table, "tests": tuple(table["tests"])}) for table in tables]


def judge(mutant: Mutant) -> Verdict:
    """Run the mutant's tests on a copy of the source that has the error."""
    with tempfile.TemporaryDirectory(prefix="gbeam-mutant-") as folder:
        copy = Path(folder) / "gbeam"
        shutil.copytree(SOURCE, copy)  # with its compiled files, so that only one is compiled
        file = copy / mutant.file
        file.write_text(mutant.mutated(file.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
        for stale in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
            stale.unlink()
        start = time.perf_counter()
        try:
            status, output = run_tests(mutant.tests, Path(folder))
        except subprocess.TimeoutExpired:
            return Verdict(mutant, BROKEN, f"no end within {TIME_LIMIT} s", TIME_LIMIT)
        seconds = time.perf_counter() - start
    if status == 1:
        return Verdict(mutant, CAUGHT, first_failure(output), seconds)
    if status == 0:
        return Verdict(mutant, SURVIVED, "", seconds)
    return Verdict(mutant, BROKEN, output[-500:], seconds)  # nothing collected, or not importable


def run_tests(tests: tuple[str, ...], source: Path) -> tuple[int, str]:
    """pytest's exit status and output for tests of the package in the folder `source`."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "--tb=no", "-p", "no:cacheprovider", *tests]
    # No example of a mutant stays for the real tests.
    with tempfile.TemporaryDirectory(prefix="gbeam-hypothesis-") as examples:
        more = {"PYTHONPATH": str(source), "OPENBLAS_NUM_THREADS": "1", "HYPOTHESIS_STORAGE_DIRECTORY": examples}
        environment = {**os.environ, **more}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT)
    return done.returncode, done.stdout + done.stderr


def first_failure(output: str) -> str:
    """The test that failed, of pytest's short summary."""
    failed = (line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR ")))
    return next(failed, "? ?").partition(" ")[2].partition(" - ")[0].removeprefix("tests/")
