"""The entry of the command line. It imports the rest when it runs, so that signals can be set up first."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line on arguments, by default the process's, and return its exit status.

    0 done, 1 the computation failed and said why, 2 the input is wrong and it said where, 3 a defect of gbeam; a
    process that a signal ends has 130 (interrupted) or 143 (terminated). These hold where a pipe is closed that reads
    the output, too. The process's own takes the current folder off the path that it imports from.
    """
    if argv is not None:
        return _status(list(argv))
    _leave_current_folder()
    from gbeam.cli.process import end_on_signals, ignore_signals

    end_on_signals()
    from gbeam.cli.process import shorten_warnings

    shorten_warnings()
    from gbeam.cli.process import begin

    begin()
    _leave_settings_of_plots()
    status = _status(sys.argv[1:])
    ignore_signals()  # all is written and printed
    return status


def _leave_current_folder() -> None:
    """Import from the current folder no longer."""
    from gbeam.guards.importing import path_without

    sys.path[:] = path_without(os.curdir)


def _leave_settings_of_plots() -> None:
    """Let Matplotlib read its settings now, and not those in the current folder, which can run programs."""
    if os.path.exists("matplotlibrc"):  # LaTeX, and up to version 3.10.8 any code
        from contextlib import chdir

        from gbeam.guards.importing import HOME

        with chdir(HOME):
            import matplotlib  # noqa: F401


def limited() -> int:
    """Run the command line with limits, the process's first two arguments: memory, bytes, and processor time, s."""
    from gbeam.guards.limits import restrict

    memory, seconds = (int(sys.argv.pop(1)) for _ in range(2))
    restrict(memory, seconds)
    return main()


def _status(arguments: list[str]) -> int:
    """Run a verb and return its exit status, 1 if its output could not be printed."""
    from gbeam.cli import process as streams

    has_stdout = streams.prepare()
    from gbeam.cli.failures import FAILED, complain
    from gbeam.cli.program import run

    try:
        status = run(arguments)
        sys.stdout.flush()
        error = streams.error_of_stdout()
    except OSError as unwritten:  # or unread: a file
        error, status = unwritten, FAILED
    if error is not None and not isinstance(error, BrokenPipeError):  # `gbeam run ... | head` has read enough
        complain(str(error))
        return FAILED
    if not has_stdout and status == 0:
        complain("standard output is closed: the answer could not be printed")
        return FAILED
    return status
