"""Cases computed by the workers of a Dask scheduler, on this machine or on many.

Each batch goes with the version of gbeam that sent it: a worker with another one refuses it. What a worker that dies
was computing goes to another, at last with its cases one by one.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import queue
import time
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import gbeam
from gbeam.errors import ComputationError, InputError
from gbeam.studies.evaluate import Question, Row, Task, rows
from gbeam.studies.workers import died

CONNECTION = 10.0  # s that a scheduler may take to answer, and its first worker to appear
PATIENCE = 60.0  # s without any worker, after which a sweep gives up: those that a nanny restarts take a few
_AHEAD = 3  # batches per worker that wait, so that none idles
_TICK = 1.0  # s between looks at the scheduler while nothing is done
_LOST = (OSError, TimeoutError, concurrent.futures.CancelledError, asyncio.CancelledError)
_OPTION = "--scheduler"


class OtherVersion(Exception):
    """Raised by a worker that has another version of gbeam."""


def compute(version: str, question: Question, batch: Sequence[Task]) -> list[Row]:
    """Compute a batch on a worker; one with another version than `version` refuses."""
    if gbeam.__version__ != version:
        from distributed import get_worker

        raise OtherVersion(get_worker().address, gbeam.__version__)
    return rows(question, batch)


def on_scheduler(question: Question, batches: Iterable[Sequence[Task]], address: str) -> Iterator[list[Row]]:
    """Compute the batches on the workers of a Dask scheduler."""
    with _connected(address) as client:
        yield from _Dispatch(client, address, question, iter(batches)).rows()


@contextmanager
def _connected(address: str) -> Iterator[Any]:
    """A client of the scheduler, once there is a worker."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError(_OPTION, "needs Dask", 'pip install "gbeam[cluster]"') from None

    class Quiet(Client):
        def __del__(self) -> None:
            """Leave a client that never was connected as it is: to close it takes 20 s, and ends in a traceback."""

    with _silent():
        try:
            client = Quiet(address, timeout=CONNECTION, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            problem = f"{address} does not answer ({_first(error)})"
            raise InputError(_OPTION, problem, "give the address that `dask scheduler` prints") from None
        yield from _with_worker(client, address)


@contextmanager
def _silent() -> Iterator[None]:
    """Let Dask's loggers be silent: what they print tracebacks of becomes a message here."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    levels = [each.level for each in loggers]
    for each in loggers:
        each.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for each, level in zip(loggers, levels, strict=True):
            each.setLevel(level)


def _with_worker(client: Any, address: str) -> Iterator[Any]:
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECTION)
        except TimeoutError:
            fix = f"start some with: dask worker {address} --nthreads 1"
            raise InputError(_OPTION, f"{address} has no workers", fix) from None
        yield client


@dataclass
class _Dispatch:
    """The batches of one sweep on their way to the workers and back."""

    client: Any
    address: str
    question: Question
    left: Iterator[Sequence[Task]]
    again: deque[Task] = field(default_factory=deque)  # of batches that ended their workers
    under_way: dict[Any, Sequence[Task]] = field(default_factory=dict)
    alone: set[Any] = field(default_factory=set)  # those under way that are done again, one case each
    done: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    threads: int = 1
    looked: float = -PATIENCE  # when there was a worker last

    def rows(self) -> Iterator[list[Row]]:
        """Send batches, a few ahead for every worker, until all have come back."""
        try:
            while True:
                self._look()
                self._send()
                if not self.under_way:
                    return
                try:
                    future = self.done.get(timeout=_TICK)
                except queue.Empty:
                    continue
                yield self._received(future, self.under_way.pop(future))
        except _LOST as error:
            self._interrupted(f"the scheduler at {self.address} is lost ({_first(error) or type(error).__name__})")

    def _send(self) -> None:
        while len(self.under_way) < _AHEAD * self.threads:
            alone = bool(self.again)
            batch = [self.again.popleft()] if alone else next(self.left, None)
            if batch is None:
                return
            future = self.client.submit(compute, gbeam.__version__, self.question, batch, pure=False)
            self.under_way[future] = batch
            if alone:
                self.alone.add(future)
            future.add_done_callback(self.done.put)

    def _received(self, future: Any, batch: Sequence[Task]) -> list[Row]:
        """Rows of a batch; none where its cases have to be computed again."""
        from distributed import KilledWorker

        try:
            return list(future.result())
        except KilledWorker:
            if future in self.alone:
                return [died(self.question, batch[0])]
            self.again.extend(batch)
            return []
        except OtherVersion as error:
            worker, version = error.args
            problem = f"the worker {worker} has gbeam {version}, and this is {gbeam.__version__}"
            raise InputError(_OPTION, problem, "install the same version everywhere; --resume does the rest") from None
        except (ImportError, AttributeError) as error:  # what was sent cannot be unpacked there
            fix = "install gbeam, the same version, and the modules of measures on every worker"
            raise InputError(_OPTION, f"has a worker that lacks what it needs ({_first(error)})", fix) from None

    def _look(self) -> None:
        """See how many workers there are, at most once a second."""
        now = time.monotonic()
        if now - self.looked < _TICK:
            return
        if self.client.status != "running":
            raise OSError("the connection broke")
        threads = sum(self.client.nthreads().values())
        if threads:
            self.threads, self.looked = threads, now
        elif now - self.looked > PATIENCE:
            self._interrupted(f"the scheduler at {self.address} has had no worker for {PATIENCE:.0f} s")

    def _interrupted(self, message: str) -> None:
        raise ComputationError("interrupted", f"{message}; what is done is kept: --resume does the rest") from None


def _first(error: BaseException) -> str:
    """First line of what an exception says."""
    return (str(error).strip().splitlines() or [""])[0]
