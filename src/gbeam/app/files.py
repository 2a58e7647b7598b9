"""Files of one folder by their names, without a path, readable for their owner only."""

from __future__ import annotations

import errno
import os
import re
import shutil
import stat
from collections.abc import Callable
from importlib.resources import files as resources
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO, TypeVar

from gbeam.errors import InputError
from gbeam.guards.limits import TEXT_BYTES
from gbeam.io.binary import READERS as RECORDS
from gbeam.io.kept import write_whole
from gbeam.io.models.arrays import STATE_SPACES
from gbeam.io.models.registry import READERS as MODELS
from gbeam.motion.records.text import ENDINGS as TEXTS
from gbeam.scenario.template import template
from gbeam.scenario.text.revise import with_entry
from gbeam.solids.foreign import MESHES
from gbeam.structure.matrices import PROGRAMS

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._()-]{0,99}")
_SECTIONS = (program.ending.lower() for program in PROGRAMS.values())
READ = tuple(sorted({*TEXTS, *RECORDS, *MODELS, *MESHES, *STATE_SPACES, *_SECTIONS}))  # endings of files in scenarios
_NEW = ".new-"  # begins the names of folders with what is not kept yet
LARGEST = TEXT_BYTES  # of one file
MANY = 200  # files
# Errors that may pass: disk, descriptors or memory are used up.
SHORT = {errno.ENOSPC, errno.EDQUOT, errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN}

T = TypeVar("T")


def checked(name: str) -> str:
    """Return a name if it is a plain one of a file; raise InputError otherwise."""
    if not _NAME.fullmatch(name) or name.endswith((".", " ")):
        raise InputError("file", "has a name that is not taken", "use letters, digits, -, _ and a suffix")
    return name


def check_kind(name: str) -> str:
    """Return a plain name of a kind of file that scenarios name; raise InputError for any other."""
    ending = Path(checked(name)).suffix
    if ending.lower() not in READ:
        raise InputError(name, f"ends in {ending or 'nothing'}", f"rename it by what it is: {', '.join(READ)}")
    return name


def regular(folder: Path, name: str) -> Path:
    """Return the path of a regular file of a folder; InputError if there is none."""
    file = folder / checked(name)
    if not _is_regular(file):
        raise InputError(name, "is not there", "drop the file on the page first")
    return file


def ensure_folder(folder: Path) -> Path:
    """Make a folder for its owner only, unless it exists; return it."""
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    return folder


def private(file: Path) -> BinaryIO:
    """Open a new file for writing, for its owner only; an existing one is replaced."""
    file.unlink(missing_ok=True)
    return os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb")


def write(file: Path, content: bytes) -> None:
    """Write a file for its owner only, whole or not at all."""
    write_whole(file, content, private=True)


def store(folder: Path, name: str, content: bytes, read: Callable[[Path], T]) -> T:
    """Write a file of a known kind into a folder once `read` has read it; return its answer. InputError if it refuses,
    or the file is too large or one too many.
    """
    check_kind(name)
    if len(content) > LARGEST:
        raise InputError(
            name, f"has more than {LARGEST // 2**20} MiB", "cut or resample the record, or mesh more coarsely"
        )
    if len(names(ensure_folder(folder))) >= MANY:
        raise InputError(name, f"is one too many: {MANY} files are kept", f"delete some in {folder}")
    with TemporaryDirectory(prefix=_NEW, dir=folder) as hidden:
        file = Path(hidden) / name
        write(file, content)
        try:
            answer = read(file)
        except InputError as error:
            raise InputError(error.where, error.problem.replace(os.fspath(file), name), error.fix) from None
        os.replace(file, folder / name)
    return answer


def tidy(folder: Path) -> None:
    """Remove what an earlier server left in a folder as it ended."""
    for incomplete in folder.glob(f"{_NEW}*"):
        shutil.rmtree(incomplete, ignore_errors=True)


def names(folder: Path) -> list[str]:
    """Return the names of the regular files of a folder, or empty if it does not exist."""
    try:
        return sorted(entry.name for entry in folder.iterdir() if _NAME.fullmatch(entry.name) and _is_regular(entry))
    except (FileNotFoundError, NotADirectoryError):
        return []


def _is_regular(file: Path) -> bool:
    try:
        return stat.S_ISREG(file.lstat().st_mode)
    except (FileNotFoundError, NotADirectoryError, ValueError):  # ValueError: a null character in its name
        return False


_TEMPLATES = {
    "Flight and centrifuge": "flight",
    "Box on a plain arm": "arm",
    "Hub": "hub",
    "System of bodies": "system",
}
_FLOWN = "F-16 turn of 8 g, with its record"
_SCENARIO, _RECORD = "f16_8g_turn.toml", "f16_8g_turn.csv"
EXAMPLES = ("Flight and centrifuge", _FLOWN, "Box on a plain arm", "Hub", "System of bodies")


def example(name: str, records: Path) -> str:
    """Return the text of an example, after storing its record, if any, in the folder."""
    if name in _TEMPLATES:
        return template(_TEMPLATES[name])
    if name != _FLOWN:
        raise InputError("example", f"is {name[:100]!r}", f"choose of {', '.join(EXAMPLES)}")
    record = _store_record(_shipped(_RECORD).read_bytes(), records)
    return with_entry(_shipped(_SCENARIO).read_text(encoding="utf-8"), ("motion", "flight", "record", "file"), record)


def _shipped(name: str) -> Traversable:
    """A file of the examples, from the installed package, or from the source tree."""
    packed = resources("gbeam.app") / "shipped" / name
    tree = Path(__file__).parents[3] / "examples"
    return packed if packed.is_file() else next(tree.rglob(name))


def _store_record(content: bytes, records: Path) -> str:
    """Store a record, under another name if its own is taken; return the name."""
    for name in (_RECORD, f"example {_RECORD}"):
        try:
            if regular(records, name).read_bytes() == content:
                return name
        except InputError:  # no such file
            return store(records, name, content, lambda file: file.name)
    raise InputError(_RECORD, "is there already, and is another record", f"rename it in {records}")
