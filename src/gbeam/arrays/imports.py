"""SciPy imported without what it copies of NumPy and never reads."""

from __future__ import annotations

import sys
from typing import Any

_own = False


def in_own_process() -> None:
    """Note that the process is gbeam's own, whose user imports nothing in it."""
    global _own
    _own = True


def import_scipy() -> None:
    """Import `scipy.linalg`; in a process of gbeam's own without NumPy's modules that nobody has asked for.

    SciPy copies every name of NumPy, and NumPy imports a module when its name is read: what it tests itself with, the
    reader of Fortran and what those import take a third of the time of SciPy's import.
    """
    if not _own or "scipy.linalg" in sys.modules:
        return
    import numpy

    space = vars(numpy)
    given: dict[str, Any] = {name: space[name] for name in ("__all__", "__dir__") if name in space}
    there = list(space)
    space |= {"__all__": [name for name in numpy.__all__ if name in space], "__dir__": lambda: there}
    try:
        import scipy.linalg  # noqa: F401
    finally:
        space |= given
