"""Ctrl-C and a request to terminate end the process at once, with one line and nothing half-written.

No exception is raised: libraries swallow one that a callback raises, and print a traceback of one during an import.
Imports nothing heavy: it is set up before everything else.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
_cleanups: list[Callable[[], object]] = []
_deferring = 0
_pending: int | None = None


def end_on_signals() -> None:
    """End the process with 128 and the signal's number when one comes, unless the parent made it ignored."""
    for number in _WORDS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)


def ignore_signals() -> None:
    """Let signals come too late: as Python ends it would be killed by one, with another exit status."""
    for number in _WORDS:
        if signal.getsignal(number) is _end:
            signal.signal(number, signal.SIG_IGN)


@contextmanager
def cleaned_up(cleanup: Callable[[], object]) -> Iterator[None]:
    """Call `cleanup` if a signal ends the process inside."""
    _cleanups.append(cleanup)
    try:
        yield
    finally:
        _cleanups.remove(cleanup)


@contextmanager
def deferred() -> Iterator[None]:
    """Let a signal wait until the block is done: for what must be done as a whole, and takes milliseconds."""
    global _deferring
    _deferring += 1
    try:
        yield
    finally:
        _deferring -= 1
        if _pending is not None and not _deferring:
            _exit(_pending)


def _end(number: int, frame: FrameType | None) -> None:
    global _pending
    if _deferring:
        _pending = number
        return
    _exit(number)


def _exit(number: int) -> None:
    processes = sys.modules.get("multiprocessing")
    for child in processes.active_children() if processes else ():  # which would wait for work for ever
        child.kill()
    for cleanup in reversed(_cleanups):
        with suppress(Exception):
            cleanup()
    with suppress(OSError):
        os.write(2, f"gbeam: {_WORDS[signal.Signals(number)]}\n".encode())
    os._exit(128 + number)
