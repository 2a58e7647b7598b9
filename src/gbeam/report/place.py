"""Where to put the specimen: in words, and as one JSON object."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from gbeam.results.placement import Candidate, Placement

_PLACES = ("best", "current", "middle")
_TOLD = 6  # options of either kind


def place_json(answer: Placement) -> dict[str, Any]:
    """Return what `place --json` prints: SI units; fractions are of flight's peaks."""
    best = answer.best
    return {
        "outcome": "done",
        "flight": answer.flight,
        "centrifuge": answer.centrifuge,
        "measure": dict(answer.weights),
        "control_point": best.control_point,
        "fraction_of_length": answer.fraction,
        "mounting": best.mounting,
        "smoothing": best.smoothing,
        "smoothing_range": list(answer.widths),
        "current_control_point": answer.current,
        "mismatch": {place: dict(values) for place, values in answer.values.items()},
        "options": [asdict(it) for it in answer.options],
        "verifications": {it.name: asdict(it) for it in answer.verifications},
        "vibration_gain_over_middle": answer.vibration_gain,
        "refused": list(answer.refused),
    }


def place_text(answer: Placement) -> str:
    """Return what `place` prints."""
    best = answer.best
    parts = {name: weight for name, weight in answer.weights.items() if weight}
    measure = (
        " + ".join(f"{weight:g} × {name}" for name, weight in parts.items()) if len(parts) > 1 else next(iter(parts))
    )
    lines = [
        f"{answer.centrifuge}, tracking {answer.flight}: least {measure}",
        f"  control point  {1e3 * best.control_point:.2f} mm from the root, {answer.fraction:.4f} of the length "
        f"(now {1e3 * answer.current:.2f} mm)",
        f"  mounting       {best.mounting}",
        f"  smoothing      {1e3 * best.smoothing:.4g} ms{_range(answer)}",
        "",
        "What the mismatch field does, of flight's peak".ljust(56) + "best       current    middle",
    ]
    for name in answer.values["best"]:
        row = "".join(f"{100 * answer.values[place][name]:<9.3g}% " for place in _PLACES)
        lines.append(f"  {name:<54}{row}")
    if answer.verifications:
        lines += ["", "Proven by the model's response, against flight"]
        for it in answer.verifications:
            lines.append(
                f"  {it.name:<8} {1e3 * it.control_point:8.2f} mm: tip within {1e3 * it.tip_difference:.4g} mm, "
                f"vibration {1e3 * it.vibration:.3g} mm, root moment within {it.moment_difference:.3g} N m"
            )
        lines.append(f"  {answer.vibration_gain:.3g} times less vibration than with the control point at mid-span")
    kept = [it for it in answer.options if not it.exceeded]
    broken = [it for it in answer.options if it.exceeded]
    lines += [
        "",
        f"Options by {measure} with what smoothing and tracking change of the load, best first",
        *(_option(it) for it in (*kept[:_TOLD], *broken[:_TOLD])),
    ]
    more = len(answer.options) - len(kept[:_TOLD]) - len(broken[:_TOLD])
    lines += [f"  and {more} more: see --json"] if more else []
    return "\n".join([*lines, *(f"  cannot: {it}" for it in answer.refused)])


def _range(answer: Placement) -> str:
    """What was searched, and whether the answer lies at its end."""
    low, high = answer.widths
    if low == high:
        return ""
    searched = f", of {1e3 * low:.4g} to {1e3 * high:.4g} ms"
    if answer.best.smoothing > low * (1 + 1e-6):
        return searched + (": the widest tried" if answer.best.smoothing > high * (1 - 1e-6) else "")
    return f"{searched}: the least tried" + ("; no limit of the machine forbids less" if answer.best.share < 1 else "")


def _option(it: Candidate) -> str:
    told = f"  {it.mounting}, {1e3 * it.smoothing:.4g} ms: {100 * it.total_error:.3g} % "
    told += f"at {1e3 * it.control_point:.2f} mm; "
    if it.exceeded:
        worst, others = max(it.exceeded, key=lambda use: use.share), len(it.exceeded) - 1
        return told + f"exceeds {worst}" + (f" and {others} more" if others else "")
    peaks = ", ".join(f"{a:.3g}" for a in it.accelerations)
    return told + f"axis accelerations {peaks} rad/s²" + (f", {it.share:.0%} of a limit" if it.share else "")
