"""The plan of a machine, a table for people."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gbeam.report.machine import limits
from gbeam.report.machine.accounting import judged_lines
from gbeam.report.machine.tracking import ends_line, not_followed_stretches, tracked
from gbeam.report.words import sentence
from gbeam.results.imitation.criteria import GOOD
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
        words = ends_line(plan.time, axes), tracked(plan)
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
