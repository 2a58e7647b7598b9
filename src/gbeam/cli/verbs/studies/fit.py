"""``gbeam fit``: values of a scenario from a measurement."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

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


def fit(
    scenario: ScenarioFile,
    /,
    *,
    data: Annotated[
        Path,
        Parameter(
            help='Measured columns "time" and "tip.z [mm]", "root_moment.y", "strain.z@10 mm" and others; or "mode", '
            '"frequency" and "damping_ratio".'
        ),
    ],
    free: Annotated[
        tuple[str, ...],
        option("--free", 'Values to find, "beam.material.youngs_modulus, beam.damping_ratio".'),
    ] = (),
    bounds: SearchBounds = (),
    motion: MotionName = None,
    at: At = None,
    starts: Starts = 1,
    write: WriteTo = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Find values of a scenario from measured histories, or from frequencies and damping, by least squares.

    Says how sure each value is, and which values the data cannot tell apart. With --out also writes fit.nc and a
    plot of data and residuals, with --report fit.html. Exit status: 0 done, 1 the data do not say the values, 2 the
    input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    if folder is not None:
        refuse_unwritable(folder)
    refuse_changes(write, overrides)

    from gbeam.studies.fit import fit as compute

    limits = search_bounds(bounds)
    with Watch() as watch:
        time = None if at is None else number("--at", at, "time")
        answer = compute(
            scenario,
            data,
            names(free),
            bounds=limits,
            motion=motion,
            at=time,
            starts=starts,
            overrides=overrides,
            progress=watch,
        )

    from gbeam.report.studies import fit as words

    write_found(answer, scenario, write)
    show_found(commanded(answer), words, "fit", "fit", folder, json=json, report=report, written=write)
    return 0
