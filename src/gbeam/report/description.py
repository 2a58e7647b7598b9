"""What a scenario means, as `check` prints it."""

from __future__ import annotations

from typing import Any

from gbeam.results.description import Description


def to_json(case: Description) -> dict[str, Any]:
    """Description as JSON; SI, frequencies in Hz."""
    return {
        "title": case.title,
        "beam": {
            "length": case.length,
            "mass": case.mass,
            "masses": [{"at": at, "mass": mass} for at, mass in case.bodies],
            "total_mass": case.total_mass,
        },
        "model": {"kind": case.model, "modes": dict(zip(("axial", "y", "z"), case.counts, strict=True))},
        "modes": [
            {"frequency": float(frequency), "direction": direction}
            for frequency, direction in zip(case.frequency, case.direction, strict=True)
        ],
        "motions": {
            name: {"kind": kind, **({"tracks": case.tracks[name]} if name in case.tracks else {})}
            for name, kind in case.motions.items()
        },
        "response": {
            "start": case.start,
            "duration": case.duration,
            "step": "auto" if case.step is None else case.step,
            "integrator": case.integrator,
        },
        "distributions": dict(case.distributions),
        "warnings": list(case.warnings),
    }


def text(case: Description) -> str:
    """Description on a few lines."""
    added = f", {case.total_mass:.4g} kg with {len(case.bodies)} added" if case.bodies else ""
    counts = ", ".join(f"{count} {name}" for name, count in zip(("axial", "y", "z"), case.counts, strict=True))
    modes = ", ".join(f"{f:.4g} ({d})" for f, d in zip(case.frequency, case.direction, strict=True))
    step = "auto" if case.step is None else f"{1e3 * case.step:.4g} ms"
    lines = [
        case.title or "(no title)",
        f"  beam      {1e3 * case.length:.4g} mm, {case.mass:.4g} kg{added}",
        f"  model     {case.model}, coordinates: {counts}",
        f"  modes     at rest, Hz: {modes}",
    ]
    for i, (name, kind) in enumerate(case.motions.items()):
        what = kind + (f" that tracks {case.tracks[name]}" if name in case.tracks else "")
        lines.append(f"  {'motions' if i == 0 else '':<9} {name}" + (f": {what}" if what != name else ""))
    end = case.start + case.duration
    lines.append(f"  response  {case.start:.4g} to {end:.4g} s, {case.integrator}, step {step}")
    for i, (path, drawn) in enumerate(case.distributions.items()):
        lines.append(f"  {'drawn' if i == 0 else '':<9} {path}: {drawn}; here its centre")
    lines += [f"  warning: {each}" for each in case.warnings]
    return "\n".join([*lines, "Scenario valid."])
