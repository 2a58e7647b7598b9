"""What the verbs about one motion share: which motion, which time, which numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.inputs import Input
from gbeam.cli.outputs import publish
from gbeam.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gbeam.analysis.study.case import Motion
    from gbeam.mechanics.assembly import Structure

STATIONS = 81  # along the beam, at which shapes are told
MotionName = Annotated[
    str | None, Parameter(name="--motion", help="Which [motion.NAME]; may be left out where only one can answer.")
]
At = Annotated[
    str | None, Parameter(name="--at", help='Time at which the motion is frozen, such as "2 s"; by default the start.')
]


def motion_of(given: Input, name: str | None, *, hubs_only: bool = False) -> tuple[str, Motion]:
    """Return the motion that is asked about, and its name.

    Without a name the only one; with `hubs_only`, the only hub.

    Raises
    ------
    InputError
        If there is no such motion, or more than one could be meant.
    """
    motions = given.case.motions
    if name is not None:
        if name not in motions:
            raise InputError("--motion", f"is {name!r}", f"the scenario has {', '.join(motions)}")
        return name, motions[name]
    hubs = {key: it for key, it in motions.items() if given.scenario.motion[key].kind == "hub"}
    choice = hubs if hubs_only and hubs else motions
    if len(choice) != 1 and not (hubs_only and not hubs):
        raise InputError("--motion", "is missing", f"name one of {', '.join(choice)}")
    # Without any hub the first motion is as good as another: what is asked refuses it with its reason.
    return next(iter(choice.items()))


def number(option: str, text: str, kind: str) -> float:
    """Read an option with a unit.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    from gbeam.scenario.text.units import UnitError, argument

    try:
        return argument(text, kind)
    except UnitError as error:
        raise InputError(option, error.problem, error.hint or "write a number with its unit") from None


def time_of(given: Input, text: str | None) -> float:
    """Time of --at, s; the response's start where it is not given."""
    return given.case.response.start if text is None else number("--at", text, "time")


def along_the_beam(given: Input) -> Structure:
    """Assemble the scenario's beam and model with stations all along it."""
    from gbeam.analysis.study.study import structure_of

    length = given.case.beam.length
    fine = tuple(length * i / (STATIONS - 1) for i in range(STATIONS))
    return structure_of(replace(given.case, stations=fine))


def base_json(base: Any) -> dict[str, Any]:
    """Base motion as JSON."""
    return {
        "acceleration": dict(zip("xyz", map(float, base.a_WO_B), strict=True)),
        "angular_velocity": dict(zip("xyz", map(float, base.w_WB_B), strict=True)),
        "angular_acceleration": dict(zip("xyz", map(float, base.alpha_WB_B), strict=True)),
    }


def write(folder: Path | None, facts: Mapping[str, Any], name: str, figures: Mapping[str, Figure]) -> list[Path]:
    """Write NAME.json and the figures into a folder, if there is one; return the files."""
    if folder is None:
        return []

    def make(hidden: Path) -> None:
        from gbeam.plots.style import save
        from gbeam.report import as_json

        (hidden / f"{name}.json").write_text(as_json(facts) + "\n", encoding="utf-8")
        for stem, figure in figures.items():
            save(figure, hidden, stem)

    return publish(folder, make)
