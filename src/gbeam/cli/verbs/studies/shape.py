"""``gbeam shape``: the command of a hub that leaves the least vibration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from gbeam.cli.inputs import number
from gbeam.cli.options import Json, MotionName, Out, Overrides, Report, ScenarioFile
from gbeam.cli.outputs import commanded, folder_of, show_found
from gbeam.cli.publication import refuse_unwritable
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain


def shape(
    scenario: ScenarioFile,
    /,
    *,
    angle: Annotated[str | None, Parameter(help='To turn by, from rest to rest, "1 rad"; or --rate.')] = None,
    rate: Annotated[str | None, Parameter(help='To reach from rest, "3 rad/s"; or --angle.')] = None,
    duration: Annotated[str | None, Parameter(help='Of the command, "6 s"; by default the scenario\'s own.')] = None,
    limit: Annotated[
        str | None, Parameter(help='On the torque, "45 N m", or the angular acceleration of a hub without one.')
    ] = None,
    robust: Annotated[str, Parameter(help='Share by which all frequencies may be wrong, "20 %".')] = "0",
    check: Annotated[
        Literal["TLAM", "FOAM", "SFOAM", "CFOAM", "exact"] | None,
        Parameter(help="Model that the commands are run on; the scenario's by default."),
    ] = None,
    motion: MotionName = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    report: Report = False,
) -> int:
    """Find the rate or torque of a hub that leaves the least vibration of its beam, beside ZVD and a smooth step.

    It does what the scenario's own rate does, in the same time, unless --angle, --rate or --duration say otherwise;
    a free hub is driven by a torque and needs --angle or --rate. With --out also writes shaping.nc, command.json, a
    scenario in which the command drives the hub, and plots of the commands and of what they leave where frequencies
    are wrong, with --report shaping.html. Exit status: 0 done, 1 no command does it or a run is not done, 2 the
    input is wrong.
    """
    folder = folder_of(out, scenario, default=report)
    if folder is not None:
        refuse_unwritable(folder)

    from gbeam.studies.shape import hub_of, scenario_with
    from gbeam.studies.shape import shape as compute

    def given(option: str, text: str | None, kind: str) -> float | None:
        return None if text is None else number(option, text, kind)

    from gbeam.scenario.build import read_scenario

    case = read_scenario(scenario, overrides)
    free = hub_of(case, motion)[1].free
    bound = given("--limit", limit, "torque" if free else "angular acceleration")
    with Watch() as watch:
        answer = compute(
            case,
            angle=given("--angle", angle, "angle"),
            rate=given("--rate", rate, "angular rate"),
            duration=given("--duration", duration, "time"),
            limit=float("inf") if bound is None else bound,
            robust=number("--robust", robust, "ratio"),
            check=check or "",
            motion=motion,
            progress=watch,
        )

    from gbeam.report.studies import shaping as words

    answer = commanded(answer)

    def write_command(hidden: Path) -> None:
        (hidden / "command.json").write_text(scenario_with(answer, case) + "\n", encoding="utf-8")

    show_found(answer, words, "shape", "shaping", folder, json=json, report=report, more=write_command)
    if answer.outcome != "done":
        complain(f"a command's run has {answer.outcome}")
        return FAILED
    return 0
