"""``gbeam new``: a commented scenario to start from."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.options import Json
from gbeam.cli.outputs import show
from gbeam.errors import InputError


def new(
    file: Annotated[Path, Parameter(help="File to write, such as wing.toml; never overwritten.")],
    /,
    *,
    kind: Annotated[Literal["flight", "hub"], Parameter(help="Flight and centrifuge, or a hub.")] = "flight",
    json: Json = False,
) -> int:
    """Write a commented scenario to start from.

    Exit status: 0 written, 2 there is such a file or it cannot be written.
    """
    from gbeam.scenario.template import template

    if file.suffix != ".toml":
        raise InputError(str(file), "does not end in .toml", f"name it {file.stem or 'wing'}.toml")
    try:
        with file.open("x", encoding="utf-8") as new_file, _removed_if_incomplete(file):
            new_file.write(template(kind))
            new_file.flush()
    except FileExistsError:
        raise InputError(str(file), "exists", "name a new file, or delete it first") from None
    except OSError as error:
        raise InputError(str(file), f"cannot be written ({error.strerror})", "name another place") from None
    show(f"{file} written; `gbeam run {file}` computes it", {"file": str(file), "kind": kind}, json)
    return 0


@contextmanager
def _removed_if_incomplete(file: Path) -> Iterator[None]:
    try:
        yield
    except OSError:  # the disk is full
        file.unlink()
        raise
