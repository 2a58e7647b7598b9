"""Progress on stderr, and interruption."""

from __future__ import annotations

import signal
import sys
from threading import Timer
from types import FrameType, TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE = 2.0  # s without a sign of life that need no explanation


class Watch:
    """A progress bar on stderr that appears only on a terminal, and only when the computation takes long.

    Call it with what is being done and the fraction done; use it as a context, in the main thread. Inside, Ctrl-C is
    sure to end the computation: JAX runs Python callbacks that swallow a KeyboardInterrupt raised in them.
    """

    def __init__(self) -> None:
        self._bar: Progress | None = None
        self._done = ("compiling", 0.0)
        # A timer, not a look at the clock in __call__: the long silence is compilation, before the first call.
        self._timer = Timer(PATIENCE, self._draw) if sys.stderr.isatty() else None
        self._interrupted = False
        self._before = signal.getsignal(signal.SIGINT)

    def __call__(self, what: str, share: float) -> None:
        """Show that `share` of `what` is done."""
        self._stop_if_interrupted()
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

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self._interrupted = True
        raise KeyboardInterrupt

    def _stop_if_interrupted(self) -> None:
        if self._interrupted:
            raise KeyboardInterrupt

    def __enter__(self) -> Watch:
        signal.signal(signal.SIGINT, self._interrupt)
        if self._timer is not None:
            self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        signal.signal(signal.SIGINT, self._before)
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()  # it may be starting the bar at this moment
            if self._bar is not None:
                self._bar.stop()
        self._stop_if_interrupted()
