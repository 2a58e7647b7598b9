"""A shaped command beside usual ones: the commands, the tips, and what is left where frequencies are wrong."""

from __future__ import annotations

from matplotlib.figure import Figure

from gbeam.plots.drawing.style import REFERENCE, colour, heading, panels, styled
from gbeam.plots.drawing.units import scaled_label
from gbeam.results.searches import ShapedCommand


@styled
def plot_shaping(command: ShapedCommand, title: str = "") -> Figure:
    """Plot a shaped command, a ZVD-shaped one and a smooth step.

    Parameters
    ----------
    command : ShapedCommand
    title : str
        First line.
    """
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
    """Plot what each command leaves in the design's modes, were all their frequencies others.

    Parameters
    ----------
    command : ShapedCommand
    title : str
        First line.
    """
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
