"""Tables for a terminal: the study of all environments, plans of machines, and the study of models."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gbeam.report.machine import ends_line, judged_lines, not_followed_stretches, tracked
from gbeam.report.study import ROUNDING, comparison_lines, of_beam, of_machine, of_system
from gbeam.report.words import number, sentence
from gbeam.results.imitation.comparison import MachinePlan
from gbeam.results.imitation.criteria import GOOD
from gbeam.results.machine import LimitUse
from gbeam.results.response import Response
from gbeam.results.study import ModelStudy, Study, SystemStudy
from gbeam.results.system import SystemResponse


def study(study: Study | SystemStudy) -> RenderableType:
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
        parts += [_indented(Text(line)) for line in comparison_lines(each)]
    return Group(*parts)


system_study = study  # by the name of its kind


def _heading(name: str, kind: str, outcome: str) -> Text:
    colour = "green" if outcome == "done" else "bold red"
    return Text.from_markup(f"[bold]{escape(name)}[/bold]{kind}: [{colour}]{outcome}[/{colour}]")


def _common_warnings(study: Study | SystemStudy) -> list[str]:
    """Warnings of every response, such as of the beam: they are given once."""
    first, *others = study.responses.values()
    return [each for each in first.warnings if others and all(each in other.warnings for other in others)]


def _response(response: Response | SystemResponse, elsewhere: Sequence[str] = ()) -> Iterator[RenderableType]:
    kind = "" if response.name in ("", response.environment) else f" ({response.environment})"
    yield _heading(response.name or response.environment, kind, response.outcome)
    if response.message:
        yield _indented(Text(sentence(response.message), style="red"))
    if isinstance(response, Response) and response.specimen is None:
        yield _indented(_tip(response))
    lines = of_beam(response) if isinstance(response, Response) else of_system(response)
    yield from (_indented(Text(line)) for line in lines)
    if response.axes is not None:
        yield _indented(limits_table(response.axes.limits))
        yield from (_indented(Text(line)) for line in of_machine(response))
    for warning in response.warnings:
        if warning not in elsewhere:
            yield _indented(Text(f"warning: {warning}", style="yellow"))


def _indented(what: RenderableType) -> Padding:
    return Padding(what, (0, 0, 0, 2), expand=False)


def _tip(response: Response) -> Table:
    peaks = response.peaks
    residual = np.isfinite(peaks.residual_amplitude).any()
    rows = _headed(("tip", "largest, mm", "at, s", *(["residual amplitude, mm"] if residual else [])))
    directions = [*zip("xyz", peaks.max_abs, peaks.time_of_max, peaks.residual_amplitude, strict=True)]
    if (peaks.max_abs > ROUNDING * peaks.max_abs.max()).sum() > 1 and math.isfinite(peaks.max_size):
        directions.append(("size", peaks.max_size, peaks.time_of_max_size, math.nan))
    for axis, largest, when, left in directions:
        # A direction that nothing drives holds rounding errors, whose time would mean nothing.
        moves = largest > ROUNDING * peaks.max_abs.max()
        size, time = (number(1e3 * largest), f"{when:.3f}") if moves else ("0", "–")
        rows.add_row(axis, size, time, *([number(1e3 * left) if moves else "0"] if residual else []))
    return rows


HEADINGS = ("motion", "model", "outcome", "peak, mm", "error", "residual, mm", "error", "phase, rad", "seconds")


def model_study(study: ModelStudy) -> RenderableType:
    """A row per motion and model, then why a row has no answer or may be doubted."""

    rows = _headed(HEADINGS, words=(0, 1, 2), title=study.title or None, title_justify="left")
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


EPISODES, SHORTFALLS = 8, 8  # printed at most; a rough record has hundreds


def machine_plan(plans: Sequence[MachinePlan]) -> RenderableType:
    """Plans as tables of limits, each with how well the load is followed."""
    title, *_ = (plan.title for plan in plans)
    parts: list[RenderableType] = [Text(title, style="bold")] if title else []
    for plan in plans:
        axes, colour = plan.axes, "green" if plan.state in GOOD else "bold red"
        head = Text(f"{plan.name} ({plan.arm:g} m, tracks {plan.tracks}): ")
        parts += ["", head.append(plan.state, style=colour)]
        words = ends_line(plan.time, axes), tracked(plan)
        lines: list[RenderableType] = [limits_table(axes.limits), *map(Text, words)]
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
        parts += map(_indented, lines)
    return Group(*parts)


def limits_table(uses: Iterable[LimitUse]) -> Table:
    """Table of what is used of each limit, when, and the share of what is allowed."""
    rows = _headed(("machine", "used", "allowed", "share", "at, s", "unit"), words=(0, 5))
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


def _headed(heads: Sequence[str], words: Sequence[int] = (0,), **look: Any) -> Table:
    """An empty table whose columns are numbers, to the right, but for those of `words`."""
    rows = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", **look)
    for k, heading in enumerate(heads):
        rows.add_column(heading, justify="left" if k in words else "right")
    return rows
