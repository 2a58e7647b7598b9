"""Files written whole or not at all, and values that took long to compute, kept by the hash of their source."""

from __future__ import annotations

import hashlib
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from tempfile import mkstemp
from time import monotonic
from typing import Any, TypeVar

from platformdirs import user_cache_path

from gbeam.guards.packing import digest, read_packed, write_packed
from gbeam.progress import PATIENCE, Bar
from gbeam.results.provenance import current_environment

FOLDER = "GBEAM_CACHE"  # environment: the folder that keeps it, or "off"
WORTH = 1.0  # s: what is computed sooner is not kept
MOST = 2 * 2**30  # bytes of all files: those unused for longest go
_ENDING = ".kept"
_KEEPING = ContextVar("keeping", default=True)

T = TypeVar("T")


def write_whole(path: str | os.PathLike[str], *data: bytes | memoryview, private: bool = False) -> None:
    """Write a file under another name beside it, and rename it once it is on the disk; OSError if that cannot be.

    A link at its place is replaced and not followed. A private file is for its owner only.
    """
    final = Path(path)
    handle, name = mkstemp(prefix=f".{final.name}-", dir=final.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.writelines(data)
            file.flush()
            os.fsync(file.fileno())
        if not private:  # as mkstemp's files are: a result is as readable as any other new file
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(name, 0o666 & ~mask)
        os.replace(name, final)
    except BaseException:
        os.unlink(name)
        raise


def kept(what: str, kind: type[T], source: Callable[[], Any], make: Callable[[], T]) -> T:
    """Return ``make()``, of a `kind`, or its earlier value for an equal source. `what` is shown if it takes long.

    `source` returns all that the value is made from. If that changes meanwhile, such as a file, nothing is kept.
    """
    folder = _folder()
    key = digest((_program(), source())) if folder else ""
    file = folder and folder / f"{key}{_ENDING}"
    if file:
        with suppress(Exception):  # missing, damaged, of another kind or program: whatever is wrong, it is made again
            if isinstance(earlier := _read(file, key), kind):
                return earlier
    began = monotonic()
    with Bar(what, patience=PATIENCE):
        value = make()
    if file and _KEEPING.get() and monotonic() - began > WORTH:
        with suppress(OSError):  # a full disk is no error
            if digest((_program(), source())) == key:
                _write(file, key, value)
    return value


@contextmanager
def unkept() -> Iterator[None]:
    """Keep no value that is computed in this context, such as trials of a search, which would displace all else."""
    token = _KEEPING.set(False)
    try:
        yield
    finally:
        _KEEPING.reset(token)


def _folder() -> Path | None:
    """Folder that keeps values. None if it is off, or if other users may write in it, of which a warning says so."""
    choice = os.environ.get(FOLDER, "")
    if choice.strip().lower() in ("off", "0"):
        return None
    folder = Path(choice) if choice else user_cache_path("gbeam") / "models"
    status = _status(folder)
    if status is None or _private(status):
        return folder
    words = f"reduced solids are not kept: others may write in {folder}"
    warnings.warn(f"{words}; let only you write there, or name another folder in {FOLDER}", stacklevel=2)
    return None


def _status(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (OSError, ValueError):
        return None


def _private(status: os.stat_result) -> bool:
    """True if a file or a folder is this user's, and no other user's to write. Windows does not say."""
    return sys.platform == "win32" or (status.st_uid == os.geteuid() and not status.st_mode & 0o022)


@cache
def _program() -> str:
    """Hash of gbeam's own files, versions and platform: what one program made, another does not read."""
    hashed = hashlib.sha256(repr(current_environment()).encode())
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        hashed.update(file.read_bytes())
    return hashed.hexdigest()


def _read(file: Path, key: str) -> Any:
    """Value in a file. An error is raised if it is damaged, another user's, or kept under another key."""
    with open(file, "rb") as opened:
        if not _private(os.fstat(opened.fileno())):
            raise ValueError(f"{file} may be another user's")
        content = opened.read()
    stated, data = content[:32], memoryview(content)[32:]
    if hashlib.sha256(data).digest() != stated:
        raise ValueError(f"{file} is damaged")
    stored_key, value = read_packed(io.BytesIO(data), records=True)
    if stored_key != key:
        raise ValueError(f"{file} has another name")
    os.utime(file)  # used now
    return value


def _write(file: Path, key: str, value: Any) -> None:
    """Write a file whole or not at all. If all files take too much room remove those not used for longest."""
    data = io.BytesIO()
    write_packed(data, [key, value])
    file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    write_whole(file, hashlib.sha256(data.getbuffer()).digest(), data.getbuffer(), private=True)
    other_files = [(old_file.stat(), old_file) for old_file in file.parent.glob(f"*{_ENDING}") if old_file != file]
    room = MOST - file.stat().st_size
    for status, old_file in sorted(other_files, key=lambda pair: -pair[0].st_mtime):
        room -= status.st_size
        if room < 0:
            old_file.unlink(missing_ok=True)
