"""A scenario by every model, as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gbeam.results.study import ModelStudy

if TYPE_CHECKING:
    from rich.console import RenderableType

HEADINGS = ("motion", "model", "outcome", "peak, mm", "error", "residual, mm", "error", "phase, rad", "seconds")


def table(study: ModelStudy) -> RenderableType:
    """A row per motion and model, then why a row has no answer or may be doubted."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    rows = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", title=study.title or None, title_justify="left")
    for i, heading in enumerate(HEADINGS):
        rows.add_column(heading, justify="left" if i < 3 else "right")
    for row in study.rows:
        rows.add_row(
            f"{row.motion}, {study.direction[row.motion]}",
            row.model,
            row.outcome,
            _number(row.peak, ".5g", 1e3),
            _number(row.peak_error, "+.2%"),
            _number(row.residual, ".4g", 1e3),
            _number(row.residual_error, "+.2%"),
            _number(row.phase, "+.4f"),
            _number(row.seconds, ".2f"),
        )
    return Group(rows, *map(Text, _remarks(study)))


def _number(value: float, form: str, scale: float = 1.0) -> str:
    """A number; a dash where there is none, and no minus before a zero."""
    words = format(scale * value, form) if math.isfinite(value) else "–"
    return words if any(digit in words for digit in "123456789") else words.replace("-", "+")


def _remarks(study: ModelStudy) -> list[str]:
    remarks = []
    for row in study.rows:
        which = f"{row.motion}, {row.model}"
        if row.message:
            remarks.append(f"{which} {row.outcome}: {row.message}")
        # To check with exact is what this study has just done.
        remarks += [f"{which}: {warning}" for warning in row.warnings if "check with model.kind" not in warning]
    return remarks
