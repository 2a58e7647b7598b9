"""Folders that processes import from: never the current one, in which files from elsewhere lie.

Python puts it first on its path for ``-m``, ``-c``, an interactive session and an empty entry of PYTHONPATH: a record
called numpy.py would be run.
"""

from __future__ import annotations

import os
import sys

HOME = os.path.abspath(os.path.join(__file__, *[os.pardir] * 3))  # where gbeam lies, and often what it needs


def path_without(*folders: str) -> list[str]:
    """Return the path of this process without folders, of which gbeam's own stays, and without relative entries."""
    path = []
    for entry in sys.path:
        if not isinstance(entry, str) or not os.path.isabs(entry):
            continue
        if _is_same_file(entry, HOME) or not any(_is_same_file(entry, folder) for folder in folders):
            path.append(entry)
    return path


def path_of_children() -> list[str]:
    """Return the path of this process without the current folder and that of its script."""
    script = os.path.dirname(getattr(sys.modules["__main__"], "__file__", None) or "")
    return path_without(os.curdir, script or os.curdir)


def variables() -> dict[str, str]:
    """Return variables of the environment by which processes of Python that this one starts, and theirs, import from
    that path alone.
    """
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": os.pathsep.join(path_of_children())}


def _is_same_file(entry: str, path: str) -> bool:
    try:
        return os.path.samefile(entry, path)
    except OSError:  # one of them is not there
        return False
