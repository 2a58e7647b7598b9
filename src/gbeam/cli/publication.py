"""Files in the folder of ``--out``: all of them whole, or none, whatever ends the run or fills the disk."""

from __future__ import annotations

import os
import platform
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from gbeam.cli.process import cleaned_up, deferred
from gbeam.errors import ComputationError, InputError

_HIDDEN = ".gbeam-"
_DEAD = 3600.0  # s: writing takes seconds; a hidden folder of another computer that is older was left behind
_PLOTS = (".png", ".svg")


def refuse_unwritable(folder: Path) -> None:
    """Raise InputError if `folder` can be neither written to nor made, before an hour is spent computing."""
    try:
        parent = folder.absolute()
        while not parent.exists():
            parent = parent.parent
        sound, problem = parent.is_dir(), f"{parent} is not a folder"
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        sound, problem = False, getattr(error, "strerror", None) or str(error)
    if not sound or not os.access(parent, os.W_OK | os.X_OK):
        problem = f"you may not write to {parent}" if sound else problem
        raise InputError("--out", f"{folder}: {problem}", "name a folder that can be written to")


def publish(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Let `make` write files into a hidden folder, then move them into `folder`, and return them by name.

    Plots that the same command made before and does not make now are removed. Files that cannot be written are a
    ComputationError (``not written``), whose message says where they are instead, if anywhere.
    """
    try:
        return _published(folder, make)
    except OSError as error:
        problem = f"{folder}: {error.strerror or error}"
    # A computation may have taken an hour: the folder for temporary files is often on another disk.
    refuge = Path(tempfile.gettempdir()) / f"gbeam-result-{os.getpid()}"
    try:
        _published(refuge, make)
    except OSError as error:
        where = f"nor to {refuge}: {error.strerror or error}"
    else:
        where = f"and are in {refuge} instead"
    raise ComputationError("not written", f"the files could not be written to {problem}, {where}")


def _published(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Make files in a hidden folder, then move them into the folder at once."""
    new = not folder.exists()
    parent = folder.absolute().parent if new else folder
    parent.mkdir(parents=True, exist_ok=True)
    _remove_dead(parent)
    with _hidden_in(parent) as hidden:
        make(hidden)
        names = sorted(file.name for file in hidden.iterdir())
        _synchronise(hidden)
        with deferred(), _alone_in(parent):
            if not (new and _moved_whole(hidden, folder)):
                for name in names:
                    os.replace(hidden / name, folder / name)
                _remove_plots_before(folder, set(names))
    return [folder / name for name in names]


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Wait for another run that moves files into the same folder: the files of one run stay together."""
    if os.name != "posix":
        yield
        return
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


@contextmanager
def _hidden_in(parent: Path) -> Iterator[Path]:
    """A new folder whose name says which process it belongs to; removed in the end, if it is still there."""
    hidden = Path(tempfile.mkdtemp(prefix=f"{_HIDDEN}{_computer()}-{os.getpid()}-", dir=parent))
    remove = partial(shutil.rmtree, hidden, ignore_errors=True)
    with cleaned_up(remove):
        try:
            yield hidden
        finally:
            remove()


def _remove_dead(parent: Path) -> None:
    """Remove the hidden folders of runs that were killed."""
    ours = re.compile(rf"{re.escape(_HIDDEN + _computer())}-(\d+)-[^-]+")
    for left in parent.glob(f"{_HIDDEN}*"):
        match = ours.fullmatch(left.name)
        with suppress(OSError):
            dead = not _runs(int(match[1])) if match and os.name == "posix" else False
            if dead or time.time() - left.stat().st_mtime > _DEAD:
                shutil.rmtree(left, ignore_errors=True)


def _computer() -> str:
    return re.sub(r"[^A-Za-z0-9]", "", platform.node())[:40] or "computer"


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        pass  # somebody else's
    return True


def _moved_whole(hidden: Path, folder: Path) -> bool:
    """Rename the hidden folder; False if another run has made `folder` in the meantime."""
    mask = os.umask(0)
    os.umask(mask)
    os.chmod(hidden, 0o777 & ~mask)  # mkdtemp's are for their owner only
    try:
        os.rename(hidden, folder)
    except OSError:
        if folder.is_dir():
            return False
        raise
    return True


def _synchronise(folder: Path) -> None:
    """Wait until the files are on the disk: what is renamed before it is written may be empty after a power failure."""
    for file in folder.iterdir():
        with file.open("rb+") as opened:
            os.fsync(opened.fileno())


def _remove_plots_before(folder: Path, names: set[str]) -> None:
    """Remove plots signed by the command that made the files `names`, under their own names, and not among them."""
    if not any(name.endswith(_PLOTS) for name in names):
        return
    from gbeam.plots import signature

    commands = {signature(folder / name) for name in names if name.endswith(_PLOTS)} - {""}
    for file in folder.iterdir():
        if file.suffix in _PLOTS and file.name not in names and file.is_file() and signature(file) in commands:
            file.unlink()
