"""What a verb prints, and its files in the folder of ``--out``: all of them whole, or none."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PLAIN_WIDTH = 110  # columns of a table where stdout is a file


def show(words: str, facts: Mapping[str, Any], json: bool) -> None:
    """Print a result as JSON, or in words."""
    from gbeam.report import as_json

    print(as_json(facts) if json else words)


def show_table(table: object) -> None:
    """Print what rich draws: as wide as the terminal, and as wide in a file as a table needs."""
    from rich.console import Console

    Console(highlight=False, width=None if sys.stdout.isatty() else _PLAIN_WIDTH).print(table)


def list_files(folder: Path | None, files: Sequence[Path]) -> None:
    """Print the names of the files written; a plot's two formats as one."""
    if files:
        kept = [file for file in files if file.suffix != ".svg"]
        names = [f"{file.stem}.png/.svg" if file.suffix == ".png" else file.name for file in kept]
        print(f"\n{len(files)} files in {folder}: {', '.join(names)}")


def write(
    folder: Path | None, name: str, facts: Mapping[str, Any], figures: Callable[[], Mapping[str, Figure]] | None = None
) -> list[Path]:
    """Write NAME.json and the figures, which are drawn only then, into a folder, if there is one; return the files."""
    if folder is None:
        return []

    def make(hidden: Path) -> None:
        write_json(hidden / f"{name}.json", facts)
        if figures is not None:
            from gbeam.plots import save

            for stem, figure in figures().items():
                save(figure, hidden, stem, f"gbeam {name}")

    return publish(folder, make)


def write_json(file: Path, facts: Mapping[str, Any]) -> None:
    """Write one result as JSON."""
    from gbeam.report import as_json

    file.write_text(as_json(facts) + "\n", encoding="utf-8")


def refuse_unwritable(folder: Path) -> None:
    """Raise InputError if `folder` can be neither written to nor made, before an hour is spent computing."""
    try:
        parent = folder.absolute()
        while not parent.exists():
            parent = parent.parent
        sound, problem = parent.is_dir(), f"{parent} is not a folder"
    except OSError as error:
        sound, problem = False, error.strerror or str(error)
    if sound and os.access(parent, os.W_OK | os.X_OK):
        return
    raise _unwritable(folder, problem if not sound else f"you may not write to {parent}")


def publish(folder: Path, make: Callable[[Path], object]) -> list[Path]:
    """Let `make` write files into a hidden folder, then move them into `folder`.

    Parameters
    ----------
    folder : Path
        Made if it does not exist; files of the same names are replaced, and plots that the same command made before
        and does not make now are removed.
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
            _remove_plots_before(folder, {file.name for file in made})
    except OSError as error:
        raise _unwritable(folder, error.strerror or str(error)) from None
    return [folder / file.name for file in made]


def _remove_plots_before(folder: Path, made: set[str]) -> None:
    """Remove plots signed by the command that made the files `made`, under their own names, and not among them."""
    kinds = (".png", ".svg")
    if not any(name.endswith(kinds) for name in made):
        return
    from gbeam.plots import signature

    commands = {signature(folder / name) for name in made if name.endswith(kinds)} - {""}
    for file in folder.iterdir():
        if file.suffix in kinds and file.name not in made and file.is_file() and signature(file) in commands:
            file.unlink()


def _unwritable(folder: Path, problem: str) -> InputError:
    return InputError("--out", f"{folder}: {problem}", "name a folder that can be written to")
