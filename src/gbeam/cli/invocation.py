"""The command line that runs, for what its results say of where they come from."""

from __future__ import annotations

import shlex
from contextvars import ContextVar

from gbeam.printable import storable

_TOKENS: ContextVar[tuple[str, ...]] = ContextVar("tokens", default=())


def begin(tokens: list[str]) -> None:
    """Note the arguments after the program's name."""
    _TOKENS.set(tuple(tokens))


def command() -> str:
    """The command line, as a shell takes it; what is no text in it is written out."""
    return storable(shlex.join(["gbeam", *_TOKENS.get()]))
