"""``gbeam rerun``: a result computed again from what its file says."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.options import Json
from gbeam.cli.outputs import show
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain


def rerun(
    result: Annotated[Path, Parameter(help="A result.nc of `gbeam run`, or the JSON of another verb.")],
    /,
    *,
    json: Json = False,
) -> int:
    """Compute a result again, from the scenario and the records that its file holds, and compare every number.

    The JSON of other verbs, such as modes.json, holds no records: these are read from where they were.

    It is reproduced where nothing differs in the last digit; with other versions, or on another platform, where nothing
    differs by more than 1e-9 of its largest value. Says what differs, and what has changed since. Writes nothing. Exit
    status: 0 reproduced, 1 not, 2 the file cannot be read or holds no scenario.
    """
    from gbeam.report import provenance as report

    if result.suffix == ".json":
        from gbeam.cli.again import answer_again

        again = answer_again(result)
    else:
        from gbeam.scenario.rerun import rerun

        with Watch(f"reading {result} and computing it again"):
            again = rerun(result)
    show(report.reproduction_text(again), report.reproduction_json(again), json)
    if not again.reproduced:
        complain(f"not reproduced: {len(again.differences)} of {again.compared} differ")
        return FAILED
    return 0
