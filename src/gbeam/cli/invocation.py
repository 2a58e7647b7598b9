"""The command line that runs, for what its results say of where they come from."""

from __future__ import annotations

import shlex
from contextvars import ContextVar

_TOKENS: ContextVar[tuple[str, ...]] = ContextVar("tokens", default=())


def begin(tokens: list[str]) -> None:
    """Note the arguments after the program's name."""
    _TOKENS.set(tuple(tokens))


def command() -> str:
    """The command line, as a shell takes it."""
    return shlex.join(["gbeam", *_TOKENS.get()])
