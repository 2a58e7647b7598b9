"""Limits of all input, in one table, and of processes: larger input is refused before it is read or allocated.

Each limit is far beyond a sensible scenario; a refusal says what the input would have cost.
"""

from __future__ import annotations

import json
import os
import stat
import sys
from pathlib import Path
from typing import Any

from gbeam.errors import InputError

WORDS = 2000  # of a command line: the parser takes the square of it

# Text of a scenario.
SCENARIO_BYTES = 2**20  # of a file, or of one override: 50,000 knots; parsing takes a second
NESTING = 32  # tables and lists in one another
KEYS = 1000  # of one table, and tables in one list: motions, masses and loads are the most
NUMBER = 400  # characters of a number: any float has fewer
QUANTITY = 100  # characters of a quantity with its unit
LARGEST, SMALLEST = 1e50, 1e-50  # of any quantity in SI, but zero: products of several are numbers still
TITLE = 200  # characters
NAME = 64  # characters of a motion's name, which becomes a part of file names
PROBLEMS = 50  # explained at once

# Sizes that a scenario asks for.
SHAPES = 40  # in one direction: assembling takes a second
MODES = 1000  # of a reduced model
ENTRIES = 1000  # masses, loads, stations of a section or of the output
NODES = 5000  # of integration along the beam: 12 and four for every shape, between two stations of the section
KNOTS = 500_000  # of a centrifuge's target: about 4 kB each while it is planned
STEPS = 4_000_000  # in time
BOUNDLESS = 1e9  # m, that particles move by at most
WORKERS = 512  # processes of a sweep: each imports gbeam
HISTORY_BYTES = 4 * 10**9  # of a response: coordinates, displacements and loads at every step

# Records of flights.
TEXT_BYTES = 64 * 2**20  # about 25 bytes of memory each
BINARY_BYTES = 512 * 2**20
EMBEDDED = 8 * 2**20  # bytes of one that go with a result; of a larger one only its hash
COLUMNS = 10_000  # of one matrix
ELEMENTS = 32_000_000  # of one array of a file
SAMPLES = 4_000_000

# Limits of a process that reads a file by a library in C, to which three times the file's size, and a second for each
# READER_RATE bytes of it, are added.
READER_BYTES = 2**30  # of address space, of which the libraries take 0.2 GB
READER_SECONDS = 10  # of processor time
READER_RATE = 2**24
# Of one that an app is sent, if they are lower: what few bytes unpack to many is no record and no mesh.
UPLOAD_BYTES, UPLOAD_TIMES = 2**29, 10
UPLOAD_SECONDS, UPLOAD_RATE = 5, 2**22
UPLOADS_READ = 4  # at once
MESHER_BYTES, MESHER_SECONDS = 2**33, 600  # of Gmsh, which meshes what it reads


def refuse_more(where: str, what: str, count: float, most: int, size: float, fix: str) -> None:
    """Raise InputError if `count` is above `most`. Its message has the memory, at `size` bytes, that it would take."""
    if not count <= most:
        raise InputError(where, f"makes {count:.4g} {what}, which would take {in_bytes(count * size)}", fix)


def refuse_large_file(where: str, path: str | os.PathLike[str], most: int, fix: str) -> None:
    """Raise InputError unless `path` is a regular file of at most `most` bytes; OSError if it cannot be accessed."""
    status = os.stat(path)
    if stat.S_ISDIR(status.st_mode):
        raise InputError(where, f"{path} is a folder", "give the path of a file")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(where, f"{path} is a device or a pipe", "save what it holds to a file")
    if status.st_size > most:
        raise InputError(where, f"{path} has {in_bytes(status.st_size)}, and {in_bytes(most)} are read at most", fix)


def in_bytes(count: float) -> str:
    """Return a number of bytes as text: ``24 GB``."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} TB"


def existing(path: Path) -> bool:
    """True if a path exists; False also for one that no file can have."""
    try:
        return path.exists()
    except (OSError, ValueError):  # too long, or with a null character
        return False


_END_WITH_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def restrict(memory: int, seconds: int) -> None:
    """Limit the address space, bytes, and processor time, s, of this process and of programs that replace it.

    Windows has neither limit, and macOS none of memory. Lower inherited limits stay.
    """
    if sys.platform == "win32":
        return
    import resource

    limits = {resource.RLIMIT_CPU: (seconds, seconds + 5), resource.RLIMIT_CORE: (0, 0)}
    if sys.platform != "darwin":
        limits[resource.RLIMIT_AS] = (memory, memory)
    for kind, pair in limits.items():
        inherited = resource.getrlimit(kind)[1]
        soft, hard = (limit if inherited == resource.RLIM_INFINITY else min(limit, inherited) for limit in pair)
        resource.setrlimit(kind, (soft, hard))


def end_with_parent(parent: int) -> None:
    """Have the system kill this process when its parent ends, or end now if it has ended; on Linux only."""
    if sys.platform == "linux":
        import ctypes
        import signal

        ctypes.CDLL(None).prctl(_END_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)


def read_json(file: Path, fix: str) -> dict[str, Any]:
    """Return the JSON object in a file; InputError, with `fix`, if there is none."""
    try:
        refuse_large_file("", file, TEXT_BYTES, fix)
        value = parse_json(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(file), f"cannot be read ({error.strerror})", fix) from None
    except InputError:
        raise
    except ValueError:
        raise InputError(str(file), "is no JSON of a result", fix) from None
    if not isinstance(value, dict):
        raise InputError(str(file), "is not the JSON of a result", fix)
    return value


def parse_json(text: str) -> Any:
    """Return the value of a text of JSON; ValueError if it is wrong or nested too deeply."""
    try:
        value = json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    level = [value]
    for _ in range(NESTING):
        nodes = [node for node in level if isinstance(node, (dict, list))]
        level = [child for node in nodes for child in _children(node)]
        if not level:
            return value
    raise ValueError("nested too deeply")


def _children(node: dict[str, Any] | list[Any]) -> Any:
    return node.values() if isinstance(node, dict) else node
