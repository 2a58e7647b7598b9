"""``gbeam fit``: values of a scenario from a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from gbeam.cli.console import Watch
from gbeam.cli.inputs import names, naming, number, signed
from gbeam.cli.invocation import command
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import list_files, show
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.results.fit import Fit


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
    bounds: Annotated[
        tuple[str, ...],
        Parameter(
            name="--bounds",
            negative="",
            show_default=False,
            help='Of a value, "beam.damping_ratio=0.1 %:5 %"; by default a tenth to ten times the scenario\'s.',
        ),
    ] = (),
    motion: MotionName = None,
    at: At = None,
    write: Annotated[
        Path | None, Parameter(name="--write", help="A scenario to write, with the values found and its comments.")
    ] = None,
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
        raise InputError("--write", "is given beside --set", "change the file itself first: it is what --write copies")

    from gbeam.studies.fit import fit as compute

    limits = _bounds(bounds)
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
        save(answer.plot(), hidden, "fit", "gbeam fit")

    from gbeam.report.study import fit as report

    files = [] if out is None else publish(out, make)
    if write is not None:
        _write(answer, scenario, write)
    show(report.text(answer), signed(report.to_json(answer, files), answer.provenance), json)
    if not json:
        if write is not None:
            print(f"\n{write} has these values")
        list_files(out, files)
    return 0


def _bounds(texts: Sequence[str]) -> dict[str, tuple[str, str]]:
    found = {}
    for text in texts:
        path, equals, ends = text.partition("=")
        low, colon, high = ends.partition(":")
        if not (equals and colon):
            raise InputError("--bounds", f"is {text!r}", 'write "beam.damping_ratio=0.1 %:5 %"')
        found[path.strip()] = (low.strip(), high.strip())
    return found


def _write(answer: Fit, scenario: Path, file: Path) -> None:
    """Write the scenario with the values found."""
    from gbeam.studies.fit import fitted_text

    with naming("--write"):
        text, place = fitted_text(answer, scenario, file.parent), file.resolve()
        publish(place.parent, lambda hidden: (hidden / place.name).write_bytes(text.encode()))
