"""Why a centrifuge's response differs from the flight's: root loads, slow and fast parts, the mismatch, the spectra."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import REFERENCE, colour, heading, legend, panels, scale_to, shade, styled
from gbeam.results.comparison import Comparison, Shock
from gbeam.results.response import Floats, Response

_Lines = tuple[str, dict[str, tuple[Floats, Floats]]]  # what is drawn, with its unit; times and values by name


@styled
def plot_comparison(it: Comparison, flight: Response, centrifuge: Response, title: str) -> Figure:
    """Plot those parts of a comparison over time that it has: one of root, stations and mismatch at least.

    Parameters
    ----------
    it : Comparison
    flight, centrifuge : Response
        Which it compares.
    title : str
        Of the scenario.

    Returns
    -------
    Figure
        Force and moment at the root; the difference of the tip's trends, beside what the mismatch implies if it acts
        slowly; the tip's elastic vibration; the mismatch at both ends of the beam.
    """
    axis = it.main_axis
    shown = [*_root(it, flight, centrifuge, axis), *_tip(it, axis), *_mismatch(it, centrifuge, axis)]
    about = f"{it.centrifuge} and {it.flight}: root loads, tip and mismatch along {'xyz'[axis]}"
    figure, axes = panels(heading(title, about, (flight, centrifuge)), len(shown), heights=[0.85] * len(shown))
    for panel, (label, lines) in zip(axes, shown, strict=True):
        for k, (name, (time, values)) in enumerate(lines.items()):
            if name == it.flight:  # broad, below what imitates it
                panel.plot(time, values, label=name, color=REFERENCE, lw=1.8, zorder=1.9)
            else:
                panel.plot(time, values, label=name, color=colour(min(k, 1)), lw=0.9)
        scale_to(panel, it.covered, *(values for time, values in lines.values() if len(time) == len(it.time)))
        shade(panel, it.time, ~it.covered)
        panel.set_ylabel(label)
        legend(panel)
    return figure


def _root(it: Comparison, flight: Response, centrifuge: Response, axis: int) -> Iterator[_Lines]:
    there, here = flight.loads, centrifuge.loads
    if it.root is None or there is None or here is None:
        return
    bent = int(np.argmax(it.root.moment_flight))
    for label, a, b, k in (
        (f"root's {('axial force', 'shear', 'shear')[axis]}, N", there.section_force, here.section_force, axis),
        (f"root's moment\n{('torque', 'M_y', 'M_z')[bent]}, N m", there.section_moment, here.section_moment, bent),
    ):
        yield label, {it.centrifuge: (centrifuge.time, b[:, 0, k]), it.flight: (flight.time, a[:, 0, k])}


def _tip(it: Comparison, axis: int) -> Iterator[_Lines]:
    parts = it.stations
    if parts is None:
        return
    lines = {"centrifuge − flight": (it.time, 1e3 * parts.trend_difference[:, axis])}
    if it.mismatch is not None and np.isfinite(it.mismatch.tip_bound[axis]):
        envelope = 1e3 * it.mismatch.tip_envelope[:, axis]
        lines |= {"± what a slow mismatch implies": (it.time, envelope), "_below": (it.time, -envelope)}
    yield "trend's difference,\nmm", lines
    yield (
        f"elastic vibration\nabove {parts.cutoff:.3g} Hz, mm",
        {
            it.centrifuge: (it.time, 1e3 * parts.vibration_centrifuge[:, axis]),
            it.flight: (it.time, 1e3 * parts.vibration_flight[:, axis]),
        },
    )


def _mismatch(it: Comparison, centrifuge: Response, axis: int) -> Iterator[_Lines]:
    if it.mismatch is not None:
        field = it.mismatch.field(np.array([0.0, centrifuge.stations[-1]]))[:, :, axis]
        yield "mismatch, m/s²", {"at the root": (it.time, field[:, 0]), "at the tip": (it.time, field[:, 1])}


@styled
def plot_shock(it: Comparison, shock: Shock, title: str) -> Figure:
    """Plot the shock response spectra of the tip's acceleration, along the axis in which the tip moves most.

    Parameters
    ----------
    it : Comparison
    shock : Shock
        Its spectra.
    title : str
        Of the scenario.
    """
    axis = it.main_axis
    about = f"shock response of the tip's acceleration along {'xyz'[axis]}, Q = {shock.quality:g}"
    figure, (panel,) = panels(heading(title, about, ()), 1, heights=[1.6])
    panel.loglog(shock.frequency, shock.centrifuge[:, axis], color=colour(0), label=it.centrifuge)
    panel.loglog(shock.frequency, shock.flight[:, axis], color=REFERENCE, lw=0.8, label=it.flight)
    panel.set_xlabel("frequency of the oscillator, Hz")
    panel.set_ylabel("largest acceleration, m/s²")
    legend(panel)
    return figure
