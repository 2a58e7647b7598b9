"""Standard output and error: closed, full, or without a character that is printed."""

from __future__ import annotations

import io
import os
import sys


def prepare() -> bool:
    """Make both streams fit to print on, and return whether there is a standard output.

    Where one is closed (``gbeam ... >&-``) the next file opened would take its number, and be printed into.
    """
    given = sys.stdout is not None
    if sys.stdin is None or sys.stdout is None or sys.stderr is None:
        while os.open(os.devnull, os.O_RDWR) < 2:
            pass
        sys.stdout = sys.stdout or _nowhere()
        sys.stderr = sys.stderr or _nowhere()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without µ or ² is no reason to fail
    return given


def abandon_stdout() -> None:
    """Send what is left in the buffer nowhere, so that Python does not fail once more as it exits."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


def _nowhere() -> io.TextIOWrapper:
    return open(os.devnull, "w", encoding="utf-8")
