"""Verbs of many runs: ``gbeam sweep`` and ``gbeam sensitivity``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

from cyclopts import Parameter

from gbeam.cli.failures import FAILED, complain
from gbeam.cli.options import (
    At,
    MotionName,
    Output,
    ScenarioFile,
    SmoothVerb,
    Verb,
    changed_options,
    names,
    number,
    option,
    usual_folder,
    with_options,
)
from gbeam.cli.outputs import LIST, deliver, list_figures
from gbeam.cli.process import Watch, command
from gbeam.cli.publication import refuse_unwritable
from gbeam.constants import Sampler
from gbeam.questions import QUESTIONS, differentiable


@with_options(*QUESTIONS)
def sweep(
    scenario: ScenarioFile,
    /,
    *,
    over: Annotated[
        tuple[str, ...],
        option(
            "--over",
            'What varies, PATH=VALUES; any number of times: "beam.length=250 mm:350 mm:5" (from, to, how '
            'many), "model.kind=FOAM, exact", "beam.damping_ratio=uniform(0.5 %, 2 %)".',
        ),
    ] = (),
    measure: Annotated[
        tuple[str, ...],
        option(
            "--measure",
            'Figures of the verb by the end of their path in its JSON, "verdict.tip"; of run by default what '
            "the verdict of a machine is on (its limits of acceptance, or the largest load), the largest of tip and "
            "root moment, the share of the flight that is followed, and whether it is accepted; list prints all there "
            "are, with units.",
        ),
    ] = (),
    history: Annotated[
        tuple[str, ...],
        option(
            "--history",
            'Histories by motion, point or load of the root, and axis, "flight.tip.z", or what a sensor reads, '
            '"strip.tip.place_z"; of verb run.',
        ),
    ] = (),
    times: Annotated[int, Parameter(help="At which histories are given, over the whole response.")] = 501,
    verb: Annotated[Verb | None, Parameter(help="Whose figures; run by default.")] = None,
    motion: MotionName = None,
    at: At = None,
    options: Any = None,
    samples: Annotated[int | None, Parameter(help='How many are drawn of distributions, "200"; 64 by default.')] = None,
    sampler: Annotated[
        Sampler | None,
        Parameter(help="How they are drawn; sobol by default, saltelli for Sobol indices."),
    ] = None,
    seed: Annotated[int | None, Parameter(help='The same seed, "1", draws the same samples.')] = None,
    workers: Annotated[int, Parameter(help="Processes of this machine.")] = 1,
    scheduler: Annotated[str | None, Parameter(help="Address of a Dask scheduler whose workers compute.")] = None,
    resume: Annotated[bool, option("--resume", "Compute only what is missing in --out.")] = False,
    yes: Annotated[bool, option("--yes", "More than 100,000 cases are meant.")] = False,
    netcdf: Annotated[bool, option("--netcdf", "Write sweep.nc beside sweep.zarr.")] = False,
    output: Output = Output(),
) -> int:
    """Compute figures of many cases of one scenario: every combination of the values given, or samples of them.

    What the command line does not say is what the scenario's [sweep] says. Values of the scenario that are
    distributions, youngs_modulus = { normal = ["70 GPa", "2 GPa"] }, are drawn.

    Every case is kept in --out (by default out/ and the scenario's name and -sweep) as soon as it is done: after an
    interruption --resume does what is missing. Writes sweep.zarr, which xarray opens, sweep.json, a plot of each
    measure, and with --report report.html. A case that fails is recorded as such. Exit status: 0 all cases computed,
    those too that do not keep limits, which are counted as not accepted, 1 some are not done, 2 the input is wrong.
    """
    if LIST in measure:
        return list_figures(verb or "run", output.json)
    folder = output.out if output.out is not None else usual_folder(scenario, "-sweep")
    refuse_unwritable(folder)

    from gbeam.studies.sweep import sweep as compute

    with Watch() as watch:
        answer = compute(
            scenario,
            over,
            names(measure),
            histories=names(history),
            times=times,
            verb=verb,
            motion=motion,
            at=None if at is None else number("--at", at, "time"),
            options=changed_options(options),
            overrides=output.overrides,
            samples=samples,
            sampler=sampler,
            seed=seed,
            workers=workers,
            scheduler=scheduler,
            store=folder,
            resume=resume,
            confirmed=yes,
            progress=watch,
        )

    assert answer.provenance is not None  # it is of a scenario
    answer = replace(answer, provenance=replace(answer.provenance, command=command()))

    from gbeam.io.netcdf import write_zarr

    write_zarr(answer, folder / "sweep.zarr")
    deliver(
        answer, "sweep", folder, output, page="report", also=[folder / "sweep.zarr"],
        more=lambda hidden: answer.save(hidden / "sweep.nc") if netcdf else None,
    )  # fmt: skip
    if answer.failure_count:
        complain(f"{answer.failure_count} of {answer.outcome.size} cases are not done")
    return FAILED if answer.failure_count else 0


@with_options(*differentiable())
def sensitivity(
    scenario: ScenarioFile,
    /,
    *,
    of: Annotated[
        tuple[str, ...],
        option(
            "--of",
            'Figures of the verb by the end of their path in its JSON, "tip.z.max_abs, verdict.tip"; of run by default '
            "the largest of tip and root moment in every motion; list prints all there are, with units.",
        ),
    ] = (),
    by: Annotated[
        tuple[str, ...],
        option(
            "--with", 'Only these values, "beam.length, beam.material.youngs_modulus"; by default every physical one.'
        ),
    ] = (),
    verb: SmoothVerb = "run",
    motion: MotionName = None,
    at: At = None,
    options: Any = None,
    output: Output = Output(),
) -> int:
    """Rank the values of a scenario by how much a figure depends on them: a table and a tornado plot.

    The derivatives of responses are those of the discrete solution, all from one run. With --out also writes
    sensitivity.nc and a plot of each figure, with --report sensitivity.html. Exit status: 0 done, 1 the run is not
    done, 2 the input is wrong.
    """
    if LIST in of:
        return list_figures(verb, output.json)
    folder = output.folder(scenario)

    from gbeam.studies.sensitivity import sensitivity as compute

    with Watch() as watch:
        time = None if at is None else number("--at", at, "time")
        answer = compute(
            scenario,
            names(of),
            names(by),
            verb=verb,
            motion=motion,
            at=time,
            options=changed_options(options),
            overrides=output.overrides,
            progress=watch,
        )

    deliver(answer, "sensitivity", folder, output, suffix=".nc")
    return 0
