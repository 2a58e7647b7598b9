"""A shaped command in words."""

from __future__ import annotations

from gbeam.report.words import columns, number, percent, warning_lines
from gbeam.results.searches import ShapedCommand


def text(command: ShapedCommand) -> str:
    """Vibration that each command leaves, the shaped one first."""
    c = command
    aim = f"to {number(c.goal)} rad/s" if c.to_rate else f"by {number(c.goal)} rad"
    drive = "largest, N m" if c.kind == "torque" else "largest, rad/s^2"
    rows = [
        [run.name, f"{number(1e3 * run.residual, 3)} mm" if run.outcome == "done" else run.outcome, number(run.largest)]
        for run in c.runs
    ]
    known = f"designed on {c.design}, run on {c.check}"
    span = f", for frequencies wrong by up to {percent(c.robust)}" if c.robust else ""
    lines = [f"{c.kind} {aim} in {number(c.duration)} s, {known}{span}"]
    lines += ["  " + line for line in columns(["command", "leaves", drive], rows)]
    return "\n".join([*lines, *warning_lines(c)])
