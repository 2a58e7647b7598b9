"""``gbeam fit``: values of a scenario from a measurement."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.console import Watch
from gbeam.cli.inputs import names, number, search_bounds, signed
from gbeam.cli.invocation import command
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, ScenarioFile, SearchBounds, WriteTo
from gbeam.cli.outputs import CHANGE_FIRST, list_files, show, write_found
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.errors import InputError


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
        Parameter(
            name="--free",
            negative="",
            show_default=False,
            help='Values to find, "beam.material.youngs_modulus, beam.damping_ratio".',
        ),
    ] = (),
    bounds: SearchBounds = (),
    motion: MotionName = None,
    at: At = None,
    write: WriteTo = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """Find values of a scenario from measured histories, or from frequencies and damping, by least squares.

    Says how sure each value is, and which values the data cannot tell apart. With --out also writes fit.nc and a plot
    of data and residuals. Exit status: 0 done, 1 the data do not say the values, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    if write is not None and overrides:
        raise InputError("--write", "is given beside --set", CHANGE_FIRST)

    from gbeam.studies.fit import fit as compute

    limits = search_bounds(bounds)
    with Watch() as watch:
        time = None if at is None else number("--at", at, "time")
        answer = compute(
            scenario, data, names(free), bounds=limits, motion=motion, at=time, overrides=overrides, progress=watch
        )

    assert answer.provenance is not None  # it is of a scenario
    answer = replace(answer, provenance=replace(answer.provenance, command=command()))

    def make(hidden: Path) -> None:
        from gbeam.plots import save

        answer.save(hidden / "fit.nc")
        save(answer.plot().figure, hidden, "fit", "gbeam fit")

    from gbeam.report.study import fit as report

    files = [] if out is None else publish(out, make)
    if write is not None:
        write_found(answer, scenario, write)
    show(report.text(answer), signed(report.to_json(answer, files), answer.provenance), json)
    if not json:
        if write is not None:
            print(f"\n{write} has these values")
        list_files(out, files)
    return 0
