"""``gbeam sensitivity``: which values of a scenario a figure depends on, and how much."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.inputs import names, number
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, Report, ScenarioFile, option
from gbeam.cli.outputs import commanded, folder_of, show_found
from gbeam.cli.publication import refuse_unwritable
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
    report: Report = False,
) -> int:
    """Which values of a scenario a figure depends on, and how much: a ranked table and a tornado plot.

    The derivatives of responses are those of the discrete solution, all from one run. With --out also writes
    sensitivity.nc and a plot of each figure, with --report sensitivity.html. Exit status: 0 done, 1 the run is not
    done, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    if folder is not None:
        refuse_unwritable(folder)

    from gbeam.studies.sensitivity import sensitivity as compute

    with Watch() as watch:
        time = None if at is None else number("--at", at, "time")
        answer = compute(
            scenario, names(of), names(by), verb=verb, motion=motion, at=time, overrides=overrides, progress=watch
        )

    from gbeam.report.studies import sensitivity as words

    show_found(commanded(answer), words, "sensitivity", "sensitivity", folder, json=json, report=report)
    return 0
