"""What a machine uses of its limits: a table for people, objects for programs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from rich.table import Table

from gbeam.results.response import AxesResult, LimitUse


def limits_table(uses: Iterable[LimitUse]) -> Table:
    """Return a table of what is used of each limit, when, and the share of what is allowed."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("machine")
    for heading in ("used", "allowed", "share", "at, s"):
        table.add_column(heading, justify="right")
    table.add_column("unit")
    for use in uses:
        known = math.isfinite(use.allowed)
        style = "bold red" if use.exceeded else None
        table.add_row(
            f"{use.axis} {use.quantity}",
            f"{use.used:.4g}",
            f"{use.allowed:.4g}" if known else "–",
            f"{use.share:.0%}" if known else "–",
            f"{use.time:.3f}" if use.used > 0 else "–",
            use.unit,
            style=style,
        )
    return table


def limits_json(axes: AxesResult) -> list[dict[str, Any]]:
    """Return the limits as objects; null is allowed where there is none."""
    return [asdict(use) | {"share": use.share, "exceeded": use.exceeded} for use in axes.limits]
