"""Figures of what a search finds: fits, optima, sensitivities and shaped commands."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gbeam.errors import InputError
from gbeam.plots.style import REFERENCE, colour, heading, panels, styled, subtitle
from gbeam.plots.units import scaled_label
from gbeam.results.cases import Sensitivity
from gbeam.results.searches import Fit, FittedColumn, Optimum, ShapedCommand

_DOTS = 400  # data that can be told apart
_BAND = 2.0  # sigma


@styled
def plot_fit(fit: Fit, title: str = "") -> Figure:
    """Plot every column of the data and its residual."""
    found = ", ".join(
        f"{path.rpartition('.')[2]} {value:.4g} {unit}".rstrip()
        for path, value, unit in zip(fit.parameters, fit.values, fit.units, strict=True)
    )
    heights = [each for _ in fit.columns for each in ((0.9,) if fit.modal else (1.2, 0.6))]
    figure, drawn = panels(heading(title or fit.title, f"fit: {found}", []), len(heights), heights=heights)
    for k, column in enumerate(fit.columns):
        if fit.modal:
            _modes(drawn[k], fit, column)
        else:
            _history(drawn[2 * k], fit, column)
            _residual(drawn[2 * k + 1], fit, column)
    if fit.modal:
        drawn[-1].set_xlabel("mode")
        drawn[-1].set_xticks(fit.at)
    return figure


def _history(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    power, label = scaled_label(column.name, column.unit, column.measured)
    size = 10.0**power
    every = max(1, len(fit.at) // _DOTS)
    panel.plot(fit.at, column.before / size, color="0.6", lw=0.9, label="scenario as it was")
    panel.plot(fit.at, column.fitted / size, color=colour(0), label="fitted")
    panel.plot(fit.at[::every], column.measured[::every] / size, ".", ms=2.5, color=REFERENCE, label="measured")
    panel.set_ylabel(label)


def _residual(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    power, label = scaled_label("", column.unit, column.residual)
    size = 10.0**power
    panel.plot(fit.at, column.residual / size, ".", ms=2.5, color=REFERENCE)
    panel.axhspan(-_BAND * column.noise / size, _BAND * column.noise / size, color=colour(0), alpha=0.15, lw=0)
    subtitle(panel, "measured less fitted, and twice its standard deviation")
    panel.set_ylabel(label.removeprefix(", ").strip())


def _modes(panel: Axes, fit: Fit, column: FittedColumn) -> None:
    shares = [100 * (column.measured - values) / np.abs(column.measured) for values in (column.before, column.fitted)]
    looks = ("0.6", colour(0)), ("before", "fitted")
    for offset, values, shade, label in zip((-0.17, 0.17), shares, *looks, strict=True):
        panel.bar(fit.at + offset, values, width=0.3, color=shade, label=label)
    panel.axhline(0, color=REFERENCE, lw=0.8)
    subtitle(panel, f"{column.name}: measured less computed")
    panel.set_ylabel("%")


@styled
def plot_optimum(optimum: Optimum, title: str = "") -> Figure:
    """Plot the figure over the improving tries, and where the values lie between their bounds."""
    o = optimum
    found = ", ".join(
        f"{path.replace('motion.', '', 1)} {value:.4g} {unit}".rstrip()
        for path, value, unit in zip(o.parameters, o.values, o.units, strict=True)
    )
    subject = f"{o.minimise} from {o.figure_before:.4g} to {o.figure:.4g} {o.unit}".rstrip()
    first = (title or o.title) if o.outcome == "done" else f"{o.outcome.upper()} – {title or o.title}"
    figure, (top, below) = panels(heading(first, f"{subject}\n{found}", []), 2, heights=[1.2, 1.0])
    at = np.arange(len(o.history))
    power, label = scaled_label(o.minimise, o.unit, o.history)
    top.plot(at, o.history / 10.0**power, "o-", ms=3.5, color=REFERENCE)
    top.set_ylabel(label)
    low, width = o.bounds[:, 0], o.bounds[:, 1] - o.bounds[:, 0]
    for k, path in enumerate(o.parameters):
        below.plot(at, 100 * (o.path[:, k] - low[k]) / width[k], "o-", ms=3.5, color=colour(k), label=path)
    below.set_ylim(-3, 103)
    subtitle(below, "between bounds")
    below.set_ylabel("%")
    below.set_xlabel("tries that were better")
    below.xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure


_BARS = 14  # that can be read; the others are less
_HEIGHT = 0.13  # of a panel's usual height, for a bar


@styled
def plot_sensitivity(sensitivity: Sensitivity, measure: str = "", title: str = "") -> Figure:
    """Plot how one measure changes with each parameter."""
    s, name = sensitivity, measure or sensitivity.measures[0]
    if name not in s.measures:
        raise InputError("measure", f"is {name!r}", f"choose {', '.join(s.measures)}")
    k, chosen = s.measures.index(name), s.ranked(name)[:_BARS]
    size = float(s.figures[k])
    subject = f"{name} = {size:.4g} {s.units[k]}".rstrip()
    left_out = len(s.parameters) - len(chosen)
    if left_out:
        subject += f" ({left_out} values that matter less are left out)"
    figure, (panel,) = panels(
        heading(title or s.title, subject, []), 1, heights=[max(1.0, _HEIGHT * len(chosen) + 0.3)]
    )
    change = 0.01 * s.derivatives[k, chosen] * s.values[chosen]
    share = bool(s.units[k]) and size != 0  # a figure without a unit is a ratio, and its change one too
    if share:
        change = 100 * change / abs(size)
    at = -np.arange(len(chosen))
    for sign, label in ((1, "value + 1 %"), (-1, "value \N{MINUS SIGN} 1 %")):
        panel.barh(at, sign * change, height=0.6, color=colour(0 if sign > 0 else 1), label=label)
    panel.axvline(0, color=REFERENCE, lw=0.8)
    panel.set_yticks(at, [_named(s, int(j)) for j in chosen])
    panel.set_xlabel(f"change of {name}, {'%' if share else s.units[k]}".rstrip(", "))
    return figure


def _named(s: Sensitivity, j: int) -> str:
    return f"{s.parameters[j].replace('motion.', '', 1)} = {s.values[j]:.4g} {s.parameter_units[j]}".rstrip()


@styled
def plot_shaping(command: ShapedCommand, title: str = "") -> Figure:
    """Plot a shaped command, a ZVD-shaped one and a smooth step."""
    c = command
    figure, (top, below) = panels(heading(title, _subject(c), []), 2, heights=[1.0, 1.3])
    axis = int(abs(c.runs[-1].tip).max(axis=0).argmax())
    power, label = scaled_label(f"tip {'xyz'[axis]}", "m", c.runs[-1].tip[:, axis])
    for k, run in enumerate(c.runs):
        top.plot(c.time, run.command, color=colour(k), label=run.name)
        left = f"{run.name}: {1e3 * run.residual:.3g} mm left"
        below.plot(run.time, run.tip[:, axis] / 10.0**power, color=colour(k), label=left)
    top.set_ylabel(f"{c.kind}, {c.unit}")
    below.axvline(c.duration, color=REFERENCE, lw=0.8, ls=":")
    below.set_ylabel(label)
    return figure


@styled
def plot_robustness(command: ShapedCommand, title: str = "") -> Figure:
    """Plot what each command leaves in the design's modes, were all their frequencies others."""
    c = command
    figure, (panel,) = panels(heading(title, _subject(c), []), 1, heights=[1.6])
    for k, run in enumerate(c.runs):
        panel.plot(c.ratio, 1e3 * run.by_ratio, color=colour(k), label=run.name)
    if c.robust:
        panel.axvspan(1 - c.robust, 1 + c.robust, color="0.93", lw=0, zorder=0.4)
    panel.set_ylim(0.0, 1.2 * 1e3 * max(float(run.by_ratio.max()) for run in c.runs[-1:]))
    panel.set_ylabel("amplitude left, mm")
    panel.set_xlabel("frequencies over the design's")
    return figure


def _subject(c: ShapedCommand) -> str:
    aim = f"to {c.goal:.4g} rad/s" if c.to_rate else f"by {c.goal:.4g} rad"
    return f"{c.kind} {aim} in {c.duration:.4g} s, designed on {c.design}, run on {c.check}"
