"""``gbeam app``: scenarios and results in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.publication import refuse_unwritable
from gbeam.errors import InputError
from gbeam.printable import printable


def app(
    *,
    folder: Annotated[Path | None, Parameter(help="Where records and runs are kept; gbeam-app by default.")] = None,
    port: Annotated[int, Parameter(help="To listen on, on this computer only; by default any that is free.")] = 0,
) -> int:
    """Edit, run and compare scenarios in a browser, on this computer only.

    Prints the address to open, which holds a secret: whoever has it may run scenarios here. Needs the extra app. Runs
    go on when the page is closed, and earlier ones are there again after a restart. Ends with Ctrl-C.
    """
    place = Path("gbeam-app") if folder is None else folder
    if not 0 <= port < 65536:
        raise InputError("--port", f"is {port}", "give 0 to 65535")
    refuse_unwritable(place)
    try:
        from gbeam.app.server import serve
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("fastapi", "starlette", "uvicorn"):
            raise
        raise InputError("app", f"needs {error.name}, which is not installed", "pip install 'gbeam[app]'") from None
    serve(place.resolve(), port, lambda address: print(printable(address), flush=True))
    return 0
