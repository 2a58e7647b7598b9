"""``gbeam report``: a result as a page of HTML."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.options import Out
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.cli.terminal.console import Watch
from gbeam.printable import printable

_NAMES = {"result": "report", "sweep": "report"}  # others are called as their file


def report(
    result: Annotated[Path, Parameter(help="A result.nc of `gbeam run`, its folder, or the JSON of another verb.")],
    /,
    *,
    out: Out = None,
) -> int:
    """Write a result as one page of HTML that opens without a network: tables, plots that zoom, the beam in motion.

    Nothing is computed: what the page says is in the file. It goes beside the file, or into --out. Exit status: 0 done,
    2 the file cannot be read or holds no result that has a report.
    """
    from gbeam.report.page.result import file_in, report_of_file

    file = file_in(result) if result.is_dir() else result
    folder = file.parent if out is None else out
    refuse_unwritable(folder)
    with Watch(f"reading {file}"):
        page = report_of_file(file)
    name = f"{_NAMES.get(file.stem, file.stem)}.html"
    (written,) = publish(folder, lambda hidden: (hidden / name).write_text(page, encoding="utf-8"))
    print(printable(str(written)))
    return 0
