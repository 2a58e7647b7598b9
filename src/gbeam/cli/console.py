"""Progress of a command."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from gbeam.cli.interrupts import cleaned_up
from gbeam.progress import Bar

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
