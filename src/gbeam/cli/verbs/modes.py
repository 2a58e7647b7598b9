"""``gbeam modes``: frequencies, damping and directions about a frozen motion."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from gbeam.cli.console import Watch
from gbeam.cli.inputs import read
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import show, write


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
) -> int:
    """Frequencies, damping and shapes about the equilibrium at one time of a motion.

    With --out also writes modes.json and a plot of the shapes. Exit status: 0 done, 1 there is no equilibrium, 2 the
    input is wrong.
    """
    given = read("modes", scenario, overrides, out)
    name, chosen = given.motion(motion)
    time = given.time(at)

    from gbeam.analysis.vibration import modal
    from gbeam.report.steady import modes as report

    with Watch(), given.placing():
        modes = modal.modes(given.structure(), chosen, time, gyroscopic=gyroscopic, name=name)
    facts = given.signed(report.to_json(modes))

    write(out, "modes", facts, lambda: {"modes": modes.plot(title=given.case.title)})
    show(report.text(modes), facts, json)
    return 0
