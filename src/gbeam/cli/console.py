"""Progress on stderr."""

from __future__ import annotations

import sys
from threading import Timer
from types import TracebackType
from typing import TYPE_CHECKING

from gbeam.cli.interrupts import cleaned_up

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE = 2.0  # s without a sign of life that need no explanation


class Watch:
    """A progress bar on stderr that appears only on a terminal, and only when the computation takes long.

    Call it with what is being done and the fraction done; use it as a context.
    """

    def __init__(self) -> None:
        self._bar: Progress | None = None
        self._done = ("compiling", 0.0)
        # A timer, not a look at the clock in __call__: the long silence is compilation, before the first call.
        self._timer = Timer(PATIENCE, self._draw) if sys.stderr.isatty() else None
        self._cleaned_up = cleaned_up(self._stop)

    def __call__(self, what: str, share: float) -> None:
        """Show that `share` of `what` is done."""
        self._done = what, share
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], description=what, completed=share, total=1.0)

    def _draw(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        bar = Progress(*columns, console=Console(stderr=True), transient=True)
        what, share = self._done
        task = bar.add_task(what, total=1.0 if share else None)
        bar.update(task, completed=share)
        bar.start()
        self._bar = bar

    def _stop(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        if self._bar is not None:
            self._bar.stop()  # which shows the cursor again

    def __enter__(self) -> Watch:
        self._cleaned_up.__enter__()
        if self._timer is not None:
            self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()  # it may be starting the bar at this moment
        self._stop()
        self._cleaned_up.__exit__(kind, error, trace)
