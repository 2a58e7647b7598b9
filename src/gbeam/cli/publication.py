"""Files in the folder of ``--out``, written all or none, even if the run is killed or the disk is full."""

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
_DEAD = 3600.0  # s: age at which a hidden folder, even of another computer, was left behind; writing takes seconds
_PLOTS = (".png", ".svg")


def refuse_unwritable(folder: Path) -> None:
    """Raise InputError if `folder` can be neither written to nor made, so that no hour is spent computing in vain."""
    try:
        parent = folder.absolute()
        while not parent.exists():
            parent = parent.parent
        problem = "" if parent.is_dir() else f"{parent} is not a folder"
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        problem = getattr(error, "strerror", None) or str(error)
    if problem or not os.access(parent, os.W_OK | os.X_OK):
        problem = problem or f"you may not write to {parent}"
        raise InputError("--out", f"{folder}: {problem}", "name a folder that can be written to")


def publish(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Let `make` write files into a hidden folder, move them into `folder`, and return their paths in order of names.

    Plots of the same command that it does not write again are removed. If the files cannot be written there, a
    ComputationError (``not written``) says where they are instead, if anywhere.
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
        rest = f"nor to {refuge}: {error.strerror or error}"
    else:
        rest = f"and are in {refuge} instead"
    raise ComputationError("not written", f"the files could not be written to {problem}, {rest}")


def _published(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Make files in a hidden folder, then move them into the folder at once, and return their paths."""
    is_new = not folder.exists()
    parent = folder.absolute().parent if is_new else folder
    parent.mkdir(parents=True, exist_ok=True)
    _remove_dead(parent)
    with _hidden_in(parent) as hidden:
        make(hidden)
        names = sorted(file.name for file in hidden.iterdir())
        _synchronise(hidden)
        with deferred(), _lock_folder(parent):
            if not (is_new and _moved_whole(hidden, folder)):
                for name in names:
                    os.replace(hidden / name, folder / name)
                _remove_plots_before(folder, set(names))
    return [folder / name for name in names]


@contextmanager
def _lock_folder(folder: Path) -> Iterator[None]:
    """Lock a folder, after waiting for other runs that move files into it: files of two runs must not mix."""
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
    """Make a hidden folder, named by computer and process. In the end it is removed, unless it was moved."""
    hidden = Path(tempfile.mkdtemp(prefix=f"{_HIDDEN}{_computer()}-{os.getpid()}-", dir=parent))
    remove = partial(shutil.rmtree, hidden, ignore_errors=True)
    with cleaned_up(remove):
        try:
            yield hidden
        finally:
            remove()


def _remove_dead(parent: Path) -> None:
    """Remove hidden folders whose process has ended, or that are old."""
    of_this_computer = re.compile(rf"{re.escape(_HIDDEN + _computer())}-(\d+)-[^-]+")
    for hidden in parent.glob(f"{_HIDDEN}*"):
        match = of_this_computer.fullmatch(hidden.name)
        with suppress(OSError):
            has_ended = match is not None and os.name == "posix" and not _runs(int(match[1]))
            if has_ended or time.time() - hidden.stat().st_mtime > _DEAD:
                shutil.rmtree(hidden, ignore_errors=True)


def _computer() -> str:
    return re.sub(r"[^A-Za-z0-9]", "", platform.node())[:40] or "computer"


def _runs(process: int) -> bool:
    """True if a process of this number runs, of any user."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        pass  # it is another user's
    return True


def _moved_whole(hidden: Path, folder: Path) -> bool:
    """Rename the hidden folder to `folder`. False if another run has made that in the meantime."""
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
    """Wait until the files are on the disk: after a power failure, a file renamed before that may be empty."""
    for file in folder.iterdir():
        with file.open("rb+") as opened:
            os.fsync(opened.fileno())


def _remove_plots_before(folder: Path, names: set[str]) -> None:
    """Remove earlier plots from a folder: those with the signature of the new ones, `names`, under other names."""
    if not any(name.endswith(_PLOTS) for name in names):
        return
    from gbeam.plots.output import signature

    commands = {signature(folder / name) for name in names if name.endswith(_PLOTS)} - {""}
    for file in folder.iterdir():
        if file.suffix in _PLOTS and file.name not in names and file.is_file() and signature(file) in commands:
            file.unlink()
