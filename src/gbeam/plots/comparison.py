"""Why a centrifuge's response differs from the flight's: root loads, slow and fast parts, the mismatch, the spectra."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from gbeam.plots.style import REFERENCE, colour, heading, legend, line, panels, scale_to, shade, show_zero, styled
from gbeam.results.comparison import Comparison
from gbeam.results.measures import Shock
from gbeam.results.result import Floats

_Lines = tuple[str, dict[str, Floats]]  # what is drawn, with its unit; values by name


@styled
def plot_comparison(comparison: Comparison, title: str = "") -> Figure:
    """Plot those parts of a comparison over time that it has.

    Parameters
    ----------
    comparison : Comparison
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Force and moment at the root; the difference of the tip's trends, beside what the mismatch implies if it acts
        slowly; the tip's elastic vibration; the mismatch at both ends of the beam. Where it has none of these, the
        difference of the tip's displacement.
    """
    axis = comparison.main_axis
    shown = [*_root(comparison, axis), *_tip(comparison, axis), *_mismatch(comparison, axis)]
    about = f"{comparison.centrifuge} and {comparison.flight}: root loads, tip and mismatch along {'xyz'[axis]}"
    if not shown:
        shown = [("difference, mm", {"": 1e3 * comparison.difference[:, axis]})]
        about = f"tip displacement along {'xyz'[axis]}, {comparison.centrifuge} − {comparison.flight}"
    heights = [0.85] * len(shown) if len(shown) > 1 else [1.6]
    figure, axes = panels(heading(title, about, ()), len(shown), heights=heights)
    for panel, (label, lines) in zip(axes, shown, strict=True):
        for k, (name, values) in enumerate(lines.items()):
            if name == comparison.flight:  # broad, below what imitates it
                line(panel, comparison.time, values, label=name, color=REFERENCE, lw=1.8, zorder=1.9)
            else:
                line(panel, comparison.time, values, label=name, color=colour(min(k, 1)), lw=0.9)
        if not scale_to(panel, comparison.covered, *lines.values()):
            show_zero(panel)
        shade(panel, comparison.time, ~comparison.covered)
        panel.set_ylabel(label)
        if panel.get_legend_handles_labels()[1]:
            legend(panel)
    return figure


def _root(comparison: Comparison, axis: int) -> Iterator[_Lines]:
    if comparison.root is None:
        return
    history, bent = comparison.root.history, comparison.root.main
    for label, flight, centrifuge, k in (
        (("axial force", "shear", "shear")[axis] + ", N", history.force_flight, history.force_centrifuge, axis),
        (f"moment\n{('torque', 'M_y', 'M_z')[bent]}, N m", history.moment_flight, history.moment_centrifuge, bent),
    ):
        yield f"root's {label}", {comparison.centrifuge: centrifuge[:, k], comparison.flight: flight[:, k]}


def _tip(comparison: Comparison, axis: int) -> Iterator[_Lines]:
    parts = comparison.stations
    if parts is None:
        return
    lines = {f"{comparison.centrifuge} − {comparison.flight}": 1e3 * parts.trend_difference[:, axis]}
    if comparison.mismatch is not None and np.isfinite(comparison.mismatch.tip_bound[axis]):
        envelope = 1e3 * comparison.mismatch.tip_envelope[:, axis]
        lines |= {"± what a slow mismatch implies": envelope, "_below": -envelope}
    yield "trend's difference,\nmm", lines
    yield (
        f"elastic vibration\nabove {parts.cutoff:.3g} Hz, mm",
        {
            comparison.centrifuge: 1e3 * parts.vibration_centrifuge[:, axis],
            comparison.flight: 1e3 * parts.vibration_flight[:, axis],
        },
    )


def _mismatch(comparison: Comparison, axis: int) -> Iterator[_Lines]:
    if comparison.mismatch is not None:
        field = comparison.mismatch.field(np.array([0.0, comparison.mismatch.length]))[:, :, axis]
        yield "mismatch, m/s²", {"at the root": field[:, 0], "at the tip": field[:, 1]}


@styled
def plot_shock(comparison: Comparison, shock: Shock, title: str = "") -> Figure:
    """Plot the shock response spectra of the tip's acceleration, along the axis in which the tip moves most.

    Parameters
    ----------
    comparison : Comparison
    shock : Shock
        Its spectra.
    title : str
        Of the scenario.
    """
    axis = comparison.main_axis
    about = f"shock response of the tip's acceleration along {'xyz'[axis]}, Q = {shock.quality:g}"
    figure, (panel,) = panels(heading(title, about, ()), 1, heights=[1.6])
    panel.loglog(shock.frequency, shock.centrifuge[:, axis], color=colour(0), label=comparison.centrifuge)
    panel.loglog(shock.frequency, shock.flight[:, axis], color=REFERENCE, lw=0.8, label=comparison.flight)
    for scale in (panel.xaxis, panel.yaxis):
        scale.set_major_locator(LogLocator(subs=(1, 2, 5)))
        scale.set_minor_locator(NullLocator())
        scale.set_major_formatter("{x:g}")
    panel.set_xlabel("frequency of the oscillator, Hz")
    panel.set_ylabel("largest acceleration, m/s²")
    legend(panel)
    return figure
