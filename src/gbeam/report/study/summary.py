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
from gbeam.report.machine.tracking import ends_line, not_followed_stretches, tracking
from gbeam.report.study import comparison
from gbeam.report.words import error_words, number, percent, sentence, stress_words
from gbeam.results.machine import AxesResult
from gbeam.results.peaks import LoadPeaks
from gbeam.results.response import HubResult, Response
from gbeam.results.section_forces import Loads
from gbeam.results.study import Study

ROUNDING = 1e-9  # of what it belongs to: a smaller number is none
EPISODES = 8  # of holding listed; a rough record has hundreds
SHORTFALLS = 2


def table(study: Study) -> RenderableType:
    """Study as tables and lines.

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
    yield _indented(Text(_accuracy(response)))
    if response.initial:
        yield _indented(Text(response.initial))
    if response.loads is not None and response.peaks.loads is not None:
        yield _indented(Text(_loads(response.loads, response.peaks.loads)))
    if response.hub is not None:
        yield _indented(Text(_hub(response.hub)))
        if response.hub.free and np.any(response.damping_ratio):
            yield _indented(Text(_damping(response)))
    if response.axes is not None:
        yield _indented(limits.table(response.axes.limits))
        yield from (_indented(Text(line)) for line in _tracking(response, response.axes))
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


def _accuracy(response: Response) -> str:
    if math.isnan(response.step):
        step = f"{response.steps} samples of adaptive steps"
    else:
        step = f"{response.steps} steps of {_time(response.step)}"
    if math.isnan(response.error_estimate) or response.outcome != "done":
        error = "no error estimate"
    else:
        error = f"estimated error {error_words(response.errors.displacement)} of the largest displacement"
        if math.isfinite(response.errors.loads.total):
            error += f", {percent(response.errors.loads.total)} of the largest root load"
    return f"{response.model}, {response.integrator}, {step}; {error}"


def _damping(response: Response) -> str:
    """What the damping ratio is of where that is not obvious: with a free hub the beam's modes are others."""
    ratios = np.atleast_1d(response.damping_ratio)
    size = " to ".join(f"{100 * each:.3g}" for each in sorted({float(ratios.min()), float(ratios.max())}))
    return f"damping {size} % of critical, of the modes of the beam on a hub at rest; those with the free hub have more"


def _time(seconds: float) -> str:
    return f"{number(1e3 * seconds)} ms" if seconds < 1 else f"{number(seconds)} s"


def _loads(loads: Loads, peaks: LoadPeaks) -> str:
    """Largest sizes over time: at the root, of the stress, and of the torque about a hub's axis."""
    force, moment = (float(each[0].size.value) for each in (peaks.force, peaks.moment))
    words = f"root: largest force {number(force)} N, moment {number(moment)} N m"
    if np.isfinite(peaks.tension.value).all():
        extremes = peaks.tension.value, peaks.compression.value
        words += f"; {stress_words(loads.stations, *extremes, loads.yield_strength)}"
    if peaks.beam_torque is not None:
        words += f"; torque for the beam {number(float(peaks.beam_torque.value))} N m"
    return words


def _hub(hub: HubResult) -> str:
    rate = float(abs(hub.rate).max())
    return f"hub: angle at the end {number(hub.angle[-1])} rad, largest rate {number(rate)} rad/s"


def _tracking(response: Response, axes: AxesResult) -> Iterator[str]:
    yield ends_line(response.time, axes)
    error = tracking(response.time, axes)
    if error.fraction < ROUNDING:
        yield "load followed exactly"
    elif math.isfinite(error.max):
        yield (
            f"load followed within {number(error.max, 3)} m/s² ({100 * error.fraction:.3g} % of the load there), "
            f"at {error.time_of_max:.3f} s"
        )
    stretches = not_followed_stretches(axes)
    for start, end, reason in stretches[:EPISODES]:
        yield f"target held {start:.3f} to {end:.3f} s: {reason}"
    if len(stretches) > EPISODES:
        yield f"target held {len(stretches) - EPISODES} times more: see the result file"
    # Stretches in which the target is held are listed above; a load that is followed and yet out of reach is news.
    others = [each for each in axes.shortfalls if not any(start <= each.time <= end for start, end, _ in stretches)]
    for each in others[:SHORTFALLS]:
        yield f"warning: {each}"
    if len(others) > SHORTFALLS:
        yield f"warning: and {len(others) - SHORTFALLS} more: see `gbeam plan`"
