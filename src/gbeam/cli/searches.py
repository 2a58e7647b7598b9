"""Verbs of searches: ``gbeam fit``, ``optimize`` and ``shape``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from gbeam.cli.failures import FAILED, complain
from gbeam.cli.options import (
    At,
    MotionName,
    Output,
    ScenarioFile,
    SearchBounds,
    SmoothVerb,
    Starts,
    WriteTo,
    changed_options,
    names,
    number,
    option,
    search_bounds,
    with_options,
)
from gbeam.cli.outputs import LIST, deliver, list_figures, refuse_changes, write_found
from gbeam.cli.process import Watch
from gbeam.constants import ModelKind
from gbeam.questions import differentiable


@with_options("run", "modes")
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
    options: Any = None,
    starts: Starts = 1,
    write: WriteTo = None,
    output: Output = Output(),
) -> int:
    """Find values of a scenario from measured histories, or from frequencies and damping, by least squares.

    Says how sure each value is, and which values the data cannot tell apart. With --out also writes fit.nc and a
    plot of data and residuals, with --report fit.html. Exit status: 0 done, 1 the data do not say the values, 2 the
    input is wrong.
    """
    folder = output.folder(scenario)
    refuse_changes(write, output.overrides)

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
            options=changed_options(options),
            starts=starts,
            overrides=output.overrides,
            progress=watch,
        )

    write_found(answer, scenario, write)
    deliver(answer, "fit", folder, output, suffix=".nc", copy=write)
    return 0


@with_options(*differentiable())
def optimize(
    scenario: ScenarioFile,
    /,
    *,
    minimise: Annotated[
        str,
        Parameter(
            name=["--minimise", "--minimize"],
            help='A figure of the verb, "tip.y.residual_amplitude"; list prints all, with units.',
        ),
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
    verb: SmoothVerb = "run",
    motion: MotionName = None,
    at: At = None,
    options: Any = None,
    starts: Starts = 1,
    write: WriteTo = None,
    output: Output = Output(),
) -> int:
    """Find the values of a scenario at which a figure is least, within bounds and limits, by exact derivatives.

    One search finds the nearest valley, from the scenario's values; --starts 5 tries others. With --out also writes
    optimum.nc and a plot of the way, with --report optimum.html. Exit status: 0 done, 1 no values within the bounds
    keep the requirements, 2 the input is wrong.
    """
    if minimise == LIST:
        return list_figures(verb, output.json)
    folder = output.folder(scenario)
    refuse_changes(write, output.overrides)

    from gbeam.studies.optimise import optimise as compute

    with Watch() as watch:
        answer = compute(
            scenario,
            minimise,
            names(over),
            subject_to=names(subject_to),
            bounds=search_bounds(bounds),
            verb=verb,
            motion=motion,
            at=None if at is None else number("--at", at, "time"),
            options=changed_options(options),
            starts=starts,
            overrides=output.overrides,
            progress=watch,
        )

    write_found(answer, scenario, write)
    deliver(answer, "optimum", folder, output, verb="optimize", suffix=".nc", copy=write)
    if answer.outcome != "done":
        complain(f"{answer.outcome}: no values were found that keep the requirements")
        return FAILED
    return 0


def shape(
    scenario: ScenarioFile,
    /,
    *,
    angle: Annotated[str | None, Parameter(help='To turn by, from rest to rest, "1 rad"; or --rate.')] = None,
    rate: Annotated[
        str | None, Parameter(help='To reach from rest, "3 rad/s", of what slides "0.2 m/s"; or --angle or --distance.')
    ] = None,
    distance: Annotated[str | None, Parameter(help='Of what slides, to move by, "300 mm"; or --rate.')] = None,
    duration: Annotated[str | None, Parameter(help='Of the command, "6 s"; by default the scenario\'s own.')] = None,
    limit: Annotated[
        str | None,
        Parameter(help='On the torque, "45 N m", or force, or on the acceleration of what has a rate.'),
    ] = None,
    robust: Annotated[str, Parameter(help='Share by which all frequencies may be wrong, "20 %".')] = "0",
    check: Annotated[
        ModelKind | None,
        Parameter(help="Model that the commands are run on; the scenario's by default."),
    ] = None,
    motion: MotionName = None,
    joint: Annotated[
        str | None,
        Parameter(help='Of a system, what moves, "axis.angle", where several have a rate or drive.'),
    ] = None,
    point: Annotated[
        str | None, Parameter(help='Of a system, the point that is to rest, "panel.tip", where it has several beams.')
    ] = None,
    output: Output = Output(),
) -> int:
    """Find the rate or effort of a hub, or of a joint, that leaves the least vibration, beside ZVD and a smooth step.

    It does what the scenario's own rate does, in the same time, unless --angle, --rate, --distance or --duration say
    otherwise; a free hub, or a joint with a drive, is driven by a torque or force and needs one of the first three.
    With --out also writes shaping.nc, command.json, a scenario in which the command drives it, and plots of the
    commands and of what they leave where frequencies are wrong, with --report shaping.html. Exit status: 0 done, 1 no
    command does it or a run is not done, 2 the input is wrong.
    """
    folder = output.folder(scenario)

    from gbeam.analysis.control.plants import DRIVES
    from gbeam.studies.shape import driven_of, scenario_with, slides
    from gbeam.studies.shape import shape_hub_command as compute

    def optional(option: str, text: str | None, kind: str) -> float | None:
        return None if text is None else number(option, text, kind)

    from gbeam.scenario.build import read_scenario

    case = read_scenario(scenario, output.overrides)
    command = driven_of(case, motion, joint)
    straight = slides(command.name)
    bound = optional("--limit", limit, DRIVES[command.hub.free, straight][1])
    with Watch() as watch:
        answer = compute(
            case,
            angle=optional("--angle", angle, "angle"),
            rate=optional("--rate", rate, "speed" if straight else "angular rate"),
            distance=optional("--distance", distance, "length"),
            duration=optional("--duration", duration, "time"),
            limit=float("inf") if bound is None else bound,
            robust=number("--robust", robust, "ratio"),
            check=check or "",
            motion=motion,
            joint=joint,
            point=point,
            progress=watch,
        )

    def write_command(hidden: Path) -> None:
        (hidden / "command.json").write_text(scenario_with(answer, case) + "\n", encoding="utf-8")

    deliver(answer, "shaping", folder, output, verb="shape", suffix=".nc", more=write_command)
    if answer.outcome != "done":
        complain(f"a command's run has {answer.outcome}")
        return FAILED
    return 0
