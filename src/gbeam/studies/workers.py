"""Computation of cases: in this process, in others of this machine, or by the workers of a Dask scheduler.

Each takes batches of cases and yields their rows in any order. The same cases give the same rows everywhere. What a
worker that dies was computing goes to another, at last with its cases one by one. A batch for a scheduler goes with the
version of gbeam that sent it: a worker with another one refuses it.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import math
import multiprocessing
import os
import pickle
import queue
import signal
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain
from multiprocessing.connection import Connection, wait
from types import ModuleType
from typing import Any

import gbeam
from gbeam.errors import ComputationError, InputError
from gbeam.guards.importing import path_of_children, variables
from gbeam.studies.evaluate import Function, Inquiry, Row, Task, rows

KEPT = 0.5  # s: computation that is lost at most when a process ends; the store is synchronised as often
_THREADS = "OPENBLAS_NUM_THREADS"  # one in each worker: threads of several would wait for one another
_FUNCTIONS, _WORKERS = "measure", "--workers"
_ELSEWHERE = "define it at the top level of a module that you import, or leave the workers out"


def serially(inquiry: Inquiry, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Compute all batches in this process as one sequence of cases, and yield the rows every half second."""
    finished, began = list[Row](), time.perf_counter()
    for row in rows(inquiry, chain.from_iterable(batches)):
        finished.append(row)
        if time.perf_counter() - began > KEPT:
            yield finished
            finished, began = [], time.perf_counter()
    if finished:
        yield finished


@dataclass
class _Worker:
    """A process, its pipe, and the batch that it computes."""

    process: Any
    pipe: Any
    ready: bool = False
    inquiry: Inquiry | None = None
    batch: Sequence[Task] | None = None

    def send(self, inquiry: Inquiry, batch: Sequence[Task]) -> None:
        """Give it a batch."""
        with suppress(OSError):  # the process has died: reading its pipe will say so
            if self.inquiry is not inquiry:
                self.pipe.send(inquiry)
            self.pipe.send(batch)
        self.inquiry, self.batch = inquiry, batch

    def end(self) -> None:
        """End it, whatever it is doing."""
        self.pipe.close()
        self.process.terminate()
        self.process.join()


class Workers:
    """Processes of this machine, each with its own pipe and batch: if one dies, only its batch is lost."""

    def __init__(self, count: int, functions: Sequence[Function]) -> None:
        """Start `count` processes, which load the `functions`; InputError if these cannot be sent or loaded."""
        try:
            self._functions = pickle.dumps(functions)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            problem = f"has a function that cannot be sent to another process ({error})"
            raise InputError(_FUNCTIONS, problem, _ELSEWHERE) from None
        if sys.flags.ignore_environment and not sys.flags.safe_path:
            problem = "would import from the current folder: Python runs with -E, which leaves out PYTHONSAFEPATH"
            raise InputError(_WORKERS, problem, "start Python with -I or with -E -P, or leave the workers out")
        self._path = sys.path if functions else path_of_children()  # what functions of the user's may need
        # Not forked from this process, whose JAX has threads; on Linux from a server that has imported this module.
        method = "forkserver" if sys.platform == "linux" else "spawn"
        if method == "forkserver":
            multiprocessing.set_forkserver_preload([__name__])
        self._context: Any = multiprocessing.get_context(method)
        self._workers: list[_Worker] = []
        try:
            for _ in range(count):
                self._workers.append(self._started())
            if functions:  # refused before a case is computed
                self._check(self._workers[0])
        except BaseException:
            self.close()
            raise

    def rows(self, inquiry: Inquiry, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
        """Compute the batches. One whose process dies is halved until the case that ends it is known.

        That case is tried once more. If it ends a process again, its row says that it failed.
        """
        pending, retries, suspects = iter(batches), deque[Sequence[Task]](), set[int]()

        def send_next(worker: _Worker) -> None:
            batch = retries.popleft() if retries else next(pending, None)
            if batch:
                worker.send(inquiry, batch)

        while True:
            for worker in self._workers:
                if worker.batch is None:
                    send_next(worker)
            busy = {worker.pipe: k for k, worker in enumerate(self._workers) if worker.batch}
            if not busy:
                return
            for k in [busy[pipe] for pipe in wait(list(busy))]:
                worker, batch = self._workers[k], self._workers[k].batch
                assert batch is not None
                try:
                    if not worker.ready:
                        self._check(worker)
                        continue
                    answer = worker.pipe.recv()
                except (EOFError, OSError, pickle.UnpicklingError):
                    worker.end()
                    self._workers[k] = self._started()
                    number, half = batch[0][0], len(batch) // 2
                    if half:
                        retries += [batch[:half], batch[half:]]
                    elif number in suspects:
                        yield [row_of_death(inquiry, batch[0])]
                    else:
                        suspects.add(number)
                        retries.append(batch)
                    continue
                worker.batch = None
                if isinstance(answer, str):
                    raise RuntimeError(f"a worker failed:\n{answer}")
                send_next(worker)  # which computes while this process keeps the rows
                yield answer

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        for worker in self._workers:
            worker.end()
        self._workers.clear()

    def _started(self) -> _Worker:
        """Start a new process. It imports modules while this one goes on."""
        pipe, worker_end = self._context.Pipe()
        process = self._context.Process(target=_work, args=(worker_end, self._functions), daemon=True)
        with _program(needed=b"__main__" in self._functions, path=self._path):
            process.start()
        worker_end.close()
        return _Worker(process, pipe)

    def _check(self, worker: _Worker) -> None:
        """Wait until a process is ready. InputError if it cannot load the functions, or if none can start."""
        try:
            problem = worker.pipe.recv()
        except (EOFError, OSError):
            if any(process.ready for process in self._workers):
                raise EOFError from None  # it was killed as it began
            worker.process.join()
            fix = 'put what your script does under if __name__ == "__main__":, or leave the workers out'
            problem = f"end as they begin, with exit status {worker.process.exitcode}"
            raise InputError(_WORKERS, problem, fix) from None
        if problem:
            problem = f"has a function that other processes cannot load ({problem})"
            raise InputError(_FUNCTIONS, problem, _ELSEWHERE)
        worker.ready = True


@contextmanager
def processes(count: int, functions: Sequence[Function]) -> Iterator[Workers]:
    """Start processes, which import while this one goes on, and close them at the end."""
    inherited = variables() | {_THREADS: os.environ.get(_THREADS, "1")}
    environment_before = {name: os.environ.get(name) for name in inherited}
    os.environ |= inherited
    try:
        workers = Workers(count, functions)
        try:
            yield workers
        finally:
            workers.close()
    finally:
        for name, value in environment_before.items():
            del os.environ[name]
            if value is not None:
                os.environ[name] = value


@contextmanager
def _program(*, needed: bool, path: list[str]) -> Iterator[None]:
    """Let new processes import from `path`, and the main program only if it is `needed`, as it defines functions."""
    main, path_before = sys.modules["__main__"], sys.path
    if not needed or not os.path.exists(getattr(main, "__file__", None) or ""):  # of a notebook, or typed in
        sys.modules["__main__"] = ModuleType("__main__")
    sys.path = path
    try:
        yield
    finally:
        sys.modules["__main__"], sys.path = main, path_before


def _work(pipe: Connection, functions: bytes) -> None:
    """Answer batches of cases in a worker, until the pipe closes.

    It first sends why the functions cannot be loaded, or "". An Inquiry that arrives holds for the batches after it.
    """
    _begin()
    with suppress(EOFError, OSError):
        try:
            pickle.loads(functions)
        except Exception as error:
            pipe.send(str(error) or type(error).__name__)
            return
        pipe.send("")
        import gbeam.scenario.build_motion  # noqa: F401  # now, not with the first case

        inquiry: Any = None
        while True:
            message = pipe.recv()
            if isinstance(message, Inquiry):
                inquiry = message
                continue
            try:
                answer: Any = list(rows(inquiry, message))
            except Exception:
                answer = traceback.format_exc()
            pipe.send(answer)


def _begin() -> None:
    """Prepare this process as a worker, which ends when its parent ends, even if that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # left to the parent
    driver = multiprocessing.parent_process()
    assert driver is not None

    def wait_for_end() -> None:
        driver.join()
        os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()


def row_of_death(inquiry: Inquiry, task: Task) -> Row:
    """Row of a case whose computation ends every process that tries it."""
    return Row(task[0], (math.nan,) * inquiry.width, "failed", "the process that computed it died")


CONNECTION = 10.0  # s that a scheduler may take to answer, and its first worker to appear
PATIENCE = 60.0  # s without any worker, after which a sweep gives up: those that a nanny restarts take a few
_AHEAD = 3  # batches sent per worker, so that none idles
_TICK = 1.0  # s between looks at the scheduler while nothing is done
_LOST = (OSError, TimeoutError, concurrent.futures.CancelledError, asyncio.CancelledError)
_OPTION = "--scheduler"


class OtherVersion(Exception):
    """Raised by a worker that has another version of gbeam."""


def compute(version: str, inquiry: Inquiry, batch: Sequence[Task]) -> list[Row]:
    """Compute a batch on a worker; one with another version than `version` refuses."""
    if gbeam.__version__ != version:
        from distributed import get_worker

        raise OtherVersion(get_worker().address, gbeam.__version__)
    return list(rows(inquiry, batch))


def on_scheduler(inquiry: Inquiry, batches: Iterable[Sequence[Task]], address: str) -> Iterator[list[Row]]:
    """Compute the batches on the workers of a Dask scheduler."""
    with _connected(address) as client:
        yield from _Dispatch(client, address, inquiry, iter(batches)).rows()


@contextmanager
def _connected(address: str) -> Iterator[Any]:
    """Client of the scheduler, once it has a worker. InputError if none answers."""
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
            problem = f"{address} does not answer ({_first_line(error)})"
            raise InputError(_OPTION, problem, "give the address that `dask scheduler` prints") from None
        yield from _with_worker(client, address)


@contextmanager
def _silent() -> Iterator[None]:
    """Silence Dask's loggers: one message here replaces the tracebacks that they would print."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _with_worker(client: Any, address: str) -> Iterator[Any]:
    """Yield the client once a worker is there; InputError if none appears."""
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
    inquiry: Inquiry
    left: Iterator[Sequence[Task]]
    again: deque[Task] = field(default_factory=deque)  # cases of batches that ended their workers
    under_way: dict[Any, Sequence[Task]] = field(default_factory=dict)
    alone: set[Any] = field(default_factory=set)  # futures of one case each, computed again
    done: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    threads: int = 1
    looked: float = -PATIENCE  # monotonic time at which there was a worker last, s

    def rows(self) -> Iterator[list[Row]]:
        """Send batches, a few ahead for every worker, and yield their rows until all have come back."""
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
            self._interrupted(f"the scheduler at {self.address} is lost ({_first_line(error) or type(error).__name__})")

    def _send(self) -> None:
        """Submit batches until enough are under way. Cases of killed workers come first, each alone."""
        while len(self.under_way) < _AHEAD * self.threads:
            single = bool(self.again)
            batch = [self.again.popleft()] if single else next(self.left, None)
            if batch is None:
                return
            future = self.client.submit(compute, gbeam.__version__, self.inquiry, batch, pure=False)
            self.under_way[future] = batch
            if single:
                self.alone.add(future)
            future.add_done_callback(self.done.put)

    def _received(self, future: Any, batch: Sequence[Task]) -> list[Row]:
        """Rows of a batch, or an empty list if its cases are to be computed again one by one, as their
        worker was killed.
        """
        from distributed import KilledWorker

        try:
            return list(future.result())
        except KilledWorker:
            if future in self.alone:
                return [row_of_death(self.inquiry, batch[0])]
            self.again.extend(batch)
            return []
        except OtherVersion as error:
            worker, version = error.args
            problem = f"the worker {worker} has gbeam {version}, and this is {gbeam.__version__}"
            raise InputError(_OPTION, problem, "install the same version everywhere; --resume does the rest") from None
        except (ImportError, AttributeError) as error:  # what was sent cannot be unpacked there
            fix = "install gbeam, the same version, and the modules of measures on every worker"
            raise InputError(_OPTION, f"has a worker that lacks what it needs ({_first_line(error)})", fix) from None

    def _look(self) -> None:
        """Count the workers' threads, at most once a second. ComputationError if there was none for a minute."""
        time_now = time.monotonic()
        if time_now - self.looked < _TICK:
            return
        if self.client.status != "running":
            raise OSError("the connection broke")
        threads = sum(self.client.nthreads().values())
        if threads:
            self.threads, self.looked = threads, time_now
        elif time_now - self.looked > PATIENCE:
            self._interrupted(f"the scheduler at {self.address} has had no worker for {PATIENCE:.0f} s")

    def _interrupted(self, message: str) -> None:
        raise ComputationError("interrupted", f"{message}; what is done is kept: --resume does the rest") from None


def _first_line(error: BaseException) -> str:
    """First line of an exception's message."""
    return (str(error).strip().splitlines() or [""])[0]
