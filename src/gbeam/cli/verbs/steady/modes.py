"""``gbeam modes``: frequencies, damping and directions about a frozen motion."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.inputs import read
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, Report, ScenarioFile
from gbeam.cli.outputs import folder_of, show, write
from gbeam.cli.terminal.console import Watch


def modes(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    gyroscopic: Annotated[bool, Parameter(name="--gyroscopic", help="Keep Coriolis coupling.")] = True,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Frequencies, damping and shapes about the equilibrium at one time of a motion.

    With --out also writes modes.json and a plot of the shapes, with --report modes.html. Exit status: 0
    done, 1 there is no equilibrium, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    given = read("modes", scenario, overrides, folder)
    name, chosen = given.motion(motion)
    time = given.time(at)

    from gbeam.analysis.vibration import modal
    from gbeam.report.steady import modes as words
    from gbeam.results.declared import json_of

    with Watch(), given.placing():
        modes = modal.modes(given.structure(), chosen, time, gyroscopic=gyroscopic, name=name)
    facts = given.signed(json_of(modes))

    write(folder, "modes", facts, lambda: {"modes": modes.plot(title=given.case.title).figure}, report=report)
    show(words.text(modes), facts, json)
    return 0
