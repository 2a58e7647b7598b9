"""Use of a machine's limits, as a table for people."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from gbeam.results.machine import LimitUse

if TYPE_CHECKING:
    from rich.table import Table


def table(uses: Iterable[LimitUse]) -> Table:
    """Return a table of what is used of each limit, when, and the share of what is allowed."""
    from rich.table import Table

    rows = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    rows.add_column("machine")
    for heading in ("used", "allowed", "share", "at, s"):
        rows.add_column(heading, justify="right")
    rows.add_column("unit")
    for use in uses:
        limited = math.isfinite(use.allowed)
        style = "bold red" if use.exceeded else None
        rows.add_row(
            f"{use.axis} {use.quantity}",
            f"{use.used:.4g}",
            f"{use.allowed:.4g}" if limited else "–",
            f"{use.share:.0%}" if limited else "–",
            f"{use.time:.3f}" if use.used > 0 else "–",
            use.unit,
            style=style,
        )
    return rows
