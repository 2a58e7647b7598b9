"""Many cases, what samples say, and what searches find."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.figures.description import GREY, REFERENCE, Area, Bars, Figure, Line, Map, Mark, Panel, readable_scale
from gbeam.printable import raised
from gbeam.results.cases import PROBABILITY, SAMPLE, Parameter, Sensitivity, Sweep
from gbeam.results.result import Floats
from gbeam.results.searches import Fit, FittedColumn, Optimum, ShapedCommand

FAMILY = 6  # lines that can be told apart; more are a heat map
_POINTS = 3  # of a grid that are drawn as bands of their own
_BARS = 14  # that can be read; the others are less
_HEIGHT = 0.13  # of a panel's usual height, for a bar
_DOTS = 400  # data that can be told apart
_SIGMAS = 2.0


def sweep(result: Sweep, name: str, title: str = "") -> Figure:
    """Describe one measure of a sweep over its parameters: lines, a heat map, or the distribution of random draws."""
    values = result.measures[name]
    if values.ndim > 2:
        raise InputError("sweep", f"varies {values.ndim} values", "draw one with to_xarray(), or vary two or fewer")
    factor, label = readable_scale(name, result.units[name], values)
    not_done = [f"{count} {outcome}" for outcome, count in result.counts.items() if outcome != "done"]
    subject = name + (f" (of {result.outcome.size} cases {', '.join(not_done)})" if not_done else "")
    if values.ndim == 2 and SAMPLE not in result.dimensions:
        panels = [_surface(result, factor * values, label)]
    elif result.dimensions == (SAMPLE,):
        # How the draws are distributed, then over each value that is drawn.
        panels = [_histogram(factor * values, label)]
        panels += [_scatter(drawn, factor * values, label) for drawn in result.parameters if drawn.numeric]
    else:
        panels = [_parameter_panel(result.parameters[0], _bands if values.ndim == 2 else _line, factor * values, label)]
    return Figure(title or result.title, subject, tuple(replace(panel, height=2.0) for panel in panels))


def _parameter_panel(parameter: Parameter, draw: Any, values: Floats, label: str) -> Panel:
    """A panel over a parameter, whose words stand at 0, 1, 2 …"""
    x, ticks = _places(parameter)
    panel: Panel = draw(x, values, label)
    return replace(panel, x=_axis_label(parameter), ticks=ticks)


def _places(parameter: Parameter) -> tuple[Floats, tuple[str, ...]]:
    if parameter.numeric:
        return np.asarray(parameter.values, dtype=float), ()
    return np.arange(len(parameter.values), dtype=float), tuple(map(str, parameter.values))


def _line(x: Floats, values: Floats, label: str) -> Panel:
    order = np.argsort(x, kind="stable")
    return Panel(label, (Line(x[order], values[order], label, marks="joined"),), named=False)


def _scatter(parameter: Parameter, values: Floats, label: str) -> Panel:
    order = np.argsort(np.asarray(parameter.values, dtype=float))
    x = np.asarray(parameter.values, dtype=float)[order]
    return Panel(label, (Line(x, values[order], label, marks="dots"),), x=_axis_label(parameter), named=False)


def _bands(x: Floats, values: Floats, label: str) -> Panel:
    """Median and the middle nine tenths of the samples over a parameter."""
    rows = np.isfinite(values).any(axis=1)
    quantiles = np.full((3, len(values)), np.nan)
    quantiles[:, rows] = np.nanquantile(values[rows], [0.05, 0.5, 0.95], axis=1)
    low, middle, high = quantiles
    return Panel(label, (Line(x, middle, "median", marks="joined"),), areas=(Area(x, low, high, "5 % to 95 %"),))


def _histogram(values: Floats, label: str) -> Panel:
    """Histogram of the cases that have a value, with marks at the median, 5 and 95 %."""
    finite = values[np.isfinite(values)]
    title = "lines: median, 5 and 95 %"
    if not len(finite):
        return Panel("cases", title=title, x=label)
    counts, edges = np.histogram(finite, bins=max(5, round(math.sqrt(len(finite)))))
    x, high = np.repeat(edges, 2), np.array([0, *np.repeat(counts, 2), 0], dtype=float)
    marks = tuple(Mark(float(np.quantile(finite, share)), f"{100 * share:g} %") for share in (0.05, 0.5, 0.95))
    return Panel("cases", title=title, x=label, areas=(Area(x, 0 * high, high, "cases"),), marks=marks, named=False)


def _surface(result: Sweep, values: Floats, label: str) -> Panel:
    """Panel of a measure over two parameters: lines where one parameter has few values, else a heat map."""
    first, second = result.parameters
    if len(first.values) < len(second.values) or not first.numeric:
        first, second, values = second, first, values.T
    if len(second.values) > FAMILY and first.numeric and second.numeric:
        outcomes = result.outcome if first is result.parameters[0] else result.outcome.T
        outcome = tuple(map(str, outcomes.ravel()))
        cells = Map(first.values.tolist(), second.values.tolist(), values, label, outcome)
        return Panel(_axis_label(second), title=label, x=_axis_label(first), map=cells)
    x, ticks = _places(first)
    lines = tuple(
        Line(x, values[:, k], _value(second, k), colour=k % 6, marks="joined") for k in range(len(second.values))
    )
    return Panel(label, lines, second.path.replace("motion.", "", 1), x=_axis_label(first), ticks=ticks)


def _value(parameter: Parameter, k: int) -> str:
    value = parameter.values[k]
    return value if isinstance(value, str) else f"{value:.4g} {raised(parameter.unit)}".rstrip()


def _axis_label(parameter: Parameter) -> str:
    return f"{parameter.path}, {raised(parameter.unit)}" if parameter.unit else parameter.path


def history(result: Sweep, name: str, title: str = "") -> Figure:
    """Describe a history of all cases: median and band of nine tenths of random draws, or a line for each case."""
    values, time = result.histories[name], result.time
    factor, label = readable_scale(name, result.units[name], values)
    lines: list[Line] = []
    areas: list[Area] = []
    note = ""
    if name in result.statistics:
        statistics, note = result.statistics[name], "dotted: 95 % confidence of the band's edges"
        for k, place in enumerate(list(np.ndindex(statistics.values.shape[:-3]))[:_POINTS]):
            low, middle, high = (factor * statistics[quantile][place] for quantile in ("5 %", "median", "95 %"))
            areas.append(Area(time, low[:, 0], high[:, 0], f"5 to 95 %{_place(result, place)}", k))
            for edge in (low[:, 1], high[:, 2]):
                lines.append(Line(time, edge, "_95 % confidence", colour=k, dash="dotted"))
            lines.append(Line(time, middle[:, 0], f"median{_place(result, place)}", colour=k))
    else:
        for k, place in enumerate(np.ndindex(values.shape[:-1])):
            lines.append(Line(time, factor * values[place], f"_case{_place(result, place)}", colour=k % 6))
    panel = Panel(label, tuple(lines), note, areas=tuple(areas), height=2.0)
    return Figure(title or result.title, f"{name} over time", (panel,))


def _place(result: Sweep, place: tuple[int, ...]) -> str:
    """A point of the grid, in words."""
    grid = [parameter for parameter in result.parameters if not parameter.drawn]
    return "".join(f", {_value(parameter, i)}" for parameter, i in zip(grid, place, strict=True))


def indices(result: Sweep, name: str, title: str = "") -> Figure:
    """Describe the Sobol indices of a measure at the first point of the grid, with the largest on top."""
    shares = result.indices[name]
    values = np.nan_to_num(shares.values[(0,) * (shares.values.ndim - 3)])
    order = np.argsort(-values[:, 1, 0], kind="stable")
    by_bound = []  # the estimate, its low and its high end
    for bound in range(3):
        by_bound.append({"by itself": values[order, 0, bound], "in total": values[order, 1, bound]})
    bars = Bars(tuple(shares.parameters[k] for k in order), *by_bound)
    panel = Panel("", title="bars: 95 % confidence", x="Sobol index", bars=bars, height=2.0)
    return Figure(title or result.title, f"{name}: share of its variance", (panel,))


def probability(result: Sweep, name: str, title: str = "") -> Figure:
    """Describe a probability, with its bounds, over the one parameter of the grid."""

    def draw(x: Floats, values: Floats, label: str) -> Panel:
        middle, low, high = values.T
        areas = (Area(x, low, high, "95 % confidence"),)
        return Panel(label, (Line(x, middle, "estimate", marks="joined"),), areas=areas, zero=True, height=2.0)

    (parameter,) = (parameter for parameter in result.parameters if not parameter.drawn)
    panel = _parameter_panel(parameter, draw, result.statistics[name][PROBABILITY], f"probability of {name}")
    return Figure(title or result.title, f"{name}: probability", (panel,))


def fit(result: Fit, title: str = "") -> Figure:
    """Describe every column of the data and its residual."""
    panels: list[Panel] = []
    for column in result.columns:
        panels += [_of_modes(result, column)] if result.modal else _of_time(result, column)
    return Figure(title or result.title, f"fit: {_values(result)}", tuple(panels))


def _values(result: Fit | Optimum) -> str:
    """Values of a fit or an optimum in words, with their units."""
    rows = zip(result.parameters, result.values, result.units, strict=True)
    words = []
    for path, value, unit in rows:
        name = path.rpartition(".")[2] if isinstance(result, Fit) else path.replace("motion.", "", 1)
        words.append(f"{name} {value:.4g} {raised(unit)}".rstrip())
    return ", ".join(words)


def _of_time(result: Fit, column: FittedColumn) -> Sequence[Panel]:
    """Panels of a column over time: data with the fitted values, and the residual with its standard deviation."""
    factor, label = readable_scale(column.name, column.unit, column.measured)
    stride, x = max(1, len(result.at) // _DOTS), result.at
    lines = (
        Line(x, factor * column.before, "scenario as it was", colour=GREY),
        Line(x, factor * column.fitted, "fitted"),
        Line(x[::stride], factor * column.measured[::stride], "measured", colour=REFERENCE, marks="dots"),
    )
    data = Panel(label, lines, height=1.2)
    factor, label = readable_scale("", column.unit, column.residual)
    line = Line(x, factor * column.residual, "measured less fitted", colour=REFERENCE, marks="dots")
    half_width = np.full(len(x), _SIGMAS * column.noise * factor)
    band = Area(x, -half_width, half_width, "twice its standard deviation")
    title = "measured less fitted, and twice its standard deviation"
    return data, Panel(label or "1", (line,), title, areas=(band,), named=False, height=0.6)


def _of_modes(result: Fit, column: FittedColumn) -> Panel:
    """Panel of the residual of every mode as a share of its measured value, before and after the fit."""
    size = np.abs(column.measured)
    shares = {
        label: 100 * (column.measured - values) / size
        for label, values in (("before", column.before), ("fitted", column.fitted))
    }
    bars = Bars(tuple(f"mode {number:g}" for number in result.at), shares)
    return Panel("", title=f"{column.name}: measured less computed", x="%", bars=bars, height=0.9)


def optimum(result: Optimum, title: str = "") -> Figure:
    """Describe the objective over the tries that improved it, and where their values lie between the bounds."""
    o, x = result, np.arange(len(result.history), dtype=float)
    factor, label = readable_scale(o.minimise, o.unit, o.history)
    line = Line(x, factor * o.history, o.minimise, colour=REFERENCE, marks="joined")
    low, high = o.bounds.T
    shares = 100 * (o.path - low) / (high - low)
    values = tuple(Line(x, shares[:, k], path, colour=k % 6, marks="joined") for k, path in enumerate(o.parameters))
    axis_label = "tries that were better"
    panels = (
        Panel(label, (line,), x=axis_label, named=False, height=1.2),
        Panel("between bounds, %", values, x=axis_label, limits=(-3.0, 103.0)),
    )
    subject = f"{o.minimise} from {o.figure_before:.4g} to {o.figure:.4g} {raised(o.unit)}".rstrip()
    return Figure(title or o.title, subject, panels, (_values(o),), (o.outcome,))


def sensitivity(result: Sensitivity, name: str, title: str = "") -> Figure:
    """Describe how one measure changes with each parameter, with the parameters that matter most."""
    s, k = result, result.measures.index(name)
    chosen = result.ranked(name)[:_BARS]
    size = float(s.figures[k])
    left_out = len(s.parameters) - len(chosen)
    subject = f"{name} = {size:.4g} {raised(s.units[k])}".rstrip()
    subject += f" ({left_out} values that matter less are left out)" if left_out else ""
    change = 0.01 * s.derivatives[k, chosen] * s.values[chosen]
    share = bool(s.units[k]) and size != 0  # a figure without a unit is a ratio, and its change one too
    change = 100 * change / abs(size) if share else change
    names = tuple(
        f"{s.parameters[j].replace('motion.', '', 1)} = {s.values[j]:.4g} {raised(s.parameter_units[j])}".rstrip()
        for j in chosen
    )
    bars = Bars(names, {"value + 1 %": change, "value \N{MINUS SIGN} 1 %": -change})
    label = f"change of {name}, {'%' if share else raised(s.units[k])}".rstrip(", ")
    panel = Panel("", x=label, bars=bars, height=max(1.0, _HEIGHT * len(chosen) + 0.3))
    return Figure(title or s.title, subject, (panel,))


def shaping(command: ShapedCommand, title: str = "") -> Figure:
    """Describe commands over time, a shaped one, a ZVD-shaped one and a smooth step, and the tip's
    motion after each.
    """
    c = command
    axis = int(np.nan_to_num(np.abs(c.runs[-1].tip)).max(axis=0).argmax())
    factor, label = readable_scale(f"tip {'xyz'[axis]}", "m", c.runs[-1].tip[:, axis])
    commands = tuple(Line(c.time, run.command, run.name, colour=k) for k, run in enumerate(c.runs))
    tips = tuple(
        Line(run.time, factor * run.tip[:, axis], f"{run.name}: {1e3 * run.residual:.3g} mm left", colour=k)
        for k, run in enumerate(c.runs)
    )
    marks = (Mark(c.duration, "end of the command"),)
    panels = (Panel(f"{c.kind}, {raised(c.unit)}", commands), Panel(label, tips, marks=marks, height=1.3))
    return Figure(title, _subject(c), panels)


def robustness(command: ShapedCommand, title: str = "") -> Figure:
    """Describe the vibration that each command leaves if all frequencies differ from the design's by a ratio."""
    c = command
    top = 1.2 * 1e3 * float(c.runs[-1].by_ratio.max())
    lines = tuple(Line(c.ratio, 1e3 * run.by_ratio, run.name, colour=k) for k, run in enumerate(c.runs))
    spans = ((1 - c.robust, 1 + c.robust, "designed for"),) if c.robust else ()
    axis_label = "frequencies over the design's"
    panel = Panel("amplitude left, mm", lines, x=axis_label, spans=spans, limits=(0.0, top), height=1.6)
    return Figure(title, _subject(c), (panel,))


def _subject(c: ShapedCommand) -> str:
    return f"{c.kind} {c.task} in {c.duration:.4g} s, designed on {c.design}, run on {c.check}"
