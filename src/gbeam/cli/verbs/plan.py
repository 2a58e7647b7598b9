"""``gbeam plan``: the machine's side alone, without a beam."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.console import stdout
from gbeam.cli.failures import FAILED, complain
from gbeam.cli.options import IgnoreLimits, Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable
from gbeam.errors import InputError

SAMPLE = 0.005  # s, where neither the scenario nor the command line says


def plan(
    scenario: ScenarioFile,
    /,
    *,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    sample: Annotated[
        str | None, Parameter(help='Sample time of the commands, such as "5 ms"; else the scenario\'s, else 5 ms.')
    ] = None,
    ignore_limits: IgnoreLimits = False,
) -> int:
    """Plan the axis motions of the centrifuges of a scenario; it needs no beam.

    Tells what the axes do, what that uses of the machine's limits, how well the load is followed and where it cannot
    be. With --out also writes the axis motions at the controller's sample time (commands_NAME.csv and .mat) and a plot.
    Exit status: 0 done, 1 a limit is exceeded, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)

    from gbeam.scenario import build_machines, load_environments, schema

    given = load_environments(scenario, overrides)
    machines = build_machines(given)
    if not machines:
        raise InputError("motion", "has no centrifuge to plan", "add a motion of kind centrifuge")
    every = None if sample is None else _time(sample)

    from gbeam.analysis.imitation.plan import commands
    from gbeam.analysis.imitation.plan import plan as planned
    from gbeam.report import as_json
    from gbeam.report.plan import plan_json, plan_table

    plans = {}
    files: list[Path] = []
    samples = {}
    for name, machine in machines.items():
        it = given.motion[name]
        assert isinstance(it, schema.Centrifuge)
        plans[name] = planned(name, machine, it.tracks)
        samples[name] = every or (it.commands.sample if it.commands else SAMPLE)
    if out is not None:

        def make(hidden: Path) -> None:
            from gbeam.io.commands import write_commands
            from gbeam.plots import plot_axes
            from gbeam.plots.style import save

            for name, each in plans.items():
                write_commands(each, commands(machines[name], samples[name]), hidden)
                save(plot_axes(each, each.axes, given.title), hidden, f"axes_{name}")

        files = publish(out, make)
    if json:
        print(as_json(plan_json(given.title, plans.values(), files)))
    else:
        console = stdout()
        console.print(plan_table(given.title, plans.values()))
        if files:
            console.print(f"\n{len(files)} files in {out}: {', '.join(it.name for it in files)}", soft_wrap=True)
    broken = [each for each in plans.values() if each.outcome != "done"]
    for each in broken:
        complain(f"motion.{each.name} {each.outcome}: {each.message}" + (" (allowed)" if ignore_limits else ""))
    return FAILED if broken and not ignore_limits else 0


def _time(text: str) -> float:
    """Read the sample time; InputError if it is none."""
    from gbeam.scenario import UnitError, argument

    try:
        value = argument(text, "time")
    except UnitError as error:
        raise InputError("--sample", error.problem, error.hint) from None
    if value <= 0:
        raise InputError("--sample", f"is {text}", 'give a positive time, such as "5 ms"')
    return value
