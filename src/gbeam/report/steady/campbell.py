"""Frequencies against the speed of a hub."""

from __future__ import annotations

from gbeam.report.steady.critical import answer
from gbeam.report.words import percent, warning_lines
from gbeam.results.modal import Campbell


def text(diagram: Campbell, unit: str = "rad/s", size: float = 1.0) -> str:
    """First and last frequency of each mode, crossings, and a critical speed if there is one."""
    low, high = diagram.speed[[0, -1]] / size
    lines = [f"{diagram.motion}: {diagram.model}, {low:.4g} to {high:.4g} {unit}"]
    lines.append("  mode along   Hz at the start   at the end  largest error")
    ends = diagram.frequency[0], diagram.frequency[-1]
    rows = enumerate(zip(diagram.direction, *ends, diagram.error_estimate, strict=True), 1)
    lines += [f"  {i:>4} {d:>5} {first:17.6g} {last:12.6g} {percent(error):>14}" for i, (d, first, last, error) in rows]
    lines += [
        f"  mode {each.track + 1} meets {each.order} × speed at {each.speed / size:.6g} {unit}, "
        f"{each.frequency:.6g} Hz; error {percent(each.errors.total)}"
        for each in diagram.crossings
    ]
    if diagram.critical is not None:
        lines.append(f"  {answer(diagram.critical)}")
    return "\n".join([*lines, *warning_lines(diagram)])
