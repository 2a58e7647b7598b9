"""``gbeam critical-speed``: the hub rate at which the beam's equilibrium is lost."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.asked import MotionName, motion_of, number, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable

if TYPE_CHECKING:
    from gbeam.results_modal import Critical


def critical_speed(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    to: Annotated[
        str | None,
        Parameter(name="--to", help='End of search, such as "20 rad/s"; by default ten times the lowest frequency.'),
    ] = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """The hub rate at which the beam's equilibrium is lost.

    Where there is none up to the end of the search, critical_speed is null and the reason says so; that is an answer,
    with exit status 0. 2: the input is wrong, such as a motion without a hub.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("critical-speed", scenario, overrides)
    name, chosen = motion_of(given, motion, hubs_only=True)
    upper = None if to is None else number("--to", to, "angular rate")

    from gbeam.analysis import critical_speed as find
    from gbeam.analysis import structure_of
    from gbeam.report import as_json

    with Watch(), given.placing():
        found = find(structure_of(given.case), chosen, upper=upper, name=name)
    facts = told(found, name)
    write(out, facts, "critical_speed", {})
    if json:
        print(as_json(facts))
    else:
        stdout().print(f"{name}: {found.reason}", markup=False)
    return 0


def told(found: Critical, motion: str) -> dict[str, Any]:
    """Critical speed as JSON; rad/s, null where there is none."""
    rest = asdict(found)
    value = rest.pop("value")
    return {"outcome": "done", "motion": motion, "critical_speed": value, **rest}
