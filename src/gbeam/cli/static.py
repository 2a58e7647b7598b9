"""``gbeam static``: where the beam rests at a frozen motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gbeam.cli.asked import At, MotionName, along_the_beam, base_json, motion_of, time_of, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable

if TYPE_CHECKING:
    from gbeam.results_modal import Deflection


def static(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """Where the beam rests relative to its base at one time of the motions.

    Without --motion for all of them. With --out also writes static.json and a plot of the shapes. Exit status: 0 done,
    1 there is no equilibrium, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("static", scenario, overrides)
    chosen = dict(given.case.motions) if motion is None else dict([motion_of(given, motion)])
    time = time_of(given, at)

    from gbeam.analysis import deflect
    from gbeam.report import as_json

    with Watch(), given.placing():
        structure = along_the_beam(given)
        found = [deflect(structure, it, time, name=name) for name, it in chosen.items()]
    facts = {"title": given.case.title, "outcome": "done", "motions": {it.motion: told(it) for it in found}}
    if out is not None:
        from gbeam.plots.static import plot_static

        write(out, facts, "static", {"static": plot_static(found, given.case.title)})
    if json:
        print(as_json(facts))
    else:
        stdout().print("\n".join(map(_text, found)), markup=False)
    return 0


def told(found: Deflection) -> dict[str, Any]:
    """Deflection as JSON; m, J."""
    return {
        "outcome": "done",
        "time": found.time,
        "model": found.model,
        "base": base_json(found.base),
        "tip": dict(zip("xyz", map(float, found.tip), strict=True)),
        "stations": found.stations.tolist(),
        "displacement": dict(zip("xyz", found.displacement.T.tolist(), strict=True)),
        "strain_energy": found.strain_energy,
        "stable": found.stable,
    }


def _text(found: Deflection) -> str:
    x, y, z = (1e3 * found.tip).tolist()
    warning = "" if found.stable else "; UNSTABLE: the stiffness there is not positive definite"
    tip = f"tip x {x:.6g} mm, y {y:.6g} mm, z {z:.6g} mm"
    return f"{found.motion} at {found.time:.4g} s: {tip} ({found.model}){warning}"
