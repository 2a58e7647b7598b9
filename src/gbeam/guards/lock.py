"""One process at a time: locks by the operating system, which lets go of them however their process ends."""

from __future__ import annotations

import errno
import os
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from gbeam.errors import InputError

_TAKEN = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)
_BEYOND = 2**30  # where Windows locks a byte: a locked one can't be read


@contextmanager
def alone(file: Path, where: str, fix: str) -> Iterator[None]:
    """Hold a lock file, whose folder exists, and say in it which process does."""
    try:
        handle = os.open(file, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise InputError(where, f"{file} cannot be written ({error.strerror})", "name another folder") from None
    try:
        if not _taken(handle):
            holder = os.read(handle, 200).decode(errors="replace").strip() or "another process"
            raise InputError(where, f"{file.parent} is in use by {holder}", fix)
        with suppress(OSError):  # a full disk: the lock holds
            os.ftruncate(handle, 0)
            os.write(handle, f"process {os.getpid()} on {platform.node() or 'this computer'}\n".encode())
        yield
    finally:
        os.close(handle)


def _taken(handle: int) -> bool:
    """Take the lock of a file, until that is closed; True also where the file system has no locks."""
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(handle, _BEYOND, os.SEEK_SET)
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in _TAKEN
    finally:
        os.lseek(handle, 0, os.SEEK_SET)
    return True
