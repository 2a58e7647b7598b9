"""The process of the command line: how it begins and ends, and whether it writes figures."""

from __future__ import annotations

import os
import sys

FIGURES = "GBEAM_FIGURES"  # environment: "none" leaves out the files of figures, as where a report draws its own
_own = False


def begin() -> None:
    """Note that this process is the command line's own."""
    global _own
    _own = True


def end_at_once(status: int) -> None:
    """End a process of the command line's own as it is: libraries that lack memory may hang as they are taken down."""
    if _own:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def figures_wanted() -> bool:
    """Whether files of figures are written, which takes most of the time of a short run."""
    return os.environ.get(FIGURES) != "none"
