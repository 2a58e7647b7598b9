"""``gbeam campbell``: frequencies against the speed of a hub."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from gbeam.cli.inputs import number, read
from gbeam.cli.options import Json, MotionName, Out, Overrides, Report, ScenarioFile, Speed
from gbeam.cli.outputs import folder_of, list_files, show, write
from gbeam.cli.terminal.console import Watch
from gbeam.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def campbell(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    start: Annotated[Speed, Parameter(name="--from")] = None,
    end: Annotated[Speed, Parameter(name="--to")] = None,
    modes: Annotated[int, Parameter(name="--modes", help="How many to follow.")] = 8,
    orders: Annotated[int, Parameter(name="--orders", help="Multiples of the speed, 1 to this.")] = 4,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Frequencies against the speed of a hub, in the unit of --to or --from, and where its multiples meet them.

    Writes campbell.json, the diagram and with --report campbell.html into --out, by default out/ and the scenario's
    name; with --json only if --out or --report is given. Exit status: 0 done, 1 there is no equilibrium, 2 the input is
    wrong, such as a motion without a hub.
    """
    folder = folder_of(out, scenario, default=report or not json)
    given = read("campbell", scenario, overrides, folder)
    name, chosen = given.motion(motion, kind="hub")
    low = 0.0 if start is None else number("--from", start, "angular rate")
    high = None if end is None else number("--to", end, "angular rate")
    if orders < 0:
        raise InputError("--orders", f"is {orders}", "give 0 or more")
    if high is None and chosen.free:
        fix = 'give the largest speed, such as "5 rad/s"'
        raise InputError("--to", "is missing: the hub is driven by a torque", fix)

    from gbeam.analysis.vibration import campbell as analysis
    from gbeam.report.steady import campbell as words
    from gbeam.results.declared import json_of

    with Watch(), given.placing(to="--to", modes="--modes"):
        diagram = analysis.campbell(
            given.case.assemble(), chosen, start=low, end=high, modes=modes, orders=range(1, orders + 1), name=name
        )
    facts = given.signed(json_of(diagram))

    from gbeam.scenario.values.units import unit_of

    # In words and in the diagram speeds are in the unit in which they are given.
    unit, size = unit_of(end or start or "0", "angular rate")

    def figures() -> dict[str, Figure]:
        from gbeam.plots import plot_campbell

        return {"campbell": plot_campbell(diagram, given.case.title, (1 / size, unit))}

    files = write(folder, "campbell", facts, figures, report=report)
    show(words.text(diagram, unit, size), facts, json)
    if not json:
        list_files(folder, files)
    return 0
