"""What a file holds of a shaped command: the command, its rivals, and what each leaves."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import Group, labels, variable, words
from gbeam.results.studies.shaping import ShapedCommand


def shaping_group(c: ShapedCommand) -> Group:
    """Return what a file holds of a shaped command; the tip's histories are on the first run's times."""
    runs, first = ("run",), c.runs[0]
    unit = "N m" if c.kind == "torque" else "rad s-1"
    tips = [np.stack([np.interp(first.time, r.time, r.tip[:, i]) for i in range(3)], axis=1) for r in c.runs]
    data = {
        "command": variable((*runs, "time"), [each.command for each in c.runs], unit, f"{c.kind} of the hub"),
        "largest": variable(runs, [each.largest for each in c.runs], "1", "largest torque or angular acceleration"),
        "residual": variable(runs, [each.residual for each in c.runs], "m", "amplitude of the tip after the command"),
        "by_ratio": variable(
            (*runs, "ratio"),
            [each.by_ratio for each in c.runs],
            "m",
            "the same of the design's modes",
        ),
        "tip": variable((*runs, "run_time", "axis"), tips, "m", "displacement of the tip"),
        "outcome": words(runs, [each.outcome for each in c.runs], "how the run ended"),
        "coefficients": variable(("spline",), c.coefficients, unit, "of the quintic spline"),
        "frequency": variable(("mode",), c.frequency, "Hz", "frequencies that the design knows"),
    }
    coordinates = labels("run", [each.name for each in c.runs]) | labels("axis", ["x", "y", "z"])
    coordinates["time"] = variable(("time",), c.time, "s", "time")
    coordinates["run_time"] = variable(("run_time",), first.time, "s", "time")
    coordinates["ratio"] = variable(("ratio",), c.ratio, "1", "frequencies over those of the design")
    attrs = {"kind": c.kind, "goal": c.goal, "duration": c.duration, "robust": c.robust}
    return Group(data, coordinates, attrs | {"design": c.design, "check": c.check})
