"""Reading of foreign files in a process of its own, with limits of memory and time; and locks between processes.

The libraries in C that read MAT, HDF5 and netCDF trust their input: a few wrong bytes crash the process, keep it busy
forever, or fill the memory. In a process of its own that becomes an error with a message.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from contextvars import ContextVar
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from threading import BoundedSemaphore
from typing import IO, Any

from gbeam.errors import ComputationError, InputError
from gbeam.guards.importing import variables
from gbeam.guards.limits import (
    BINARY_BYTES,
    READER_BYTES,
    READER_RATE,
    READER_SECONDS,
    UPLOAD_BYTES,
    UPLOAD_RATE,
    UPLOAD_SECONDS,
    UPLOAD_TIMES,
    UPLOADS_READ,
    end_with_parent,
    in_bytes,
    restrict,
)
from gbeam.guards.packing import read_packed, write_packed

_START = "from gbeam.guards.processes import serve; serve()"
_PATIENCE = 6  # wall-clock time over processor time, for a slow disk or a busy machine
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_OUT_OF_MEMORY = 77  # exit status
_TIGHT = ContextVar("tight", default=False)
_AT_ONCE = BoundedSemaphore(UPLOADS_READ)


def read_confined(
    reader: Callable[..., Any],
    path: str | os.PathLike[str],
    *arguments: Any,
    refuse: Callable[[str], InputError],
    memory: int | None = None,
    seconds: int | None = None,
) -> Any:
    """Return ``reader(path, *arguments)``, called in a process of its own with limits of `memory`, bytes, and processor
    time, `seconds`, which grow with the file. `refuse` makes the error of a file that exceeds them or ends the process.
    """
    size = os.stat(path).st_size
    memory = (memory or READER_BYTES) + 3 * size
    seconds = (seconds or READER_SECONDS) + size // READER_RATE
    if _TIGHT.get():
        memory = min(memory, UPLOAD_BYTES + UPLOAD_TIMES * size)
        seconds = min(seconds, UPLOAD_SECONDS + size // UPLOAD_RATE)
    function = [reader.__module__, reader.__qualname__]
    request = json.dumps([os.getpid(), memory, seconds, function, [os.fspath(path), *arguments]]).encode()
    with _AT_ONCE if _TIGHT.get() else nullcontext(), tempfile.TemporaryFile() as reply:
        try:
            status = subprocess.run(
                [sys.executable, "-P", "-c", _START],
                input=request,
                stdout=reply,
                stderr=subprocess.DEVNULL,
                env=os.environ | variables() | _ONE_THREAD,
                timeout=_PATIENCE * seconds,
                check=False,
            ).returncode
        except subprocess.TimeoutExpired:
            raise refuse(f"is not read within {_PATIENCE * seconds} s") from None
        if status == 1:  # Python's own
            reason = f"is there no memory for it, or no room in {tempfile.gettempdir()}?"
            raise ComputationError("not read", f"the process that reads {path} ended: {reason}")
        if status == _OUT_OF_MEMORY:
            raise refuse(f"takes more than {in_bytes(memory)} of memory to read")
        if status == -getattr(signal, "SIGXCPU", 0):
            raise refuse(f"takes more than {seconds} s of processor time to read")
        if status:
            name = next((kind.name for kind in signal.Signals if kind == -status), f"status {status}")
            raise refuse(f"is damaged: it ends the library that reads it ({name})")
        reply.seek(0)
        outcome, answer, messages = read_packed(reply)
    for message in messages:
        warnings.warn(message, stacklevel=2)
    if outcome == "refused":
        raise InputError(*answer)
    if outcome == "defect":
        raise RuntimeError(f"{path} cannot be read\n{answer}")
    return answer


_ELSEWHERE = "the caller"  # place of an error that the caller's `refuse` makes


def read_cached(
    reader: Callable[..., Any],
    path: str | os.PathLike[str],
    *arguments: Any,
    refuse: Callable[[str], InputError],
    **limits: int,
) -> Any:
    """Return what :func:`read_confined` does, or did or refused of the same content before; `arguments` are hashable.

    The cases of a sweep have one record or mesh, as have the edits of a scenario.
    """
    content = file_digest(path)
    if content is None:
        return read_confined(reader, path, *arguments, refuse=refuse, **limits)
    answer = _read_cached(reader, os.fspath(path), arguments, content, tuple(limits.items()), _TIGHT.get())
    if isinstance(answer, InputError):
        raise refuse(answer.problem) if answer.where == _ELSEWHERE else answer.with_traceback(None)
    return answer


@lru_cache(maxsize=4)
def _read_cached(
    reader: Callable[..., Any],
    path: str,
    arguments: tuple[Any, ...],
    content: str,
    limits: tuple[tuple[str, int], ...],
    tight: bool,
) -> Any:
    """Return the answer of a reader, or the error that the file cannot be read by. `content` tells files apart."""

    def refuse(problem: str) -> InputError:
        return InputError(_ELSEWHERE, problem, "")

    try:
        return read_confined(reader, path, *arguments, refuse=refuse, **dict(limits))
    except InputError as error:
        return error


def file_digest(path: str | os.PathLike[str]) -> str | None:
    """Return the SHA-256 of a file in hexadecimal digits, or None if it is no file, is too large, or cannot be read."""
    try:
        if not os.path.isfile(path) or os.path.getsize(path) > BINARY_BYTES:
            return None
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


@contextmanager
def upload_limits() -> Iterator[None]:
    """Read files in this context, such as those that an app is sent, within the limits of uploads."""
    token = _TIGHT.set(True)
    try:
        yield
    finally:
        _TIGHT.reset(token)


def serve() -> None:
    """Answer the request on standard input, in JSON, by arrays as a file of NumPy on standard output."""
    parent, memory, seconds, (module, name), arguments = json.load(sys.stdin)
    end_with_parent(parent)
    restrict(memory, seconds)
    try:
        with os.fdopen(os.dup(1), "wb") as reply, warnings.catch_warnings(record=True) as caught:
            os.dup2(2, 1)  # libraries may print: not into the answer
            _send(*_answer(module, name, arguments), caught, reply)
    except MemoryError:
        os._exit(_OUT_OF_MEMORY)
    os._exit(0)  # at once: nothing has to be cleaned up


def _answer(module: str, name: str, arguments: Sequence[Any]) -> tuple[str, Any]:
    """Outcome of a call, done, refused or defect, and its value, the parts of its InputError, or its traceback."""
    try:
        return "done", getattr(import_module(module), name)(*arguments)
    except InputError as error:
        return "refused", [error.where, error.problem, error.fix]
    except MemoryError:
        raise
    except Exception:
        from traceback import format_exc

        return "defect", format_exc()


def _send(outcome: str, answer: Any, caught: Iterable[warnings.WarningMessage], reply: IO[bytes]) -> None:
    write_packed(reply, [outcome, answer, [str(warning.message) for warning in caught]])


_TAKEN = (errno.EAGAIN, errno.EACCES, errno.EDEADLK)
_BEYOND = 2**30  # offset of the byte that Windows locks, which then cannot be read


@contextmanager
def hold_lock(file: Path, where: str, fix: str) -> Iterator[None]:
    """Hold a lock file, with this process's name in it; InputError, with the holder's, if another process holds it."""
    try:
        handle = os.open(file, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise InputError(where, f"{file} cannot be written ({error.strerror})", "name another folder") from None
    try:
        if not _lock(handle):
            holder = os.read(handle, 200).decode(errors="replace").strip() or "another process"
            raise InputError(where, f"{file.parent} is in use by {holder}", fix)
        with suppress(OSError):  # a full disk: the lock holds
            os.ftruncate(handle, 0)
            os.write(handle, f"process {os.getpid()} on {platform.node() or 'this computer'}\n".encode())
        yield
    finally:
        os.close(handle)


def _lock(handle: int) -> bool:
    """Lock a file until it is closed; return false if it is locked, true also if the file system has no locks."""
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
