"""The plan of a machine: a table for people, one JSON object for programs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gbeam.report.machine import limits
from gbeam.report.machine.tracking import ends, ends_line, not_followed_stretches, tracking
from gbeam.results.machine import MachinePlan

if TYPE_CHECKING:
    from rich.console import RenderableType

EPISODES, SHORTFALLS = 8, 8  # printed at most; a rough record has hundreds


def table(title: str, plans: Iterable[MachinePlan]) -> RenderableType:
    """Plans as tables of limits, each with how well the load is followed."""
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text

    parts: list[RenderableType] = [Text(title, style="bold")] if title else []
    for plan in plans:
        axes = plan.axes
        parts += ["", Text(f"{plan.name} ({plan.arm:g} m, tracks {plan.tracks}): {plan.outcome}")]
        words = ends_line(plan.time, axes), _followed(plan)
        lines: list[RenderableType] = [limits.table(axes.limits), *map(Text, words)]
        lines += [
            Text(f"target held {start:.3f} to {end:.3f} s: {reason}")
            for start, end, reason in not_followed_stretches(axes)[:EPISODES]
        ]
        lines += [Text(f"warning: {warning}", style="yellow") for warning in plan.warnings]
        lines += [Text(f"warning: {shortfall}", style="yellow") for shortfall in axes.shortfalls[:SHORTFALLS]]
        if len(axes.shortfalls) > SHORTFALLS:
            lines.append(Text(f"and {len(axes.shortfalls) - SHORTFALLS} more: see --json"))
        parts += [Padding(line, (0, 0, 0, 2), expand=False) for line in lines]
    return Group(*parts)


def _followed(plan: MachinePlan) -> str:
    error = tracking(plan.time, plan.axes)
    if not math.isfinite(error.max):
        return "the target is held all the time"
    return f"load followed within {error.max:.3g} m/s² ({error.fraction:.2%} of it) at {error.time_of_max:.3f} s"


def to_json(title: str, plans: Iterable[MachinePlan], files: Iterable[Path] = ()) -> dict[str, Any]:
    """Plans by motion as JSON; SI."""
    by_name = {plan.name: plan for plan in plans}
    failed = [plan.outcome for plan in by_name.values() if plan.outcome != "done"]
    return {
        "title": title,
        "outcome": failed[0] if failed else "done",
        "motions": {name: _plan(plan) for name, plan in by_name.items()},
        "files": [str(file) for file in files],
    }


def _plan(plan: MachinePlan) -> dict[str, Any]:
    axes = plan.axes
    return {
        "tracks": plan.tracks,
        "arm": plan.arm,
        **ends(plan.time, axes),
        "outcome": plan.outcome,
        "message": plan.message,
        "warnings": list(plan.warnings),
        "limits": limits.to_json(axes),
        "tracking_error": asdict(tracking(plan.time, axes)),
        "not_followed": [{"start": start, "end": end, "reason": reason} for start, end, reason in axes.episodes],
        "shortfalls": [asdict(shortfall) for shortfall in axes.shortfalls],
    }
