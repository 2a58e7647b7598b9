"""Where cases are computed: in this process, in others on this machine, or on a Dask scheduler's workers.

Each takes batches of cases and yields their rows in any order; the same cases give the same rows everywhere.
"""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

import gbeam
from gbeam.errors import ComputationError, InputError
from gbeam.sweeps.evaluate import Question, Row, rows

Task = tuple[int, tuple[str, ...]]  # number of the case, and its changes
AHEAD = 3  # batches per worker that wait, so that none idles
TRIES = 3  # that a batch may end its worker before its cases are taken one by one


def serially(question: Question, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Compute the batches here."""
    for batch in batches:
        yield rows(question, batch)


def in_processes(question: Question, batches: Iterable[Sequence[Task]], workers: int) -> Iterator[list[Row]]:
    """Compute the batches in processes of this machine.

    A worker that dies takes its pool along: what was under way begins again in a new pool, with its cases one by one,
    and a case that ends its worker alone is recorded as failed.
    """
    left = iter(batches)
    while True:
        under_way: dict[Future[list[Row]], Sequence[Task]] = {}
        pool = _pool(workers)
        try:
            while True:
                while len(under_way) < AHEAD * workers and (batch := next(left, None)) is not None:
                    under_way[pool.submit(rows, question, batch)] = batch
                if not under_way:
                    return
                done, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in done:
                    found = future.result()
                    del under_way[future]
                    yield found
        except BrokenProcessPool:
            for batch in under_way.values():
                yield [_alone(question, task) for task in batch]
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _pool(workers: int) -> ProcessPoolExecutor:
    # Spawned, not forked: JAX has threads.
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def _alone(question: Question, task: Task) -> Row:
    """One case in a process of its own."""
    with _pool(1) as pool:
        try:
            return pool.submit(rows, question, [task]).result()[0]
        except BrokenProcessPool:
            return Row(task[0], (math.nan,) * question.width, "failed", "the process that computed it died")


def on_scheduler(question: Question, batches: Iterable[Sequence[Task]], address: str) -> Iterator[list[Row]]:
    """Compute the batches on the workers of a Dask scheduler.

    Raises
    ------
    InputError
        If dask is not installed, there is no scheduler, or a worker has another version of gbeam.
    ComputationError
        If the scheduler is lost.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError("--scheduler", "needs Dask", 'pip install "gbeam[cluster]"') from None
    try:
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError("--scheduler", f"{address}: {error}", "give the address that dask-scheduler prints") from None
    with client:
        _same_version(client)
        shared = client.scatter(question, broadcast=True)
        left = iter(batches)
        first = [client.submit(rows, shared, batch, retries=TRIES, pure=False) for batch in _some(left, client)]
        running = as_completed(first, raise_errors=False)
        try:
            for future in running:
                if future.status == "lost" or future.cancelled():
                    raise ComputationError("interrupted", "the scheduler is gone; --resume does what is missing")
                yield future.result()
                if (batch := next(left, None)) is not None:
                    running.add(client.submit(rows, shared, batch, retries=TRIES, pure=False))
        except (OSError, TimeoutError) as error:
            message = f"the scheduler at {address} is lost ({error}); --resume does what is missing"
            raise ComputationError("interrupted", message) from None


def _some(batches: Iterator[Sequence[Task]], client: object) -> Iterator[Sequence[Task]]:
    workers = len(client.scheduler_info()["workers"]) or 1  # type: ignore[attr-defined]
    for _ in range(AHEAD * workers):
        batch = next(batches, None)
        if batch is None:
            return
        yield batch


def _version() -> str:
    return gbeam.__version__


def _same_version(client: object) -> None:
    found = client.run(_version)  # type: ignore[attr-defined]
    if not found:
        raise InputError("--scheduler", "has no workers", "start some with: dask worker ADDRESS")
    for worker, version in found.items():
        if version != gbeam.__version__:
            problem = f"the worker {worker} has gbeam {version}, and this is {gbeam.__version__}"
            raise InputError("--scheduler", problem, "install the same version everywhere")
