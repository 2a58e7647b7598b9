"""The plan of a machine in words: a table for people, one JSON object for programs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from gbeam.report.figures import not_followed_stretches, tracking
from gbeam.report.limits import limits_json, limits_table
from gbeam.results.response import MachinePlan

_SHORTFALLS = 8  # told at most; a rough record has hundreds


def plan_table(title: str, plans: Iterable[MachinePlan]) -> RenderableType:
    """Return what `plan` prints."""
    parts: list[RenderableType] = [Text(title, style="bold")] if title else []
    for it in plans:
        parts += ["", Text(f"{it.name} ({it.arm:g} m, tracks {it.tracks}): {it.outcome}")]
        lines: list[RenderableType] = [limits_table(it.axes.limits), Text(_followed(it))]
        lines += [
            Text(f"target held {start:.3f} to {end:.3f} s: {why}")
            for start, end, why in not_followed_stretches(it.axes)[:8]
        ]
        lines += [Text(f"warning: {each}", style="yellow") for each in it.axes.warnings]
        told = it.axes.shortfalls[:_SHORTFALLS]
        lines += [Text(f"warning: {each}", style="yellow") for each in told]
        if len(it.axes.shortfalls) > len(told):
            lines.append(Text(f"and {len(it.axes.shortfalls) - len(told)} more: see --json"))
        parts += [Padding(line, (0, 0, 0, 2), expand=False) for line in lines]
    return Group(*parts)


def _followed(it: MachinePlan) -> str:
    error = tracking(it.time, it.axes)
    if not math.isfinite(error.max):
        return "the target is held all the time"
    return f"load followed within {error.max:.3g} m/s² ({error.fraction:.2%} of it) at {error.time_of_max:.3f} s"


def plan_json(title: str, plans: Iterable[MachinePlan], files: Iterable[Path] = ()) -> dict[str, Any]:
    """Return what `plan --json` prints."""
    told = list(plans)
    failed = [it.outcome for it in told if it.outcome != "done"]
    return {
        "title": title,
        "outcome": failed[0] if failed else "done",
        "motions": {
            it.name: {
                "tracks": it.tracks,
                "arm": it.arm,
                "outcome": it.outcome,
                "message": it.message,
                "warnings": list(it.axes.warnings),
                "limits": limits_json(it.axes),
                "tracking_error": asdict(tracking(it.time, it.axes)),
                "not_followed": [{"start": start, "end": end, "reason": why} for start, end, why in it.axes.episodes],
                "shortfalls": [asdict(each) for each in it.axes.shortfalls],
            }
            for it in told
        },
        "files": [str(file) for file in files],
    }
