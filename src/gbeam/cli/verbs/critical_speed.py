"""``gbeam critical-speed``: the hub rate, load or acceleration at which the beam's equilibrium is lost."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from cyclopts import Parameter

from gbeam.cli.common import At, MotionName, motion_of, number, time_of, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import Input, read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable
from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.results.modal import Critical, CriticalMap

KEYS = {"rate": "critical_speed", "loads": "critical_load_factor", "acceleration": "critical_acceleration"}
KINDS = {"rate": "angular rate", "loads": "ratio", "acceleration": "acceleration"}


def critical_speed(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    raised: Annotated[
        Literal["rate", "loads", "acceleration"],
        Parameter(
            name="--vary",
            help="What is raised: the hub's rate; all loads on the beam, by one factor, the base being frozen; or the "
            "acceleration of the root along the beam, which pushes it.",
        ),
    ] = "rate",
    at: At = None,
    to: Annotated[
        str | None,
        Parameter(name="--to", help='End of search, such as "20 rad/s"; by default ten times what the beam resists.'),
    ] = None,
    masses: Annotated[
        str | None, Parameter(name="--masses", help='A map instead, with one more mass: "0.1 kg, 0.5 kg".')
    ] = None,
    positions: Annotated[
        str | None, Parameter(name="--positions", help='Where that mass sits: "2 m, 5 m, 8 m"; by default all along.')
    ] = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """The hub rate, load or acceleration at which the beam's equilibrium is lost.

    Where there is none up to the end of the search, the value is null and the reason says so; that is an answer, with
    exit status 0. 2: the input is wrong, such as a motion without a hub. With --out writes critical_speed.json, and a
    map also as CSV and plot.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("critical-speed", scenario, overrides)
    upper = None if to is None else number("--to", to, KINDS[raised])
    if upper is not None and not upper > 0:
        raise InputError("--to", f"is {to}", "give a value above zero, where the search ends")
    if masses is None and positions is not None:
        raise InputError("--positions", "stands without --masses", 'add --masses "0.1 kg, 0.5 kg"')
    if masses is not None:
        if raised != "rate":
            raise InputError("--masses", f"stands beside --vary {raised}", "a map is of hub rates")
        return _map(given, motion, masses, positions, upper, out, json)
    name, chosen = motion_of(given, motion, hubs_only=True)
    time = time_of(given, at)

    from gbeam.analysis.equilibrium.operating_point import held_base
    from gbeam.analysis.study.study import structure_of
    from gbeam.analysis.vibration import stability
    from gbeam.report import as_json

    with Watch(), given.placing():
        structure = structure_of(given.case).at_time(time)
        if raised == "rate":
            found = stability.critical_speed(structure, chosen, upper=upper, name=name)
        elif raised == "loads":
            found = stability.critical_load(structure, held_base(chosen, time), upper=upper)
        else:
            found = stability.buckling_acceleration(structure, upper=upper)
    facts = to_json(found, name, KEYS[raised])
    write(out, facts, "critical_speed", {})
    if json:
        print(as_json(facts))
    else:
        stdout().print(f"{name}: {found.reason}", markup=False)
    return 0


def to_json(found: Critical, motion: str, key: str = "critical_speed") -> dict[str, Any]:
    """Critical value as JSON; rad/s, m/s² or a factor, null where there is none."""
    rest = asdict(found)
    value = rest.pop("value")
    return {"outcome": "done", "motion": motion, key: value, **rest}


def _map(
    given: Input,
    motion: str | None,
    masses: str,
    positions: str | None,
    upper: float | None,
    out: Path | None,
    json: bool,
) -> int:
    name, chosen = motion_of(given, motion, hubs_only=True)
    case = given.case
    kilograms = _listed("--masses", masses, "mass")
    length = case.beam.length
    places = (
        np.linspace(0, length, 9)[1:].tolist() if positions is None else _listed("--positions", positions, "length")
    )
    for place in places:
        if not 0 <= place <= length:
            raise InputError("--positions", f"has {place:g} m, off the beam", f"give 0 to {length:g} m")

    from gbeam.analysis.vibration.stability import critical_speed_map
    from gbeam.report import as_json

    with Watch(), given.placing():
        found = critical_speed_map(case.beam, case.model, chosen, kilograms, places, upper, name=name)
    facts = told_map(found)
    if out is not None:
        from gbeam.plots.critical import plot_critical_map
        from gbeam.plots.style import save

        def make(hidden: Path) -> None:
            (hidden / "critical_speed.json").write_text(as_json(facts) + "\n", encoding="utf-8")
            head = ",".join(["position_m", *(f"critical_rad_per_s_with_{m:g}_kg" for m in found.mass)])
            rows = np.column_stack([found.position, found.speed.T])
            np.savetxt(hidden / "critical_speed.csv", rows, "%.12g", ",", header=head, comments="")
            save(plot_critical_map(found, case.title), hidden, "critical_speed")

        publish(out, make)
    if json:
        print(as_json(facts))
    else:
        stdout().print(_text(found), markup=False)
    return 0


def _listed(option: str, text: str, kind: str) -> list[float]:
    """Quantities of one option, separated by commas."""
    values = [number(option, part.strip(), kind) for part in text.split(",")]
    if min(values) < 0:
        raise InputError(option, f"has {min(values):g}", "give none that is negative")
    return values


def told_map(found: CriticalMap) -> dict[str, Any]:
    """Map as JSON: critical_speed[i][j] with mass i at position j; rad/s, null where there is none."""
    speed = [[None if np.isnan(v) else float(v) for v in row] for row in found.speed]
    rest = {"mass": found.mass.tolist(), "position": found.position.tolist(), "critical_speed": speed}
    return {
        "outcome": "done",
        "motion": found.motion,
        "model": found.model,
        **rest,
        "searched_to": found.searched_to,
    }


def _text(found: CriticalMap) -> str:
    lines = [f"{found.motion}: {found.model}, critical hub rate in rad/s with one more mass"]
    lines.append("  at, m    " + "".join(f"{m:>9.4g} kg" for m in found.mass))
    for place, speeds in zip(found.position, found.speed.T, strict=True):
        lines.append(f"  {place:<9.4g}" + "".join("           –" if np.isnan(v) else f"{v:12.5f}" for v in speeds))
    if np.isnan(found.speed).any():
        lines.append(f"  –: none up to {found.searched_to:.4g} rad/s")
    return "\n".join(lines)
