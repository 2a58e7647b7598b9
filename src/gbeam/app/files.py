"""Files of one folder by their plain names: nothing outside it is read or written."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path

from gbeam.errors import InputError
from gbeam.guards.limits import TEXT_BYTES

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._()-]{0,99}")
LARGEST = TEXT_BYTES  # of one file
MANY = 200  # files


def checked(name: str) -> str:
    """Return the name of a file, if it is one.

    Raises
    ------
    InputError
        If it is a path, begins with a dot, or has characters that a name of a record needs not have.
    """
    if not _NAME.fullmatch(name) or name.endswith((".", " ")):
        raise InputError("file", "has a name that is not taken", "use letters, digits, -, _ and a suffix")
    return name


def regular(folder: Path, name: str) -> Path:
    """Return the path of a file of a folder.

    Raises
    ------
    InputError
        If it is no regular file there: a link leads elsewhere.
    """
    file = folder / checked(name)
    try:
        sound = stat.S_ISREG(file.lstat().st_mode)
    except OSError:
        sound = False
    if not sound:
        raise InputError(name, "is not there", "drop the file on the page first")
    return file


def store(folder: Path, name: str, content: bytes) -> Path:
    """Write a file into a folder, whole or not at all.

    Raises
    ------
    InputError
        If its name is not taken, it is too large, or there are too many.
    """
    file = folder / checked(name)
    if len(content) > LARGEST:
        raise InputError(name, f"has more than {LARGEST // 2**20} MiB", "cut or resample the record")
    folder.mkdir(parents=True, exist_ok=True)
    if len(list(folder.iterdir())) >= MANY:
        raise InputError(name, f"is one too many: {MANY} files are kept", f"delete some in {folder}")
    new = folder / f".{name}.{os.getpid()}"
    # A link of that name is replaced and not followed.
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as opened:
        opened.write(content)
    os.replace(new, file)
    return file


def names(folder: Path) -> list[str]:
    """The regular files of a folder."""
    if not folder.is_dir():
        return []
    every = (each for each in folder.iterdir() if _NAME.fullmatch(each.name))
    return sorted(each.name for each in every if stat.S_ISREG(each.lstat().st_mode))
