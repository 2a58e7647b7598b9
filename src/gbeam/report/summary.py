"""A study as a table for a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from gbeam.report.comparison import comparison_lines
from gbeam.report.figures import not_followed_stretches, tracking
from gbeam.report.limits import limits_table
from gbeam.results.response import AxesResult, HubResult, Response, Study
from gbeam.results.section_forces import Loads

ROUNDING = 1e-9  # of what it belongs to: a smaller number is none
EPISODES = 8  # of holding listed; a rough record has hundreds
SHORTFALLS = 2


def summary(study: Study) -> RenderableType:
    """Return the summary that `run` prints.

    Parameters
    ----------
    study : Study

    Returns
    -------
    renderable of rich
        Per environment outcome, tip displacement, accuracy, and what the machine or the hub does; then the
        comparisons.
    """
    parts: list[RenderableType] = [Text(study.title, style="bold")] if study.title else []
    for it in study.responses.values():
        parts += ["", *_response(it)]
    for name, failed in study.failures.items():
        parts += ["", _heading(name, "", failed.outcome), _indented(Text(_sentence(failed.message), style="red"))]
    for comparison in study.comparisons:
        parts += ["", Text(_sentence(comparison.verdict), style="bold")]
        parts += [_indented(Text(line)) for line in comparison_lines(comparison)]
    return Group(*parts)


def number(value: float, digits: int = 4) -> str:
    """Write a number with significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    return "0" if value == 0 else f"{value:#.{digits}g}".rstrip(".")


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _heading(name: str, kind: str, outcome: str) -> Text:
    colour = "green" if outcome == "done" else "bold red"
    return Text.from_markup(f"[bold]{escape(name)}[/bold]{kind}: [{colour}]{outcome}[/{colour}]")


def _response(it: Response) -> Iterator[RenderableType]:
    yield _heading(it.name, "" if it.name == it.environment else f" ({it.environment})", it.outcome)
    if it.message:
        yield _indented(Text(_sentence(it.message), style="red"))
    yield _indented(_tip(it))
    yield _indented(Text(_accuracy(it)))
    if it.loads is not None:
        yield _indented(Text(_loads(it.loads)))
    if it.hub is not None:
        yield _indented(Text(_hub(it.hub)))
    if it.axes is not None:
        yield _indented(limits_table(it.axes.limits))
        yield from (_indented(Text(line)) for line in _tracking(it, it.axes))
    for warning in it.warnings:
        yield _indented(Text(f"warning: {warning}", style="yellow"))


def _indented(what: RenderableType) -> Padding:
    return Padding(what, (0, 0, 0, 2), expand=False)


def _grid(*headings: str) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column(headings[0])
    for heading in headings[1:]:
        table.add_column(heading, justify="right")
    return table


def _tip(it: Response) -> Table:
    residual = np.isfinite(it.peaks.residual_amplitude).any()
    table = _grid("tip", "largest, mm", "at, s", *(["residual amplitude, mm"] if residual else []))
    rows = zip("xyz", it.peaks.max_abs, it.peaks.time_of_max, it.peaks.residual_amplitude, strict=True)
    for axis, largest, when, left in rows:
        # A direction that nothing drives holds rounding errors, whose time would mean nothing.
        moves = largest > ROUNDING * it.peaks.max_abs.max()
        size, time = (number(1e3 * largest), f"{when:.3f}") if moves else ("0", "–")
        table.add_row(axis, size, time, *([number(1e3 * left) if moves else "0"] if residual else []))
    return table


def _accuracy(it: Response) -> str:
    step = f"{it.steps} samples of adaptive steps" if math.isnan(it.step) else f"{it.steps} steps of {_time(it.step)}"
    error = (
        "no error estimate"
        if math.isnan(it.error_estimate) or it.outcome != "done"
        else f"estimated error {number(it.error_estimate, 2)} of the largest displacement"
    )
    return f"{it.model}, {it.integrator}, {step}; {error}"


def _time(seconds: float) -> str:
    return f"{number(1e3 * seconds)} ms" if seconds < 1 else f"{number(seconds)} s"


def _loads(it: Loads) -> str:
    """Largest sizes over time: at the root, of the stress, and of the torque about a hub's axis."""
    force, moment = (float(np.linalg.norm(each, axis=1).max()) for each in (it.root_force, it.root_moment))
    told = f"root: largest force {number(force)} N, moment {number(moment)} N m"
    if np.isfinite(it.stress).all():
        where = it.stations[it.stress.max(axis=0).argmax()]
        told += f"; stress {number(1e-6 * float(it.stress.max()))} MPa at {number(float(where))} m"
    if it.beam_torque is not None:
        told += f"; torque for the beam {number(float(np.abs(it.beam_torque).max()))} N m"
    return told


def _hub(it: HubResult) -> str:
    return f"hub: angle at the end {number(it.angle[-1])} rad, largest rate {number(float(abs(it.rate).max()))} rad/s"


def _tracking(response: Response, it: AxesResult) -> Iterator[str]:
    error = tracking(response.time, it)
    if error.fraction < ROUNDING:
        yield "load followed exactly"
    elif math.isfinite(error.max):
        yield (
            f"load followed within {number(error.max, 3)} m/s² ({100 * error.fraction:.3g} % of the load there), "
            f"at {error.time_of_max:.3f} s"
        )
    stretches = not_followed_stretches(it)
    for start, end, reason in stretches[:EPISODES]:
        yield f"target held {start:.3f} to {end:.3f} s: {reason}"
    if len(stretches) > EPISODES:
        yield f"target held {len(stretches) - EPISODES} times more: see the result file"
    # What is held has just been said; what is not held and yet cannot be followed is news.
    told = [each for each in it.shortfalls if not any(start <= each.time <= end for start, end, _ in stretches)]
    for each in told[:SHORTFALLS]:
        yield f"warning: {each}"
    if len(told) > SHORTFALLS:
        yield f"warning: and {len(told) - SHORTFALLS} more: see `gbeam plan`"
