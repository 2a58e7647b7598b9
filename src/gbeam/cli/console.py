"""Progress on stderr: what is done, its share and the time left."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING

from gbeam.cli.interrupts import cleaned_up
from gbeam.printable import on_one_line

if TYPE_CHECKING:
    from rich.progress import Progress


INTERVAL = "GBEAM_PROGRESS"  # environment: seconds between lines, for programs that read them, on a terminal too
FILE = "GBEAM_PROGRESS_FILE"  # environment: the file that has the last line, in place of stderr
PATIENCE = 2.0  # s without a sign of life that need no explanation
EVERY = 5.0  # s between lines where stderr is not a terminal
_REDRAW = 0.1  # s


class Watch:
    """Progress of a computation that takes long: a bar on a terminal, else a plain line every few seconds.

    Call it with what is being done and the fraction done; use it as a context.

    Parameters
    ----------
    first : str
        What is being done until it is called.
    """

    def __init__(self, first: str = "compiling") -> None:
        self._now = (first, 0.0)
        self._since = monotonic()  # when that was begun
        self._over = Event()
        # A thread, not a look at the clock in __call__: the long silence is compilation, before the first call.
        self._thread = Thread(target=self._show, daemon=True)
        self._bar: Progress | None = None
        self._cleaned_up = cleaned_up(self._stop)

    def __call__(self, what: str, share: float) -> None:
        """Show that `share` of `what` is done."""
        before, done = self._now
        if what != before or share < done:
            self._since = monotonic()
        self._now = what, share

    def line(self) -> str:
        """What is done, its share and the time left, as far as they are known."""
        what, share = self._now
        if not share:
            return on_one_line(what)
        return f"{on_one_line(what)}: {share:.0%}{_left(monotonic() - self._since, share)}"

    def _show(self) -> None:
        every = _interval()
        if self._over.wait(PATIENCE if every is None else every):
            return
        if sys.stderr.isatty() and every is None:
            self._draw()
            return
        while True:
            self._say()
            if self._over.wait(EVERY if every is None else every):
                return

    def _say(self) -> None:
        file = os.environ.get(FILE)
        if not file:
            print(f"gbeam: {self.line()}", file=sys.stderr, flush=True)
            return
        with suppress(OSError):  # progress is not worth a failure
            Path(file).write_text(f"{self.line()}\n", encoding="utf-8")

    def _draw(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        text = TextColumn("{task.description}", markup=False)
        self._bar = Progress(text, BarColumn(), console=Console(stderr=True), transient=True)
        task = self._bar.add_task("", total=1.0)
        self._bar.start()
        while not self._over.wait(_REDRAW):
            share = self._now[1]
            self._bar.update(task, description=self.line(), completed=share, total=1.0 if share else None)

    def _stop(self) -> None:
        self._over.set()
        if self._bar is not None:
            self._bar.stop()  # which shows the cursor again

    def __enter__(self) -> Watch:
        self._cleaned_up.__enter__()
        if sys.stderr is not None:
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()  # it may be starting the bar at this moment
        self._stop()
        self._cleaned_up.__exit__(kind, error, trace)


def _interval() -> float | None:
    """What the environment says of it; None where it says nothing that is a time."""
    try:
        return max(float(os.environ.get(INTERVAL, "")), 0.1)
    except ValueError:
        return None


def _left(passed: float, share: float) -> str:
    """Time left in words, once enough is done to say."""
    if share < 0.02 or passed < 1:
        return ""
    left = passed * (1 - share) / share
    return f", {left:.0f} s left" if left < 100 else f", {left / 60:.0f} min left"
