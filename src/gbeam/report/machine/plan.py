"""The plan of a machine: a table for people, one JSON object for programs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gbeam.report.machine import limits
from gbeam.report.machine.accounting import judged_json, judged_lines
from gbeam.report.machine.tracking import ends, ends_line, followed, not_followed_stretches, tracking_json
from gbeam.report.words import sentence
from gbeam.results.imitation.criteria import GOOD, state_of
from gbeam.results.imitation.plan import MachinePlan

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
        axes, colour = plan.axes, "green" if plan.state in GOOD else "bold red"
        head = Text(f"{plan.name} ({plan.arm:g} m, tracks {plan.tracks}): ")
        parts += ["", head.append(plan.state, style=colour)]
        words = ends_line(plan.time, axes), followed(tracking_json(plan.time, axes))
        lines: list[RenderableType] = [limits.table(axes.limits), *map(Text, words)]
        lines += [
            Text(f"target held {start:.3f} to {end:.3f} s: {reason}")
            for start, end, reason in not_followed_stretches(axes)[:EPISODES]
        ]
        lines += [Text(f"warning: {warning}", style="yellow") for warning in plan.warnings]
        lines += [Text(f"warning: {shortfall}", style="yellow") for shortfall in axes.shortfalls[:SHORTFALLS]]
        if len(axes.shortfalls) > SHORTFALLS:
            lines.append(Text(f"and {len(axes.shortfalls) - SHORTFALLS} more: see --json"))
        lines += ["", Text(sentence(plan.verdict), style="bold red" if colour != "green" else "bold")]
        lines += map(Text, judged_lines(plan))
        parts += [Padding(line, (0, 0, 0, 2), expand=False) for line in lines]
    return Group(*parts)


def to_json(title: str, plans: Iterable[MachinePlan], files: Iterable[Path] = ()) -> dict[str, Any]:
    """Plans by motion as JSON; SI."""
    by_name = {plan.name: plan for plan in plans}
    failed = [plan.outcome for plan in by_name.values() if plan.outcome != "done"]
    outcome = failed[0] if failed else "done"
    return {
        "title": title,
        "outcome": outcome,
        "state": state_of(outcome, list(by_name.values())),
        "motions": {name: _plan(plan) for name, plan in by_name.items()},
        "files": [str(file) for file in files],
    }


def _plan(plan: MachinePlan) -> dict[str, Any]:
    axes = plan.axes
    return {
        "tracks": plan.tracks,
        "arm": plan.arm,
        "control_point": axes.control_point,
        "gravity": plan.gravity,
        "mounting": plan.mounting,
        **ends(plan.time, axes),
        "outcome": plan.outcome,
        "message": plan.message,
        "verdict": plan.verdict,
        **judged_json(plan),
        "lines": list(judged_lines(plan)),
        "warnings": list(plan.warnings),
        "limits": limits.to_json(axes),
        **tracking_json(plan.time, axes),
        "not_followed": [{"start": start, "end": end, "reason": reason} for start, end, reason in axes.episodes],
        "shortfalls": [asdict(shortfall) for shortfall in axes.shortfalls],
    }
