"""Files written whole or not at all, and values that took long to compute, kept by the hash of their source."""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from tempfile import mkstemp
from time import monotonic
from typing import Any, TypeVar

from platformdirs import user_cache_path

from gbeam.guards.limits import BINARY_BYTES
from gbeam.progress import PATIENCE, Bar
from gbeam.results.provenance import present

FOLDER = "GBEAM_CACHE"  # environment: the folder that keeps it, or "off"
WORTH = 1.0  # s: what is computed sooner is not kept
MOST = 2 * 2**30  # bytes of all files: those unused for longest go
_ENDING = ".kept"
_KEEPING = ContextVar("keeping", default=True)

T = TypeVar("T")


def write_whole(path: str | os.PathLike[str], *data: bytes, private: bool = False) -> None:
    """Write a file under another name beside it, and rename it once it is on the disk; OSError if that cannot be.

    A link at its place is replaced and not followed; a private file is for its owner only.
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


def kept(what: str, source: Any, make: Callable[[], T]) -> T:
    """Return ``make()``, or what it returned for an equal source before; `what` is shown if it takes long."""
    folder = _folder()
    # Pickles of values that are read and built alike are alike; if not, it is made once more.
    file = folder and folder / (hashlib.sha256(_program() + pickle.dumps(source)).hexdigest() + _ENDING)
    if file:
        with suppress(Exception):  # missing, damaged, of another program: whatever is wrong with it, it is made again
            return _read(file)
    began = monotonic()
    with Bar(what, patience=PATIENCE):
        value = make()
    if file and _KEEPING.get() and monotonic() - began > WORTH:
        with suppress(OSError):  # a full disk is no error
            _write(file, value)
    return value


def content_of(file: str | os.PathLike[str]) -> bytes | None:
    """Return the SHA-256 of a file; None if it is no file, is too large, or cannot be read."""
    try:
        if not os.path.isfile(file) or os.path.getsize(file) > BINARY_BYTES:
            return None
        with open(file, "rb") as content:
            return hashlib.file_digest(content, "sha256").digest()
    except OSError:
        return None


@contextmanager
def unkept() -> Iterator[None]:
    """Keep no value that is computed in this context, such as trials of a search, which would displace all else."""
    token = _KEEPING.set(False)
    try:
        yield
    finally:
        _KEEPING.reset(token)


def _folder() -> Path | None:
    named = os.environ.get(FOLDER, "")
    if named.strip().lower() in ("off", "0"):
        return None
    return Path(named) if named else user_cache_path("gbeam") / "models"


@cache
def _program() -> bytes:
    """Hash of gbeam's own files, versions and platform: what one program made, another does not read."""
    files = sorted(Path(__file__).parents[1].rglob("*.py"))
    hashed = hashlib.sha256(repr(present()).encode())
    for file in files:
        hashed.update(file.read_bytes())
    return hashed.digest()


def _read(file: Path) -> Any:
    content = file.read_bytes()
    digest, value = content[:32], memoryview(content)[32:]
    if hashlib.sha256(value).digest() != digest:
        raise ValueError(f"{file} is damaged")
    os.utime(file)  # used now
    return pickle.loads(value)


def _write(file: Path, value: Any) -> None:
    """Write a file whole or not at all, and remove those that were not used for longest."""
    content = pickle.dumps(value)
    file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    write_whole(file, hashlib.sha256(content).digest(), content, private=True)
    others = [(other.stat(), other) for other in file.parent.glob(f"*{_ENDING}") if other != file]
    room = MOST - file.stat().st_size
    for status, other in sorted(others, key=lambda pair: -pair[0].st_mtime):
        room -= status.st_size
        if room < 0:
            other.unlink(missing_ok=True)
