"""Frequencies against the speed of a hub."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from gbeam.report.steady.critical import answer
from gbeam.report.words import frequency_errors, percent, warning_lines
from gbeam.results.steady.modal import Campbell


def to_json(diagram: Campbell) -> dict[str, Any]:
    """Diagram as JSON; rad/s, Hz."""
    columns = (diagram.direction, diagram.frequency.T, diagram.damping_ratio.T, diagram.mac.T)
    errors = frequency_errors(diagram.errors, len(diagram.direction))
    return {
        "outcome": "done",
        "motion": diagram.motion,
        "model": diagram.model,
        "speed": diagram.speed.tolist(),
        "tracks": [
            {
                "direction": d,
                "frequency": f.tolist(),
                "damping_ratio": z.tolist(),
                "mac": m.tolist(),
                "error_estimate": e["total"],
                "errors": e,
            }
            for d, f, z, m, e in zip(*columns, errors, strict=True)
        ],
        "orders": list(diagram.orders),
        "crossings": [asdict(crossing) | {"error_estimate": crossing.errors.total} for crossing in diagram.crossings],
        "critical_speed": None if diagram.critical is None else diagram.critical.value,
        "critical_speed_errors": None if diagram.critical is None else asdict(diagram.critical.errors),
        "warnings": list(diagram.warnings),
    }


def text(diagram: Campbell, unit: str = "rad/s", size: float = 1.0) -> str:
    """First and last frequency of each mode, crossings, and a critical speed if there is one.

    Parameters
    ----------
    diagram : Campbell
    unit : str
        Of the speeds.
    size : float
        Of the unit, rad/s.
    """
    low, high = diagram.speed[[0, -1]] / size
    lines = [f"{diagram.motion}: {diagram.model}, {low:.4g} to {high:.4g} {unit}"]
    lines.append("  mode along   Hz at the start   at the end  largest error")
    errors = [error["total"] for error in frequency_errors(diagram.errors, len(diagram.direction))]
    rows = enumerate(zip(diagram.direction, diagram.frequency[0], diagram.frequency[-1], errors, strict=True), 1)
    lines += [f"  {i:>4} {d:>5} {first:17.6g} {last:12.6g} {percent(error):>14}" for i, (d, first, last, error) in rows]
    lines += [
        f"  mode {each.track + 1} meets {each.order} × speed at {each.speed / size:.6g} {unit}, "
        f"{each.frequency:.6g} Hz; error {percent(each.errors.total)}"
        for each in diagram.crossings
    ]
    if diagram.critical is not None:
        lines.append(f"  {answer(diagram.critical)}")
    return "\n".join([*lines, *warning_lines(diagram)])
