"""``gbeam static``: where the beam rests at a frozen motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.cli.common import At, MotionName, along_the_beam, base_json, motion_of, time_of, write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable

if TYPE_CHECKING:
    from gbeam.results.modal import Deflection
    from gbeam.results.section_forces import Loads


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
    """Where the beam rests relative to its base at one time of the motions, and what its sections carry.

    Without --motion for all of them. With --out also writes static.json and plots of shapes and loads. Exit status:
    0 done, 1 there is no equilibrium, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("static", scenario, overrides)
    chosen = dict(given.case.motions) if motion is None else dict([motion_of(given, motion)])
    time = time_of(given, at)

    from gbeam.analysis.equilibrium.static import static
    from gbeam.report import as_json

    with Watch(), given.placing():
        structure = along_the_beam(given)
        found = [static(structure, it, time, name=name, beam=given.case.beam) for name, it in chosen.items()]
    facts = {"title": given.case.title, "outcome": "done", "motions": {it.motion: to_json(it) for it in found}}
    if out is not None:
        from gbeam.plots.loads import plot_loads_along
        from gbeam.plots.static import plot_static

        title = given.case.title
        loads = {f"loads_{it.motion}": plot_loads_along(it, it.loads, title) for it in found if it.loads is not None}
        write(out, facts, "static", {"static": plot_static(found, title), **loads})
    if json:
        print(as_json(facts))
    else:
        stdout().print("\n".join(map(_text, found)), markup=False)
    return 0


def to_json(found: Deflection) -> dict[str, Any]:
    """Deflection as JSON; m, J, N, N m, Pa."""
    assert found.loads is not None
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
        "loads": loads_told(found.loads),
    }


def loads_told(it: Loads) -> dict[str, Any]:
    """Loads of one time as JSON: of the base on the root, base axes; along the beam, section axes."""

    def xyz(values: Any) -> dict[str, Any]:
        return dict(zip("xyz", values.T.tolist(), strict=True))

    told: dict[str, Any] = {
        "root_force": xyz(it.root_force[0]),
        "root_moment": xyz(it.root_moment[0]),
        "stations": it.stations.tolist(),
        "section_force": xyz(it.section_force[0]),
        "section_moment": xyz(it.section_moment[0]),
        "stress": it.stress[0].tolist(),
    }
    if it.beam_torque is not None:
        told["beam_torque"] = float(it.beam_torque[0])
    return told


def _text(found: Deflection) -> str:
    x, y, z = _tidy(1e3 * found.tip, 1e3 * np.abs(found.displacement).max())
    warning = "" if found.stable else "; UNSTABLE: the stiffness there is not positive definite"
    tip = f"tip x {x:.6g} mm, y {y:.6g} mm, z {z:.6g} mm"
    return f"{found.motion} at {found.time:.4g} s: {tip} ({found.model}){warning}\n  {_carried(found.loads)}"


def _carried(it: Loads | None) -> str:
    assert it is not None
    pull = float(np.abs(it.force).max())
    turn = max(float(np.abs(it.moment).max()), pull * it.stations[-1])
    force, moment = (
        ", ".join(f"{value:.5g}" for value in _tidy(each[0], size))
        for each, size in ((it.root_force, pull), (it.root_moment, turn))
    )
    told = f"base on root: force ({force}) N, moment ({moment}) N m"
    if np.isfinite(it.stress).all():
        told += f"; stress up to {1e-6 * it.stress.max():.5g} MPa at {it.stations[it.stress[0].argmax()]:.4g} m"
    if it.beam_torque is not None:
        told += f"; torque for the beam {_tidy(it.beam_torque, turn)[0]:.5g} N m"
    return told


def _tidy(values: Any, size: float) -> list[float]:
    """Values without the rounding of what is `size` large."""
    return [float(value) if abs(value) > 1e-10 * size else 0.0 for value in values]
