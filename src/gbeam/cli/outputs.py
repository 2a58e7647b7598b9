"""Files in the folder of ``--out``: all of them whole, or none."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from gbeam.errors import InputError


def refuse_unwritable(folder: Path) -> None:
    """Raise InputError if `folder` can be neither written to nor made, before an hour is spent computing."""
    try:
        here = folder.absolute()
        while not here.exists():
            here = here.parent
        sound, problem = here.is_dir(), f"{here} is not a folder"
    except OSError as error:
        sound, problem = False, error.strerror or str(error)
    if sound and os.access(here, os.W_OK | os.X_OK):
        return
    raise _unwritable(folder, problem if not sound else f"you may not write to {here}")


def publish(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Let `make` write files into a hidden folder, then move them into `folder`.

    Parameters
    ----------
    folder : Path
        Made if it is not there; files of the same names are replaced.
    make : callable
        Of the folder to write into.

    Returns
    -------
    list of Path
        The files, by name.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=".gbeam-", dir=folder) as hidden:
            make(Path(hidden))
            made = sorted(Path(hidden).iterdir())
            for file in made:
                os.replace(file, folder / file.name)
    except OSError as error:
        raise _unwritable(folder, error.strerror or str(error)) from None
    return [folder / file.name for file in made]


def _unwritable(folder: Path, problem: str) -> InputError:
    return InputError("--out", f"{folder}: {problem}", "name a folder that can be written to")
