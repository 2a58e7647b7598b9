"""``gbeam sensitivity``: which values of a scenario a figure depends on, and how much."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.inputs import names, number, signed
from gbeam.cli.invocation import command
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, ScenarioFile, option
from gbeam.cli.outputs import list_files, show
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.cli.terminal.console import Watch

Verb = Literal["run", "static", "modes", "critical-speed", "plan"]


def sensitivity(
    scenario: ScenarioFile,
    /,
    *,
    of: Annotated[
        tuple[str, ...],
        option("--of", 'Figures of the verb by the end of their path in its JSON, "tip.z.max_abs, verdict.tip".'),
    ] = (),
    by: Annotated[
        tuple[str, ...],
        option(
            "--with", 'Only these values, "beam.length, beam.material.youngs_modulus"; by default every physical one.'
        ),
    ] = (),
    verb: Annotated[Verb, Parameter(help="Whose figures.")] = "run",
    motion: MotionName = None,
    at: At = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """Which values of a scenario a figure depends on, and how much: a ranked table and a tornado plot.

    The derivatives of responses are those of the discrete solution, all from one run. With --out also writes
    sensitivity.nc and a plot of each figure. Exit status: 0 done, 1 the run is not done, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)

    from gbeam.studies.sensitivity import sensitivity as compute

    with Watch() as watch:
        time = None if at is None else number("--at", at, "time")
        answer = compute(
            scenario, names(of), names(by), verb=verb, motion=motion, at=time, overrides=overrides, progress=watch
        )

    assert answer.provenance is not None  # it is of a scenario
    answer = replace(answer, provenance=replace(answer.provenance, command=command()))

    def make(hidden: Path) -> None:
        from gbeam.plots import figures, save

        answer.save(hidden / "sensitivity.nc")
        for name, draw in figures(answer).items():
            save(draw(), hidden, re.sub(r"[^\w.-]+", "", name), "gbeam sensitivity")

    from gbeam.report.studies import sensitivity as report

    files = [] if out is None else publish(out, make)
    show(report.text(answer), signed(report.to_json(answer, files), answer.provenance), json)
    if not json:
        list_files(out, files)
    return 0
