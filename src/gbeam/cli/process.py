"""The process of the command line: its arguments, its streams, its progress, how it begins and ends."""

from __future__ import annotations

import io
import os
import re
import shlex
import shutil
import sys
import warnings
from contextvars import ContextVar
from types import TracebackType
from typing import Self

from gbeam.cli.interrupts import cleaned_up
from gbeam.printable import on_one_line, shortened, storable
from gbeam.progress import Bar

FIGURES = "GBEAM_FIGURES"  # environment: "none" leaves out the files of figures, as where a report draws its own
_own = False


def begin() -> None:
    """Note that this process is the command line's own."""
    global _own
    _own = True


def end_at_once(status: int) -> None:
    """End a process of the command line's own as it is: libraries that lack memory may hang as they are taken down."""
    if _own:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def figures_wanted() -> bool:
    """Whether files of figures are written, which takes most of the time of a short run."""
    return os.environ.get(FIGURES) != "none"


_TOKENS: ContextVar[tuple[str, ...]] = ContextVar("tokens", default=())


def note(tokens: list[str]) -> None:
    """Note the arguments after the program's name."""
    _TOKENS.set(tuple(tokens))


def command() -> str:
    """The command line, as a shell takes it; what is no text in it is written out."""
    return storable(shlex.join(["gbeam", *_TOKENS.get()]))


_ALIKE = 40  # characters in which alike warnings agree
_NARROWEST, _WIDEST = 20, 10_000  # columns of a terminal
_CACHE = re.compile(r"Error (?:reading|writing) persistent compilation cache entry.*?: (.*)", re.DOTALL)


def prepare() -> bool:
    """Make both streams fit to print on, and return whether there is a standard output.

    Where one is closed (``gbeam ... >&-``) the next file opened would take its number, and be printed into.
    """
    present = sys.stdout is not None
    if sys.stdin is None or sys.stdout is None or sys.stderr is None:
        while os.open(os.devnull, os.O_RDWR) < 2:
            pass
        sys.stdout = sys.stdout or _nowhere()
        sys.stderr = sys.stderr or _nowhere()
    _widen()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without µ or ² is no reason to fail
    return present


def _widen() -> None:
    """Take a terminal to be no narrower, and no wider, than a text can be laid out in: others end never, or wrongly."""
    columns = os.environ.get("COLUMNS", "")
    known = columns.isascii() and columns.isdigit()
    width = int(columns[:9]) if known else shutil.get_terminal_size().columns
    if not _NARROWEST <= width <= _WIDEST:
        os.environ["COLUMNS"] = str(min(max(width, _NARROWEST), _WIDEST))


def shorten_warnings() -> None:
    """Print what libraries warn of on one line, without the place in their source, and what is alike once."""
    shown: set[str] = set()

    def show(message: Warning | str, *_: object, **__: object) -> None:
        text = _CACHE.sub(r"the cache of compiled programs cannot be used, they are compiled again: \1", str(message))
        if text[:_ALIKE] not in shown:
            shown.add(text[:_ALIKE])
            print(f"gbeam: warning: {on_one_line(shortened(text))}", file=sys.stderr)

    warnings.showwarning = show


def abandon_stdout() -> None:
    """Send what is left in the buffer nowhere, so that Python does not fail once more as it exits."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


def _nowhere() -> io.TextIOWrapper:
    return open(os.devnull, "w", encoding="utf-8")


PATIENCE = 2.0  # s


class Watch(Bar):
    """Progress of a command that takes long; a signal that ends the process takes the bar away."""

    def __init__(self, first: str = "compiling") -> None:
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
