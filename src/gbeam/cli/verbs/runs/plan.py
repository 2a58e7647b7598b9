"""``gbeam plan``: the machine's side alone, without a beam."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.inputs import number, signed
from gbeam.cli.invocation import command
from gbeam.cli.options import IgnoreLimits, Json, Out, Overrides, Report, ScenarioFile
from gbeam.cli.outputs import folder_of, list_files, show, show_table
from gbeam.cli.process import figures_wanted
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain
from gbeam.errors import InputError

SAMPLE = 0.005  # s, where neither the scenario nor the command line gives one


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
    report: Report = False,
) -> int:
    """Plan the axis motions of the centrifuges of a scenario; it needs no beam.

    Prints what the axes do, what that uses of the machine's limits, which peaks of the load are reproduced and why not
    the others, and the largest load on the specimen, which a [beam] gives its length. Limits of [motion.NAME.accept]
    that need no response are judged. With --out also writes the axis motions at the controller's sample time
    (commands_NAME.csv and .mat) and plots, with --report plan.html. Exit status: 0 done, 1 a limit of the machine is
    exceeded or one of acceptance not kept, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    if folder is not None:
        refuse_unwritable(folder)

    from gbeam.scenario import build_machines, build_specimen, load_environments, provenance, schema

    with Watch(f"planning the machines of {scenario}"):
        given = load_environments(scenario, overrides)
        machines, beam = build_machines(given), build_specimen(given)
    if not machines:
        raise InputError("motion", "has no centrifuge to plan", "add a motion of kind centrifuge")
    every = None if sample is None else number("--sample", sample, "time")
    if every is not None and every <= 0:
        raise InputError("--sample", f"is {sample}", 'give a positive time, such as "5 ms"')

    from gbeam.analysis.imitation import plan as analysis
    from gbeam.report.machine import plan as words
    from gbeam.results.imitation.criteria import judging

    origin = provenance(given, command())
    tables = {name: table for name, table in given.motion.items() if isinstance(table, schema.Centrifuge)}
    plans = {
        name: replace(
            analysis.plan(
                name, machines[name], table.tracks,
                beam=beam, title=given.title, **judging(table.limits_of_acceptance),
            ),
            provenance=origin,
        )
        for name, table in tables.items()
    }  # fmt: skip

    def make(hidden: Path) -> None:
        from gbeam.io.commands import write_commands

        for name, each in plans.items():
            own = tables[name].commands
            time = every or (own.sample if own else SAMPLE)
            write_commands(each, analysis.commands(machines[name], time), hidden)
            if figures_wanted():
                from gbeam.plots import figures, save

                for kind, draw in figures(each, given.title).items():
                    save(draw(), hidden, f"{kind}_{name}", "gbeam plan")

        if report:
            from gbeam.report.page.result import report_of_plans

            facts = signed(words.to_json(given.title, plans.values()), origin)
            (hidden / "plan.html").write_text(report_of_plans(facts, plans), encoding="utf-8")

    if not json:
        show_table(words.table(given.title, plans.values()))
    files = [] if folder is None else publish(folder, make)
    if json:
        show("", signed(words.to_json(given.title, plans.values(), files), origin), json)
    list_files(None if json else folder, files)
    broken = [each for each in plans.values() if each.outcome != "done"]
    for each in broken:
        complain(f"motion.{each.name} {each.outcome}: {each.message}" + (" (allowed)" if ignore_limits else ""))
    refused = [each for each in plans.values() if each.accepted is False]
    for each in refused:
        complain(f"motion.{each.name} not accepted: {each.refusal}")
    return FAILED if refused or (broken and not ignore_limits) else 0
