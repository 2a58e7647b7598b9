"""The process of the command line: its signals, arguments, streams and progress.

Ctrl-C and a request to terminate end it at once, with one line and no half-written file. They raise no exception,
which libraries would swallow in a callback, and print with a traceback during an import. Nothing heavy is imported
here, as signals are set up before everything else.
"""

from __future__ import annotations

import io
import os
import re
import shlex
import shutil
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from types import FrameType, TracebackType
from typing import Any, Self

from gbeam.printable import on_one_line, shortened, storable
from gbeam.progress import PATIENCE, Bar

_WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
_cleanups: list[Callable[[], object]] = []
_deferring = 0
_pending: int | None = None


def end_on_signals() -> None:
    """End the process at a signal, with exit status 128 plus its number, unless the parent process ignores it."""
    for number in _WORDS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)


def ignore_signals() -> None:
    """Ignore signals from now on: one that comes while Python ends would change the exit status."""
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
    """Let signals wait until the block is done. It must be short and not be interrupted."""
    global _deferring
    _deferring += 1
    try:
        yield
    finally:
        _deferring -= 1
        if _pending is not None and not _deferring:
            _exit(_pending)


def _end(number: int, frame: FrameType | None) -> None:
    """Handler of signals."""
    global _pending
    if _deferring:
        _pending = number
        return
    _exit(number)


def _exit(number: int) -> None:
    """End the process on a signal: kill its children, call the cleanups, and print one line."""
    processes = sys.modules.get("multiprocessing")
    for child in processes.active_children() if processes else ():  # they would wait for work forever
        child.kill()
    for cleanup in reversed(_cleanups):
        with suppress(Exception):
            cleanup()
    with suppress(OSError):
        os.write(2, f"gbeam: {_WORDS[signal.Signals(number)]}\n".encode())
    os._exit(128 + number)


FIGURES = "GBEAM_FIGURES"  # environment variable: "none" writes no files of figures, as where a report draws them
_own = False


def begin() -> None:
    """Note that this process is the command line's own."""
    global _own
    _own = True


def end_at_once(status: int) -> None:
    """End the command line's own process without a shutdown, in which libraries that lack memory may hang."""
    if _own:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def figures_wanted() -> bool:
    """True if files of figures are written; that takes most of the time of a short run."""
    return os.environ.get(FIGURES) != "none"


_TOKENS: ContextVar[tuple[str, ...]] = ContextVar("tokens", default=())


def note(tokens: list[str]) -> None:
    """Note the arguments after the program's name."""
    _TOKENS.set(tuple(tokens))


def command() -> str:
    """Return the command line, quoted for a shell; characters that no file can hold are written as escapes."""
    return storable(shlex.join(["gbeam", *_TOKENS.get()]))


_ALIKE = 40  # characters: warnings that begin with the same ones are printed once
_NARROWEST, _WIDEST = 20, 10_000  # columns of a terminal
_CACHE = re.compile(r"Error (?:reading|writing) persistent compilation cache entry.*?: (.*)", re.DOTALL)


def prepare() -> bool:
    """Make standard output and error safe to print on, and return true if there is a standard output.

    If one is closed (``gbeam ... >&-``), the next file that is opened would get its number, and be printed into.
    """
    has_stdout = sys.stdout is not None
    if sys.stdin is None or sys.stdout is None or sys.stderr is None:
        while os.open(os.devnull, os.O_RDWR) < 2:
            pass
        sys.stdout = sys.stdout or _nowhere()
        sys.stderr = sys.stderr or _nowhere()
    _widen()
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without µ or ² is no reason to fail
            raw = getattr(stream.buffer, "raw", stream.buffer)  # unbuffered it is the buffer; a console has another
            if _own and stream is getattr(sys, f"__{name}__") and isinstance(raw, io.FileIO):
                setattr(sys, name, _lasting(stream))
    return has_stdout


class _Lasting(io.FileIO):
    """File that discards all that comes after an error of writing, which it keeps: a computation goes on without it."""

    error: OSError | None = None

    def write(self, data: Any, /) -> int:
        """Write bytes. After the first error, which is kept, discard them."""
        if self.error is None:
            try:
                return super().write(data)
            except OSError as error:
                self.error = error
        return memoryview(data).nbytes


def _lasting(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """Stream that writes where another does, as long as that can be written to."""
    by_lines = stream.line_buffering or stream.write_through
    binary = io.BufferedWriter(_Lasting(stream.fileno(), "wb", closefd=False))
    return io.TextIOWrapper(binary, stream.encoding, errors="replace", line_buffering=by_lines)


def error_of_stdout() -> OSError | None:
    """Error after which nothing more was printed on standard output, or None if all was."""
    return getattr(getattr(getattr(sys.stdout, "buffer", None), "raw", None), "error", None)


def _widen() -> None:
    """Set COLUMNS so that a terminal has a width in which text can be laid out: layout fails in any other."""
    columns = os.environ.get("COLUMNS", "")
    numeric = columns.isascii() and columns.isdigit()
    width = int(columns[:9]) if numeric else shutil.get_terminal_size().columns
    if not _NARROWEST <= width <= _WIDEST:
        os.environ["COLUMNS"] = str(min(max(width, _NARROWEST), _WIDEST))


def shorten_warnings() -> None:
    """Print each warning of a library on one line, without its place in the source. Similar ones are
    printed only once.
    """
    printed: set[str] = set()

    def show(message: Warning | str, *_: object, **__: object) -> None:
        text = _CACHE.sub(r"the cache of compiled programs cannot be used, they are compiled again: \1", str(message))
        if text[:_ALIKE] not in printed:
            printed.add(text[:_ALIKE])
            print(f"gbeam: warning: {on_one_line(shortened(text))}", file=sys.stderr)

    warnings.showwarning = show


def _nowhere() -> io.TextIOWrapper:
    return open(os.devnull, "w", encoding="utf-8")


class Watch(Bar):
    """Progress bar of a command, which is removed if a signal ends the process."""

    def __init__(self, first: str = "computing") -> None:
        super().__init__(first, patience=PATIENCE)
        self._cleaned_up = cleaned_up(self._stop)

    def __enter__(self) -> Self:
        self._cleaned_up.__enter__()
        return super().__enter__()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        super().__exit__(kind, error, trace)
        self._cleaned_up.__exit__(kind, error, trace)
