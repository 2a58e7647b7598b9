"""Progress on stderr: what is done, its share and the time left."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeAlias

from gbeam.printable import on_one_line

if TYPE_CHECKING:
    from rich.progress import Progress as _Drawn

INTERVAL = "GBEAM_PROGRESS"  # environment variable: seconds between lines, which programs read, in place of a bar
FILE = "GBEAM_PROGRESS_FILE"  # environment variable: a file for the last line, in place of stderr
EVERY = 5.0  # s between lines where there is no terminal and no notebook
PATIENCE = 2.0  # s without output that a user of a command accepts
_REDRAW = 0.1  # s
_SHOWN: ContextVar[Bar | None] = ContextVar("shown", default=None)

# Argument of the public functions: called with what is being done and the share of it; True shows a Bar.
Progress: TypeAlias = Callable[[str, float], None] | bool | None


class Bar:
    """Progress of a computation: a bar on a terminal or in a notebook, else a plain line every few seconds.

    Use it as a context, and call it with what is being done (`first` until then) and the fraction done. A sweep calls
    it with the numbers of cases that are done, of those that failed among them, and of all. So many seconds of
    `patience` without a sign of life need no explanation. A bar within another is a step of that one, which shows it.
    """

    def __init__(self, first: str = "computing", *, patience: float = 0.0) -> None:
        self._now = (first, 0.0)
        self._patience = patience
        self._since = monotonic()  # when the current step began
        self._over = Event()
        # A thread, as it may take long until the first call.
        self._thread = Thread(target=self._show, daemon=True)
        self._bar: _Drawn | None = None
        self._outer: Bar | None = None

    def __call__(self, *news: Any) -> None:
        """Note the step and the fraction done, or of a sweep the numbers of cases."""
        if self._outer is not None:
            self._outer(*news)
            return
        stage, share = news if len(news) == 2 else _of_cases(*news)
        previous, done = self._now
        if stage != previous or share < done:
            self._since = monotonic()
        self._now = stage, share

    def line(self) -> str:
        """Step under way, its share and the time left, as far as they are known."""
        stage, share = self._now
        if not share:
            return on_one_line(stage)
        return f"{on_one_line(stage)}: {share:.0%}{_time_left(monotonic() - self._since, share)}"

    def _show(self) -> None:
        """Draw a bar after some patience, or write lines if there is no terminal, until the computation is over."""
        interval = _interval()
        if self._over.wait(self._patience if interval is None else interval):
            return
        if interval is None and (sys.stderr.isatty() or _in_notebook()):
            self._draw()
            return
        while True:
            self._say()
            if self._over.wait(EVERY if interval is None else interval):
                return

    def _say(self) -> None:
        """Write a line on stderr, or into the file that the environment names."""
        file = os.environ.get(FILE)
        if not file:
            print(f"gbeam: {self.line()}", file=sys.stderr, flush=True)
            return
        with suppress(OSError):  # progress is not worth a failure
            Path(file).write_text(f"{self.line()}\n", encoding="utf-8")

    def _draw(self) -> None:
        """Draw a bar until the computation is over."""
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

    def __enter__(self) -> Self:
        self._outer = _SHOWN.get()
        if self._outer is not None:
            self._interrupted = self._outer._now
            self._outer(*self._now)
            return self
        self._token = _SHOWN.set(self)
        if sys.stderr is not None:
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._outer is not None:
            self._outer(*self._interrupted)
            return
        with suppress(ValueError):  # an iterator's, ended in another context than it was begun in
            _SHOWN.reset(self._token)
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()  # it may be starting the bar at this moment
        self._stop()


def tell(progress: Callable[..., None] | bool | None, *news: Any) -> None:
    """Call `progress` if it is a function."""
    if callable(progress):
        progress(*news)


def _of_cases(done: int, failed: int, count: int) -> tuple[str, float]:
    return f"{done} of {count} cases" + (f", {failed} failed" if failed else ""), done / count


def _in_notebook() -> bool:
    if "IPython" not in sys.modules:  # rich need not be imported to know
        return False
    from rich.console import Console

    return Console(stderr=True).is_jupyter


def _interval() -> float | None:
    """Seconds between lines by the environment, or None if it has no such number."""
    try:
        return max(float(os.environ.get(INTERVAL, "")), 0.1)
    except ValueError:
        return None


def _time_left(passed: float, share: float) -> str:
    """Time left in words. Empty before 2 % and a second are done."""
    if share < 0.02 or passed < 1:
        return ""
    remaining = passed * (1 - share) / share
    return f", {remaining:.0f} s left" if remaining < 100 else f", {remaining / 60:.0f} min left"
