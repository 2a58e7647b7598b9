"""``gbeam new``: a commented scenario to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.options import Json
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
    from gbeam.report import as_json
    from gbeam.scenario import template

    text = template(kind)
    if file.suffix != ".toml":
        raise InputError(str(file), "does not end in .toml", f"name it {file.with_suffix('.toml')}")
    try:
        with file.open("x", encoding="utf-8") as it:
            it.write(text)
    except FileExistsError:
        raise InputError(str(file), "exists", "name a new file, or delete it first") from None
    except OSError as error:
        raise InputError(str(file), f"cannot be written ({error.strerror})", "name another place") from None
    print(as_json({"file": str(file), "kind": kind}) if json else f"{file} written; `gbeam run {file}` computes it")
    return 0
