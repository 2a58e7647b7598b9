"""``gbeam optimize``: values of a scenario at which a figure is least."""

from __future__ import annotations

from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.inputs import names, number, search_bounds
from gbeam.cli.options import (
    At,
    Json,
    MotionName,
    Out,
    Overrides,
    Report,
    ScenarioFile,
    SearchBounds,
    Starts,
    WriteTo,
    option,
)
from gbeam.cli.outputs import commanded, folder_of, refuse_changes, show_found, write_found
from gbeam.cli.publication import refuse_unwritable
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain

Verb = Literal["run", "static", "modes", "critical-speed", "plan"]


def optimize(
    scenario: ScenarioFile,
    /,
    *,
    minimise: Annotated[
        str, Parameter(name=["--minimise", "--minimize"], help='A figure of the verb, "tip.y.residual_amplitude".')
    ],
    over: Annotated[
        tuple[str, ...],
        option("--over", 'Values to choose, "motion.centrifuge.control_point, motion.centrifuge.smoothing".'),
    ] = (),
    subject_to: Annotated[
        tuple[str, ...],
        option(
            "--subject-to",
            '"limits" of the machines, or a bound on a figure, "tip.z.max_abs <= 2 mm"; any number of times.',
        ),
    ] = (),
    bounds: SearchBounds = (),
    verb: Annotated[Verb, Parameter(help="Whose figures.")] = "run",
    motion: MotionName = None,
    at: At = None,
    starts: Starts = 1,
    write: WriteTo = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Find the values of a scenario at which a figure is least, within bounds and limits, by exact derivatives.

    One search finds the nearest valley, from the scenario's values; --starts 5 tries others. With --out also writes
    optimum.nc and a plot of the way, with --report optimum.html. Exit status: 0 done, 1 no values within the bounds
    keep the requirements, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    if folder is not None:
        refuse_unwritable(folder)
    refuse_changes(write, overrides)

    from gbeam.studies.optimise import optimise as compute

    required = [each.strip() for text in subject_to for each in text.split(",") if each.strip()]
    with Watch() as watch:
        answer = compute(
            scenario,
            minimise,
            names(over),
            subject_to=required,
            bounds=search_bounds(bounds),
            verb=verb,
            motion=motion,
            at=None if at is None else number("--at", at, "time"),
            starts=starts,
            overrides=overrides,
            progress=watch,
        )

    from gbeam.report.studies import optimum as words

    write_found(answer, scenario, write)
    show_found(commanded(answer), words, "optimize", "optimum", folder, json=json, report=report, written=write)
    if answer.outcome != "done":
        complain(f"{answer.outcome}: no values were found that keep the requirements")
        return FAILED
    return 0
