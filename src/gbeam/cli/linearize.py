"""``gbeam linearize``: A, B, C, D about a frozen motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.asked import At, MotionName, motion_of, number, time_of
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable

if TYPE_CHECKING:
    from gbeam.analysis.state_space import StateSpace


def linearize(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    rate: Annotated[
        str | None, Parameter(name="--rate", help='A hub\'s steady rate in place of a time, such as "2 rad/s".')
    ] = None,
    modes: Annotated[
        int | None, Parameter(name="--modes", help="Keep so many of the slowest modes; by default all.")
    ] = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """State-space model A, B, C, D about the equilibrium at one time of a motion.

    With --out writes linear.json and linear.mat. Exit status: 0 done, 1 there is no equilibrium, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("linearize", scenario, overrides)
    name, chosen = motion_of(given, motion, hubs_only=rate is not None)
    time = time_of(given, at)
    turning = None if rate is None else number("--rate", rate, "angular rate")

    from gbeam.analysis import linearize as find
    from gbeam.analysis import structure_of, truncate
    from gbeam.report import as_json

    with Watch(), given.placing():
        found = find(structure_of(given.case), chosen, time, rate=turning, name=name)
        found = found if modes is None else truncate(found, modes)
    text = as_json(told(found))
    if out is not None:

        def make(hidden: Path) -> None:
            found.to_mat(hidden / "linear.mat")
            (hidden / "linear.json").write_text(text + "\n", encoding="utf-8")

        publish(out, make)
    if json:
        print(text)
    else:
        stdout().print(_text(found), markup=False)
    return 0


def told(found: StateSpace) -> dict[str, Any]:
    """State space as JSON."""

    def signals(listed: Any, values: Any) -> list[dict[str, Any]]:
        return [{"name": it.name, "unit": it.unit, "value": float(v)} for it, v in zip(listed, values, strict=True)]

    return {
        "outcome": "done",
        "motion": found.motion,
        "time": found.time,
        "model": found.model,
        "states": signals(found.states, found.state),
        "inputs": signals(found.inputs, found.input),
        "outputs": signals(found.outputs, found.output),
        **{key: getattr(found, key.lower()).tolist() for key in "ABCD"},
    }


def _text(found: StateSpace) -> str:
    lines = [f"{found.motion}: {found.model}, {len(found.a)} states"]
    for what in ("states", "inputs", "outputs"):
        lines.append(f"  {what:<8} {', '.join(f'{it.name} [{it.unit}]' for it in getattr(found, what))}")
    return "\n".join([*lines, "--json prints the matrices, --out writes them for MATLAB too."])
