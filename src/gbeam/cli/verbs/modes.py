"""``gbeam modes``: frequencies, damping and directions about a frozen motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.common import At, MotionName, along_the_beam, base_json, motion_of, time_of, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable

if TYPE_CHECKING:
    from gbeam.results.modal import Modes

ROUNDING = 1e-10  # a damping ratio smaller than this is none


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
    if out is not None:
        refuse_unwritable(out)
    given = read("modes", scenario, overrides)
    name, chosen = motion_of(given, motion)
    time = time_of(given, at)

    from gbeam.analysis.vibration.modal import modes as find
    from gbeam.report import as_json

    with Watch(), given.placing():
        found = find(along_the_beam(given), chosen, time, gyroscopic=gyroscopic, name=name)
    facts = to_json(found)
    if out is not None:
        from gbeam.plots.modes import plot_modes

        write(out, facts, "modes", {"modes": plot_modes(found, given.case.title)})
    if json:
        print(as_json(facts))
    else:
        stdout().print(_text(found), markup=False)
    return 0


def to_json(found: Modes) -> dict[str, Any]:
    """Modes as JSON: ascending; Hz, 1/s; the shapes are complex, with the largest component 1."""
    return {
        "outcome": "done",
        "motion": found.motion,
        "time": found.time,
        "model": found.model,
        "gyroscopic": found.gyroscopic,
        "base": base_json(found.base),
        "stable": found.stable,
        "modes": [
            {"frequency": float(f), "damping_ratio": float(z), "direction": d, **_shape(shape)}
            for f, z, d, shape in zip(found.frequency, found.damping_ratio, found.direction, found.shape, strict=True)
        ],
        "stations": found.stations.tolist(),
        "instabilities": [
            {"kind": it.kind, "growth_rate": it.growth_rate, "frequency": it.frequency, "direction": it.direction}
            for it in found.instabilities
        ],
        "rigid": found.rigid,
        "overdamped": [float(x) for x in found.overdamped],
    }


def _shape(shape: Any) -> dict[str, Any]:
    return {
        name: dict(zip("xyz", part.T.tolist(), strict=True))
        for name, part in (("shape", shape.real), ("shape_imaginary", shape.imag))
    }


def _text(found: Modes) -> str:
    rate = float((found.base.w_WB_B**2).sum() ** 0.5)
    lines = [f"{found.motion} at {found.time:.4g} s: {found.model}, base turning at {rate:.4g} rad/s"]
    lines += [
        f"  {i:>3}  {f:12.6g} Hz  damping {z if abs(z) > ROUNDING else 0.0:8.4g}  along {d}"
        for i, (f, z, d) in enumerate(zip(found.frequency, found.damping_ratio, found.direction, strict=True), 1)
    ]
    if found.rigid:
        lines.append("  and the free turning of hub and beam, of zero frequency")
    for it in found.instabilities:
        lines.append(f"  {it.kind} along {it.direction}: grows by {it.growth_rate:.4g} per second")
    return "\n".join(lines)
