"""Where cases are computed on this machine: in this process, or in others.

Each takes batches of cases and yields their rows in any order; the same cases give the same rows everywhere, as they do
on a cluster.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import pickle
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager

from gbeam.arrays.memory import keep_memory
from gbeam.errors import InputError
from gbeam.sweeps.computing.batches import Task, rows
from gbeam.sweeps.computing.evaluate import Question, Row

_THREADS = "OPENBLAS_NUM_THREADS"  # of each worker one: those of several wait for one another
AHEAD = 3  # batches per worker that wait, so that none idles


def serially(question: Question, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Compute the batches here."""
    for batch in batches:
        yield rows(question, batch)


@contextmanager
def processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that start, and import, while this one goes on."""
    given = os.environ.get(_THREADS)
    os.environ.setdefault(_THREADS, "1")  # inherited
    pool = _pool(workers)
    try:
        for _ in range(workers):
            pool.submit(_import)
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        if given is None:
            os.environ.pop(_THREADS, None)


def _import() -> None:
    """Import what is imported where a case needs it."""
    import gbeam.report.study.summary_json  # noqa: F401
    import gbeam.scenario.build_motion  # noqa: F401


def in_processes(
    question: Question, batches: Iterable[Sequence[Task]], workers: int, first: ProcessPoolExecutor
) -> Iterator[list[Row]]:
    """Compute the batches in processes of this machine, the `first` of which have started.

    A worker that dies takes its pool along: what was under way begins again in a new pool, with its cases one by one,
    and a case that ends its worker alone is recorded as failed.

    Raises
    ------
    InputError
        If a measure is a function that cannot be sent to another process.
    """
    try:
        pickle.dumps(question.functions)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        problem = f"has a function that cannot be sent to another process ({error})"
        raise InputError("measure", problem, "define it in a module, at the top level") from None
    left, pool = iter(batches), first
    while True:
        under_way: dict[Future[list[Row]], Sequence[Task]] = {}
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
        pool = _pool(workers)


def _pool(workers: int) -> ProcessPoolExecutor:
    # Not forked from this process: JAX has threads. On Linux from one that has none, and has imported what they need.
    method = "forkserver" if sys.platform == "linux" else "spawn"
    if method == "forkserver":
        multiprocessing.set_forkserver_preload([__name__])
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context(method), initializer=_begin)


def _begin() -> None:
    """Make this process a worker: it ends with the one that it computes for, even if that is killed."""
    keep_memory()
    driver = multiprocessing.parent_process()
    assert driver is not None

    def wait_for_end() -> None:
        driver.join()
        os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()


def _alone(question: Question, task: Task) -> Row:
    """One case in a process of its own."""
    with _pool(1) as pool:
        try:
            return pool.submit(rows, question, [task]).result()[0]
        except BrokenProcessPool:
            return died(question, task)


def died(question: Question, task: Task) -> Row:
    """Row of a case whose process ends whenever it is computed."""
    return Row(task[0], (math.nan,) * question.width, "failed", "the process that computed it died")
