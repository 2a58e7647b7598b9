"""Computation of cases on this machine: in this process, or in others.

Each takes batches of cases and yields their rows in any order; the same cases give the same rows everywhere, as they do
on a cluster.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import traceback
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from types import ModuleType
from typing import Any

from gbeam.errors import InputError
from gbeam.studies.evaluate import Function, Question, Row, Task, rows

_THREADS = "OPENBLAS_NUM_THREADS"  # of each worker one: those of several wait for one another
_FUNCTIONS, _WORKERS = "measure", "--workers"
_ELSEWHERE = "define it at the top level of a module that you import, or leave the workers out"


def serially(question: Question, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Compute the batches in this process."""
    for batch in batches:
        yield rows(question, batch)


@dataclass
class _Worker:
    """A process and what it is doing."""

    process: Any
    pipe: Any
    ready: bool = False
    question: Question | None = None
    batch: Sequence[Task] | None = None

    def send(self, question: Question, batch: Sequence[Task]) -> None:
        """Give it a batch."""
        with suppress(OSError):  # it has died, as its pipe will say
            if self.question is not question:
                self.pipe.send(question)
            self.pipe.send(batch)
        self.question, self.batch = question, batch

    def end(self) -> None:
        """End it, whatever it is doing."""
        self.pipe.close()
        self.process.terminate()
        self.process.join()


class Workers:
    """Processes of this machine, each with a batch of its own: one that dies takes no other's along."""

    def __init__(self, count: int, functions: Sequence[Function]) -> None:
        try:
            self._functions = pickle.dumps(functions)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            problem = f"has a function that cannot be sent to another process ({error})"
            raise InputError(_FUNCTIONS, problem, _ELSEWHERE) from None
        # Not forked from this process: JAX has threads. On Linux from one without, which has imported what they need.
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

    def rows(self, question: Question, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
        """Compute the batches.

        A batch whose process dies is divided until one case is left, which has failed if its process dies once more.
        """
        left, again, suspects = iter(batches), deque[Sequence[Task]](), set[int]()
        while True:
            for worker in self._workers:
                if worker.batch is None and (batch := again.popleft() if again else next(left, None)):
                    worker.send(question, batch)
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
                        again += [batch[:half], batch[half:]]
                    elif number in suspects:
                        yield [died(question, batch[0])]
                    else:
                        suspects.add(number)
                        again.append(batch)
                    continue
                worker.batch = None
                if isinstance(answer, str):
                    raise RuntimeError(f"a worker failed:\n{answer}")
                if following := again.popleft() if again else next(left, None):
                    worker.send(question, following)  # while this process keeps the rows
                yield answer

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        for worker in self._workers:
            worker.end()
        self._workers.clear()

    def _started(self) -> _Worker:
        """A new process, which imports while this one goes on."""
        pipe, far = self._context.Pipe()
        process = self._context.Process(target=_work, args=(far, self._functions), daemon=True)
        with _main_hidden(b"__main__" not in self._functions):
            process.start()
        far.close()
        return _Worker(process, pipe)

    def _check(self, worker: _Worker) -> None:
        """Wait until a process is ready; InputError if it cannot load the functions, or none can start."""
        try:
            problem = worker.pipe.recv()
        except (EOFError, OSError):
            if any(each.ready for each in self._workers):
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
    """Processes that start, and import, while this one goes on."""
    threads = os.environ.get(_THREADS)
    os.environ.setdefault(_THREADS, "1")  # inherited
    try:
        workers = Workers(count, functions)
        try:
            yield workers
        finally:
            workers.close()
    finally:
        if threads is None:
            os.environ.pop(_THREADS, None)


@contextmanager
def _main_hidden(hidden: bool) -> Iterator[None]:
    """Let processes that start not run the main program again, which only its own functions need."""
    main = sys.modules["__main__"]
    if hidden or not os.path.exists(getattr(main, "__file__", None) or ""):  # of a notebook, or typed in
        sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _work(pipe: Connection, functions: bytes) -> None:
    """Say whether the functions can be loaded, take a question, and answer batches until the other end is closed."""
    _begin()
    with suppress(EOFError, OSError):
        try:
            pickle.loads(functions)
        except Exception as error:
            pipe.send(str(error) or type(error).__name__)
            return
        pipe.send("")
        _import()
        question: Any = None
        while True:
            message = pipe.recv()
            if isinstance(message, Question):
                question = message
                continue
            try:
                answer: Any = rows(question, message)
            except Exception:
                answer = traceback.format_exc()
            pipe.send(answer)


def _import() -> None:
    """Import what is imported where a case needs it."""
    import gbeam.results.facts  # noqa: F401
    import gbeam.scenario.build_motion  # noqa: F401


def _begin() -> None:
    """Make this process a worker: it ends with the one that it computes for, even if that is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # that one decides
    driver = multiprocessing.parent_process()
    assert driver is not None

    def wait_for_end() -> None:
        driver.join()
        os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()


def died(question: Question, task: Task) -> Row:
    """Row of a case whose process ends whenever it is computed."""
    return Row(task[0], (math.nan,) * question.width, "failed", "the process that computed it died")
