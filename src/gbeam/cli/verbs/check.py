"""``gbeam check``: what a scenario means, without computing a response."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gbeam.cli.console import stdout
from gbeam.cli.inputs import Input, read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable

MODES = 6  # natural frequencies told


def check(scenario: ScenarioFile, /, *, overrides: Overrides = (), out: Out = None, json: Json = False) -> int:
    """Say what a scenario means, without computing a response.

    Loads, validates and builds everything, and tells the beam's mass, its natural frequencies at rest, the motions and
    the duration. With --out also writes check.json. Exit status: 0 the scenario is sound, 2 it is not.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("check", scenario, overrides)
    with given.placing():
        facts = describe(given)

    from gbeam.report import as_json

    text = as_json(facts)
    if out is not None:
        publish(out, lambda hidden: Path(hidden / "check.json").write_text(text + "\n", encoding="utf-8"))
    if json:
        print(text)
    else:
        stdout().print(_told(facts), markup=False)
    return 0


def describe(given: Input) -> dict[str, Any]:
    """Return what a scenario says, in SI units."""
    from gbeam.analysis.study.study import structure_of
    from gbeam.mechanics.assembly import rest_modes
    from gbeam.mechanics.basis import quadrature
    from gbeam.mechanics.energy import rest_matrices

    case = given.case
    beam, settings = case.beam, case.response
    structure = structure_of(case)
    frequencies, modes = rest_modes(*rest_matrices(structure.system.energy))
    # Which group of coordinates moves most says along which axis a mode bends.
    groups = np.repeat(("axial", "y", "z"), structure.counts)
    directions = [str(groups[i]) for i in np.abs(modes).argmax(axis=0)]
    rule = quadrature(beam.length, 4, beam.section.stations)
    beam_mass = beam.material.density * float(np.sum(beam.section.at(rule.node).area * rule.weight))
    return {
        "title": case.title,
        "beam": {
            "length": beam.length,
            "mass": beam_mass,
            "masses": [{"at": it.at, "mass": it.mass} for it in beam.masses],
            "total_mass": beam_mass + sum(it.mass for it in beam.masses),
        },
        "model": {"kind": case.model.kind, "modes": dict(zip(("axial", "y", "z"), case.model.counts, strict=True))},
        "modes": [
            {"frequency": float(f / (2 * np.pi)), "direction": d}
            for f, d in list(zip(frequencies, directions, strict=True))[:MODES]
        ],
        "motions": {
            name: {"kind": it.kind, **({"tracks": case.tracks[name]} if name in case.tracks else {})}
            for name, it in given.scenario.motion.items()
        },
        "response": {
            "start": settings.start,
            "duration": settings.duration,
            "step": "auto" if settings.step is None else settings.step,
            "integrator": settings.integrator,
        },
    }


def _told(facts: dict[str, Any]) -> str:
    beam, model, response = facts["beam"], facts["model"], facts["response"]
    lumped = len(beam["masses"])
    with_masses = f", {beam['total_mass']:.4g} kg with {lumped} added" if lumped else ""
    counts = ", ".join(f"{count} {name}" for name, count in model["modes"].items())
    step = response["step"] if response["step"] == "auto" else f"{1e3 * response['step']:.4g} ms"
    modes = ", ".join(f"{it['frequency']:.4g} ({it['direction']})" for it in facts["modes"])
    lines = [
        facts["title"] or "(no title)",
        f"  beam      {1e3 * beam['length']:.4g} mm, {beam['mass']:.4g} kg{with_masses}",
        f"  model     {model['kind']}, coordinates: {counts}",
        f"  modes     at rest, Hz: {modes}",
    ]
    for i, (name, it) in enumerate(facts["motions"].items()):
        kind = it["kind"] + (f" that tracks {it['tracks']}" if "tracks" in it else "")
        lines.append(f"  {'motions' if i == 0 else '':<9} {name}" + (f": {kind}" if kind != name else ""))
    lines.append(
        f"  response  {response['start']:.4g} to {response['start'] + response['duration']:.4g} s, "
        f"{response['integrator']}, step {step}"
    )
    return "\n".join([*lines, "The scenario is sound."])
