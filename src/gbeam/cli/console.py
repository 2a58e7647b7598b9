"""What is shown on the terminal: results on stdout, progress on stderr."""

from __future__ import annotations

import signal
import sys
from threading import Timer
from types import FrameType, TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

PATIENCE = 2.0  # s without a sign of life that nobody minds
_PLAIN_WIDTH = 110  # columns where stdout is a file


def stdout() -> Console:
    """Console for results: as wide as the terminal, and as wide on paper as a table needs."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else _PLAIN_WIDTH)


class Watch:
    """A progress bar on stderr that appears only on a terminal, and only when it takes long.

    Call it with what is being done and the fraction done; use it as a context, in the main thread. Inside, Ctrl-C is
    sure to end the computation: JAX runs Python callbacks that swallow a KeyboardInterrupt raised in them.
    """

    def __init__(self) -> None:
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=Console(stderr=True),
            transient=True,
        )
        self._task = self._bar.add_task("compiling", total=None)
        # A timer, not a look at the clock in __call__: the long silence is compilation, before the first call.
        self._timer = Timer(PATIENCE, self._bar.start) if sys.stderr.isatty() else None
        self._interrupted = False
        self._before = signal.getsignal(signal.SIGINT)

    def __call__(self, what: str, share: float) -> None:
        """Show that `share` of `what` is done."""
        self._stop_if_interrupted()
        self._bar.update(self._task, description=what, completed=share, total=1.0)

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
            self._bar.stop()
        self._stop_if_interrupted()
