"""``gbeam campbell``: frequencies against the speed of a hub."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter

from gbeam.cli.common import MotionName, motion_of, number, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import Input, read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable
from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.results.modal import Campbell

Speed = Annotated[
    str | None, Parameter(help='Such as "60 rpm"; by default from rest to the largest rate of the motion.')
]


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
) -> int:
    """Frequencies against the speed of a hub, and where its multiples meet them.

    Writes campbell.json and the diagram into --out, by default out/ and the scenario's name; with --json only if --out
    is given. Exit status: 0 done, 1 there is no equilibrium, 2 the input is wrong, such as a motion without a hub.
    """
    folder = out if out is not None or json else Path("out") / scenario.stem
    if folder is not None:
        refuse_unwritable(folder)
    given = read("campbell", scenario, overrides)
    name, chosen = motion_of(given, motion, hubs_only=True)
    low = 0.0 if start is None else number("--from", start, "angular rate")
    high = _largest_rate(given, name) if end is None else number("--to", end, "angular rate")
    if not 0 <= low < high:
        raise InputError(
            "--to", f"is {high:g} rad/s, --from {low:g} rad/s", "give a range of speeds that ascends from 0"
        )
    for option, count, least in (("--modes", modes, 1), ("--orders", orders, 0)):
        if count < least:
            raise InputError(option, f"is {count}", f"give {least} or more")

    from gbeam.analysis.study.study import structure_of
    from gbeam.analysis.vibration.campbell import campbell as find
    from gbeam.report import as_json

    with Watch(), given.placing():
        found = find(
            structure_of(given.case),
            chosen,
            start=low,
            end=high,
            modes=modes,
            orders=range(1, orders + 1),
            name=name,
        )
    facts = to_json(found)
    files = []
    if folder is not None:
        from gbeam.plots.campbell import plot_campbell

        files = write(folder, facts, "campbell", {"campbell": plot_campbell(found, given.case.title)})
    if json:
        print(as_json(facts))
    else:
        stdout().print(_text(found), markup=False)
        stdout().print(f"\nfiles: {', '.join(map(str, files))}", markup=False, soft_wrap=True)
    return 0


def _largest_rate(given: Input, name: str) -> float:
    """Largest rate that a hub's profile reaches, rad/s; 1 for what has no hub, which the analysis refuses."""
    motion, settings = given.case.motions[name], given.case.response
    if given.scenario.motion[name].kind != "hub":
        return 1.0
    rate = getattr(motion, "rate", None)
    if rate is None:
        fix = 'give the largest speed, such as "5 rad/s"'
        raise InputError("--to", "is missing: the hub is driven by a torque", fix)
    times = np.linspace(settings.start, settings.start + settings.duration, 501)
    return float(np.abs(np.asarray(rate(times))).max())


def to_json(found: Campbell) -> dict[str, Any]:
    """Diagram as JSON; rad/s, Hz."""
    return {
        "outcome": "done",
        "motion": found.motion,
        "model": found.model,
        "speed": found.speed.tolist(),
        "tracks": [
            {"direction": d, "frequency": f.tolist(), "damping_ratio": z.tolist(), "mac": m.tolist()}
            for d, f, z, m in zip(found.direction, found.frequency.T, found.damping_ratio.T, found.mac.T, strict=True)
        ],
        "orders": list(found.orders),
        "crossings": [asdict(it) for it in found.crossings],
        "critical_speed": None if found.critical is None else found.critical.value,
    }


def _text(found: Campbell) -> str:
    low, high = found.speed[[0, -1]]
    lines = [f"{found.motion}: {found.model}, {low:.4g} to {high:.4g} rad/s"]
    lines.append("  mode along   Hz at the start   at the end")
    rows = enumerate(zip(found.direction, found.frequency[0], found.frequency[-1], strict=True), 1)
    lines += [f"  {i:>4} {d:>5} {first:17.6g} {last:12.6g}" for i, (d, first, last) in rows]
    lines += [
        f"  mode {it.track + 1} meets {it.order} × speed at {it.speed:.6g} rad/s, {it.frequency:.6g} Hz"
        for it in found.crossings
    ]
    if found.critical is not None:
        lines.append(f"  {found.critical.reason}")
    return "\n".join(lines)
