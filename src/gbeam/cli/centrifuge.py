"""Verbs of a centrifuge: ``gbeam plan`` and ``gbeam place``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal, cast

from cyclopts import Parameter

from gbeam.cli.failures import FAILED, complain
from gbeam.cli.options import (
    Check,
    IgnoreLimits,
    Input,
    Output,
    ScenarioFile,
    number,
    option,
    read,
)
from gbeam.cli.outputs import deliver
from gbeam.cli.process import Watch, command
from gbeam.cli.publication import publish
from gbeam.constants import Measure
from gbeam.errors import InputError, naming
from gbeam.questions import machine_of

SAMPLE = 0.005  # s, where neither the scenario nor the command line gives one


def plan(
    scenario: ScenarioFile,
    /,
    *,
    output: Output = Output(),
    sample: Annotated[
        str | None, Parameter(help='Sample time of the commands, such as "5 ms"; else the scenario\'s, else 5 ms.')
    ] = None,
    ignore_limits: IgnoreLimits = False,
) -> int:
    """Plan the axis motions of the centrifuges of a scenario; it needs no beam.

    Prints what the axes do, what that uses of the machine's limits, which peaks of the load are reproduced and why not
    the others, and the largest load on the specimen, which a [beam] or bodies give its size. Limits of
    [motion.NAME.accept] that need no response are judged. With --out also writes the axis motions at the controller's
    sample time (commands_NAME.csv and .mat) and plots, with --report plan.html. A plan judges the machine, a run the
    specimen: limits that need its response are named, and do not count. Exit status: 0 done, 1 a limit of the machine
    is exceeded or one of acceptance not kept or not known, 2 the input is wrong.
    """
    folder = output.folder(scenario)

    from gbeam.scenario import schema
    from gbeam.scenario.build import build_machines, build_specimen
    from gbeam.scenario.load import load_environments, provenance

    with Watch(f"planning the machines of {scenario}"):
        environments = load_environments(scenario, output.overrides)
        machines, specimen = build_machines(environments), build_specimen(environments)
    if not machines:
        raise InputError("motion", "has no centrifuge to plan", "add a motion of kind centrifuge")
    interval = None if sample is None else number("--sample", sample, "time")
    if interval is not None and interval <= 0:
        raise InputError("--sample", f"is {sample}", 'give a positive time, such as "5 ms"')

    from gbeam.analysis.imitation import plan as analysis
    from gbeam.results.criteria import judging

    origin = provenance(environments, command())
    tables = {name: table for name, table in environments.motion.items() if isinstance(table, schema.Centrifuge)}
    with Watch() as watch:
        plans = tuple(
            replace(
                analysis.plan(
                    name, machines[name], table.tracks, specimen=specimen, title=environments.heading(), progress=watch,
                    **judging(table.limits_of_acceptance, response=False),
                ),
                provenance=origin,
            )
            for name, table in tables.items()
        )  # fmt: skip

    def commands(hidden: Path) -> None:
        from gbeam.io.commands import write_commands

        for machine_plan in plans:
            table = tables[machine_plan.name].commands
            time = interval or (table.sample if table else SAMPLE)
            write_commands(machine_plan, analysis.axis_commands(machines[machine_plan.name], time), hidden)

    deliver(
        plans, "plan", folder, output, origin=origin, title=environments.heading(), suffix="",
        more=commands,
    )  # fmt: skip
    broken = [machine_plan for machine_plan in plans if machine_plan.outcome != "done"]
    for machine_plan in broken:
        complain(
            f"motion.{machine_plan.name} {machine_plan.outcome}: {machine_plan.message}"
            + (" (allowed)" if ignore_limits else "")
        )
    refused = [machine_plan for machine_plan in plans if machine_plan.refusal]
    for machine_plan in refused:
        complain(f"motion.{machine_plan.name} {machine_plan.decision}: {machine_plan.refusal}")
    return FAILED if refused or (broken and not ignore_limits) else 0


def place(
    scenario: ScenarioFile,
    /,
    *,
    measure: Annotated[
        str | None,
        Parameter(
            help='root-shear, root-moment, vibration, tip or load; or a weighted sum, "tip=1, root-moment=0.5". '
            "Without it tip, and of a rigid specimen load."
        ),
    ] = None,
    motion: Annotated[str | None, Parameter(help="Which centrifuge, where the scenario has several.")] = None,
    along: Annotated[
        str,
        Parameter(
            help="Directions in which the control point may be moved, such as xz. Without it x in a straight beam, and "
            "xyz in another specimen."
        ),
    ] = "",
    turn: Annotated[
        Literal["own", "right-angles", "any"] | None,
        Parameter(
            name="--turn",
            help="Which way round it sits: own, as the scenario says; right-angles, with x, y and z along axis 3; any, "
            "from the best of these and others on. Without it own of a beam, and right-angles of another specimen.",
        ),
    ] = None,
    smoothing: Annotated[
        tuple[str, ...],
        option(
            "--smoothing",
            'Width of the kernel to keep, "60 ms"; given twice, the search goes from the one to the other. Without it '
            "from a quarter to four times the scenario's.",
        ),
    ] = (),
    check: Check = True,
    output: Output = Output(),
    ignore_limits: IgnoreLimits = False,
    write_back: Annotated[
        bool,
        option("--write", "Write the answer into the scenario file."),
    ] = False,
) -> int:
    """Find where and which way round to mount a specimen so that its response changes least.

    Prints the --set options that apply the answer; --write writes it, and no change made by --set, into the scenario
    file, whose comments stay. Options that exceed the machine's limits are listed but not chosen, unless
    --ignore-limits is given. With --out also writes place.json and a plot of the load's difference, with --report
    place.html. Exit status: 0 done, 1 every option exceeds the limits, 2 the input is wrong.
    """
    weights = None if measure is None else parse(measure)
    widths = [number("--smoothing", text, "time") for text in smoothing]
    folder = output.folder(scenario)

    from gbeam.scenario.text.source import STDIN

    if write_back and scenario == STDIN:
        raise InputError("--write", "has no file to write into: the scenario is standard input", "name its file")
    loaded = read("place", scenario, output.overrides)
    loaded.motion(motion, kind="centrifuge")
    name, current = machine_of(loaded.case, motion)

    from gbeam.analysis.imitation import place as analysis
    from gbeam.analysis.imitation.place_measures import choice_of

    system = loaded.case.system
    weights = analysis.default_weights(system) if weights is None else weights
    analysis.check_weights(weights, "--measure")
    with naming("--smoothing"):
        ways = turn or analysis.default_turns(system)
        choice = choice_of(current, widths, limited=not ignore_limits, turns=ways)
    with Watch() as watch, loaded.placing(measure="--measure", along="--along"):
        placement = analysis.place(
            system,
            current.flight,
            choice,
            loaded.case.settings_of(name),
            weights,
            current=current,
            names=(loaded.case.tracks[name], name),
            check=check,
            along=along,
            progress=watch,
        )
    file = _apply(loaded, scenario, name, placement.changes) if write_back and placement.changes else None
    deliver(
        placement, "place", folder, output, origin=loaded.case.provenance,
        facts={"written": file}, listed=False,
    )  # fmt: skip
    if placement.outcome != "done":
        complain(f"{placement.outcome}: motion.{name}: {placement.message}")
        return FAILED
    return 0


def _apply(loaded: Input, file: Path, name: str, changes: dict[str, str | list[str]]) -> str:
    """Write the changes of one centrifuge into the scenario file, and return the file's name."""
    from gbeam.scenario.text.revise import edited

    source = loaded.scenario.source
    assert source is not None  # it was read from a file
    text = edited(source, ("motion", name), changes)
    place = file.resolve()
    with naming("--write"):
        publish(place.parent, lambda hidden: (hidden / place.name).write_bytes(text.encode()))
    return str(file)


def parse(measure: str) -> dict[Measure, float]:
    """Read a measure or a weighted sum of measures."""
    weights: dict[Measure, float] = {}
    for term in measure.split(","):
        name, _, weight = term.partition("=")
        try:
            weights[cast("Measure", name.strip())] = float(weight) if weight else 1.0
        except ValueError:
            raise InputError(
                "--measure", f"has the weight {weight.strip()!r}", 'write "tip=1, root-moment=0.5"'
            ) from None
    return weights
