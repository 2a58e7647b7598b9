"""Where cases are computed on this machine: in this process, or in others.

Each takes batches of cases and yields their rows in any order; the same cases give the same rows everywhere, as they do
on a cluster.
"""

from __future__ import annotations

import math
import multiprocessing
import pickle
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from gbeam.errors import InputError
from gbeam.sweeps.batches import Task, rows
from gbeam.sweeps.evaluate import Question, Row

AHEAD = 3  # batches per worker that wait, so that none idles


def serially(question: Question, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Compute the batches here."""
    for batch in batches:
        yield rows(question, batch)


def in_processes(question: Question, batches: Iterable[Sequence[Task]], workers: int) -> Iterator[list[Row]]:
    """Compute the batches in processes of this machine.

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
            return died(question, task)


def died(question: Question, task: Task) -> Row:
    """Row of a case whose process ends whenever it is computed."""
    return Row(task[0], (math.nan,) * question.width, "failed", "the process that computed it died")
