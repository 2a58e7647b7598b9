"""A study as a table for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gbeam.report.machine import limits
from gbeam.report.study import comparison, sentences
from gbeam.report.study.sentences import ROUNDING
from gbeam.report.words import number, sentence
from gbeam.results.response import Response
from gbeam.results.study import Study


def table(study: Study) -> RenderableType:
    """Study as tables and lines."""
    parts: list[RenderableType] = [Text(study.title, style="bold")] if study.title else []
    common = _common_warnings(study)
    parts += [Text(f"warning: {warning}", style="yellow") for warning in common]
    for response in study.responses.values():
        parts += ["", *_response(response, common)]
    for name, failure in study.failures.items():
        parts += ["", _heading(name, "", failure.outcome), _indented(Text(sentence(failure.message), style="red"))]
    for each in study.comparisons:
        parts += ["", Text(sentence(each.verdict), style="bold red" if each.accepted is False else "bold")]
        parts += [_indented(Text(line)) for line in comparison.lines(each)]
    return Group(*parts)


def _heading(name: str, kind: str, outcome: str) -> Text:
    colour = "green" if outcome == "done" else "bold red"
    return Text.from_markup(f"[bold]{escape(name)}[/bold]{kind}: [{colour}]{outcome}[/{colour}]")


def _common_warnings(study: Study) -> list[str]:
    """Warnings of every response, such as of the beam: they are given once."""
    first, *others = study.responses.values()
    return [each for each in first.warnings if others and all(each in other.warnings for other in others)]


def _response(response: Response, elsewhere: Sequence[str] = ()) -> Iterator[RenderableType]:
    kind = "" if response.name == response.environment else f" ({response.environment})"
    yield _heading(response.name, kind, response.outcome)
    if response.message:
        yield _indented(Text(sentence(response.message), style="red"))
    yield _indented(_tip(response))
    yield from (_indented(Text(line)) for line in sentences.of_beam(response))
    if response.axes is not None:
        yield _indented(limits.table(response.axes.limits))
        yield from (_indented(Text(line)) for line in sentences.of_machine(response))
    for warning in response.warnings:
        if warning not in elsewhere:
            yield _indented(Text(f"warning: {warning}", style="yellow"))


def _indented(what: RenderableType) -> Padding:
    return Padding(what, (0, 0, 0, 2), expand=False)


def _tip(response: Response) -> Table:
    peaks = response.peaks
    residual = np.isfinite(peaks.residual_amplitude).any()
    rows = Table("tip", box=None, padding=(0, 2, 0, 0), header_style="dim")
    for heading in ("largest, mm", "at, s", *(["residual amplitude, mm"] if residual else [])):
        rows.add_column(heading, justify="right")
    directions = [*zip("xyz", peaks.max_abs, peaks.time_of_max, peaks.residual_amplitude, strict=True)]
    if (peaks.max_abs > ROUNDING * peaks.max_abs.max()).sum() > 1 and math.isfinite(peaks.max_size):
        directions.append(("size", peaks.max_size, peaks.time_of_max_size, math.nan))
    for axis, largest, when, left in directions:
        # A direction that nothing drives holds rounding errors, whose time would mean nothing.
        moves = largest > ROUNDING * peaks.max_abs.max()
        size, time = (number(1e3 * largest), f"{when:.3f}") if moves else ("0", "–")
        rows.add_row(axis, size, time, *([number(1e3 * left) if moves else "0"] if residual else []))
    return rows
