"""``gbeam static``: where the beam rests at a frozen motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gbeam.cli.inputs import read
from gbeam.cli.options import At, Json, MotionName, Out, Overrides, Report, ScenarioFile
from gbeam.cli.outputs import folder_of, show, write
from gbeam.cli.terminal.console import Watch

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def static(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Where the beam rests relative to its base at one time of the motions, and what its sections carry.

    Without --motion for all of them. With --out also writes static.json and plots of shapes and loads, with
    --report static.html. Exit status: 0 done, 1 there is no equilibrium, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    given = read("static", scenario, overrides, folder)
    chosen = dict(given.case.motions) if motion is None else dict([given.motion(motion)])
    time = given.time(at)

    from gbeam.analysis.equilibrium.static import static
    from gbeam.report.steady import deflection as words

    with Watch(), given.placing():
        structure = given.structure()
        deflections = [static(structure, each, time, name=name) for name, each in chosen.items()]
    title = given.case.title
    facts = given.signed(words.to_json(title, deflections))

    def figures() -> dict[str, Figure]:
        from gbeam.plots import plot_static

        loads = {f"loads_{each.motion}": each.plot("loads", title=title).figure for each in deflections}
        return {"static": plot_static(deflections, title), **loads}

    write(folder, "static", facts, figures, report=report)
    show(words.text(deflections), facts, json)
    return 0
