"""What a process of the command line's own goes without: it lives for seconds, and no documentation is read in it."""

from __future__ import annotations

import gc
import os
import sys

_MADE = 20_000  # objects between two looks for circles of unused ones: Python's own 700 suit a smaller heap
FIGURES = "GBEAM_FIGURES"  # environment: "none" leaves out the files of figures, as where a report draws its own
_own = False


def begin() -> None:
    """Look seldom for objects that only keep one another, a twentieth of a run; note whose process it is."""
    global _own
    gc.set_threshold(_MADE, 20, 10)
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


def import_plots() -> None:
    """Import `gbeam.plots`; in a process of the command line's own without matplotlib's documentation.

    As it is imported, matplotlib reads the setters of all its artists to write the docstring and the signature of every
    `Artist.set`, which takes a quarter of that time.
    """
    if _own:
        from matplotlib import artist

        class Undocumented(artist.ArtistInspector):
            def get_aliases(self) -> dict[str, set[str]]:
                return {}

            def get_setters(self) -> list[str]:
                return []

        vars(artist).update(ArtistInspector=Undocumented, kwdoc=lambda _: "")
    import gbeam.plots.figures  # noqa: F401
