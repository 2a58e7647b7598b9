"""Cases computed by Dask's workers: the same bytes as in this process, whatever is killed on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import gbeam as gb

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")

Call = Callable[..., Any]
LEVELS = ["motion.flight.acceleration.z.level=2 g:8 g:24"]
TIP = ["flight.tip.z"]
LENGTHS = {"beam.length": "0.2 m:0.3 m:24"}
MEASURES = """
import os, signal, time
from pathlib import Path

def slow(case):
    time.sleep(0.03)
    return case.beam.length

def deadly(case):
    if abs(case.beam.length - 0.25) < 1e-9:
        os.kill(os.getpid(), signal.SIGKILL)
    return case.beam.length
"""


@pytest.fixture(scope="module")
def measures(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """A module that the workers have too."""
    folder = tmp_path_factory.mktemp("measures")
    (folder / "of_cases.py").write_text(MEASURES, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        patch.setenv("PYTHONPATH", os.pathsep.join([str(folder), *sys.path]))
        # A case that ends two workers is given up; eight by default. Processes read the environment as they begin.
        patch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "0")
        import of_cases  # type: ignore[import-not-found]

        with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
            yield of_cases


class ByHand:
    """A scheduler and its workers, as a user starts them: processes of their own."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._file = folder, folder / "scheduler.json"
        self.scheduler = self._start("scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(self._file))
        while not self._file.exists():
            time.sleep(0.02)
        with distributed.Client(scheduler_file=str(self._file), set_as_default=False) as client:
            self.address: str = client.scheduler.address
        self.workers: list[subprocess.Popen[bytes]] = []

    def _start(self, what: str, *arguments: str) -> subprocess.Popen[bytes]:
        code = f"from distributed.cli.dask_{what} import main; main()"
        command = [sys.executable, "-c", code, *arguments]
        return subprocess.Popen(command, cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def worker(self, *arguments: str) -> subprocess.Popen[bytes]:
        """Start a worker."""
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(self._folder)]
        self.workers.append(self._start("worker", self.address, *options, *arguments))
        return self.workers[-1]

    def two(self) -> None:
        """Start two workers, and wait for them."""
        self.worker()
        self.worker()
        self.wait(2)

    def wait(self, count: int) -> None:
        """Wait for workers."""
        with distributed.Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=60)

    def end(self) -> None:
        """End all processes."""
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()


@pytest.fixture
def by_hand(tmp_path: Path, measures: ModuleType) -> Iterator[ByHand]:
    """A scheduler that has no workers yet."""
    cluster = ByHand(tmp_path)
    yield cluster
    cluster.end()


def after(count: int, act: Callable[[], object]) -> Callable[[int, int, int], None]:
    """A progress that acts once, after some cases."""
    left = SimpleNamespace(act=act)

    def progress(done: int, failed: int, cases: int) -> None:
        if done >= count and left.act:
            left.act()
            left.act = None

    return progress


def data(sweep: gb.Sweep) -> Any:
    """The dataset, without where it comes from."""
    return sweep.to_xarray().drop_attrs(deep=False)


def test_a_local_cluster_gives_the_same_bytes_and_records_what_ends_its_workers(
    fast: Path, measures: ModuleType
) -> None:
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        address = cluster.scheduler_address
        theirs = gb.sweep(fast, LEVELS, TIP, verb="static", scheduler=address)
        over = {"beam.length": ["0.2 m", "0.22 m", "0.25 m", "0.27 m"]}
        swept = gb.sweep(fast, over, {"length": measures.deadly}, scheduler=address)
    ours = gb.sweep(fast, LEVELS, TIP, verb="static")
    assert ours.measures["flight.tip.z"].tobytes() == theirs.measures["flight.tip.z"].tobytes()
    assert data(ours).identical(data(theirs))
    assert swept.outcome.tolist() == ["done", "done", "failed", "done"]
    assert swept.message[2] == "the process that computed it died"


def test_workers_started_by_hand_lose_no_case_when_one_is_killed(
    fast: Path, by_hand: ByHand, measures: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gbeam.studies.sweep._LONGEST", 1)
    with monkeypatch.context() as patch:
        patch.setattr("gbeam.studies.workers.CONNECTION", 1.0)
        with pytest.raises(gb.InputError, match="has no workers; start some with: dask worker"):
            gb.sweep(fast, LEVELS, TIP, verb="static", scheduler=by_hand.address)
    by_hand.two()
    whole = gb.sweep(fast, LENGTHS, {"length": measures.slow})
    kill = after(6, by_hand.workers[0].kill)
    swept = gb.sweep(fast, LENGTHS, {"length": measures.slow}, scheduler=by_hand.address, progress=kill)
    assert by_hand.workers[0].wait() == -signal.SIGKILL
    assert data(swept).identical(data(whole))
    # A worker with another version, among those with the right one.
    Path("other.py").write_text("import gbeam\ngbeam.__version__ = '0.0.1'\n", encoding="utf-8")
    by_hand.worker("--preload", str(Path("other.py").resolve()), "--name", "stranger")
    by_hand.wait(2)
    with pytest.raises(gb.InputError, match=r"the worker tcp://\S+ has gbeam 0\.0\.1, and this is") as refused:
        gb.sweep(fast, LENGTHS, {"length": measures.slow}, scheduler=by_hand.address)
    assert "same version everywhere" in refused.value.fix


def test_a_driver_and_a_scheduler_that_are_killed_are_resumed(
    fast: Path, by_hand: ByHand, measures: ModuleType, gbeam: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gbeam.studies.sweep._LONGEST", 1)
    by_hand.two()
    code = "import gbeam as gb, of_cases, gbeam.studies.sweep as s; s._LONGEST = 1\n"
    code += f"gb.sweep({str(fast)!r}, {LENGTHS!r}, {{'length': of_cases.slow}}, store='there', "
    code += f"scheduler={by_hand.address!r})"
    driver = subprocess.Popen([sys.executable, "-c", code])
    journal = Path("there/cases.jsonl")
    while not journal.exists() or journal.read_bytes().count(b"\n") < 5:
        assert driver.poll() is None
        time.sleep(0.01)
    driver.kill()
    driver.wait()
    first = journal.read_bytes().count(b"\n")
    assert first < 24
    whole = gb.sweep(fast, LENGTHS, {"length": measures.slow})
    arguments: dict[str, Any] = {"store": "there", "resume": True, "scheduler": by_hand.address}
    kill = after(first + 5, by_hand.scheduler.kill)
    with pytest.raises(gb.ComputationError, match=r"the scheduler at \S+ is lost .*--resume does the rest"):
        gb.sweep(fast, LENGTHS, {"length": measures.slow}, **arguments, progress=kill)
    assert first < journal.read_bytes().count(b"\n") < 25
    with pytest.raises(gb.InputError, match="does not answer"):
        monkeypatch.setattr("gbeam.studies.workers.CONNECTION", 0.5)
        gb.sweep(fast, LENGTHS, {"length": measures.slow}, **arguments)
    swept = gb.sweep(fast, LENGTHS, {"length": measures.slow}, store="there", resume=True)
    assert data(swept).identical(data(whole))
