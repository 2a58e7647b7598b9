"""Why a centrifuge's response differs from the flight's: root loads, slow and fast parts, the mismatch, the spectra."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from gbeam.plots.lines import FLIGHT, line, machine, shade, stretches
from gbeam.plots.style import heading, moving, panels, scale_to, show_zero, styled, subtitle
from gbeam.plots.units import unit_for
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.measures import Shock
from gbeam.results.result import Floats

# Of a bending beam, by the axis along which it moves: force and moment of the root's section, and the latter's index.
_FORCES = ("axial force N", "shear V_y", "shear V_z")
_MOMENTS = (("torque", 0), ("moment M_z", 2), ("moment M_y", 1))


class _Part(NamedTuple):
    """One panel: what it shows, the kind of its unit, its label, and values by name."""

    about: str
    kind: str
    label: str
    lines: dict[str, Floats]


@styled
def plot_comparison(comparison: Comparison, title: str = "", axis: int | None = None) -> Figure:
    """Plot those parts of a comparison over time that it has, of one axis."""
    axis = comparison.main_axis if axis is None else axis
    shown = [*_root(comparison, axis), *_tip(comparison, axis), *_mismatch(comparison, axis)]
    if not shown:
        difference = {f"{comparison.centrifuge} − {comparison.flight}": comparison.difference[:, axis]}
        shown = [_Part("tip displacement", "length", "difference", difference)]
    about = f"{comparison.centrifuge} and {comparison.flight}, along {'xyz'[axis]}"
    heights = [0.85] * len(shown) if len(shown) > 1 else [1.6]
    figure, axes = panels(heading(title, about, ()), len(shown), heights=heights)
    covered = comparison.covered if comparison.covered.any() else ~comparison.covered
    for panel, part in zip(axes, shown, strict=True):
        unit = unit_for(part.kind, *(each[covered] for each in part.lines.values()))
        values = {name: unit.factor * each for name, each in part.lines.items()}
        others = 0
        for name, each in values.items():
            flown = name == comparison.flight
            line(panel, comparison.time, each, label=name, **(FLIGHT if flown else machine(min(others, 1))))
            others += not flown
        if not scale_to(panel, comparison.covered, *values.values()):
            show_zero(panel)
        subtitle(panel, part.about)
        panel.set_ylabel(f"{part.label}, {unit.name}")
    shade(axes, stretches(None, comparison.time, comparison.accounting))
    return figure


def moved(comparison: Comparison) -> list[int]:
    """Axes (0, 1, 2) along which the tip moves in flight or on the machine, the one along which it moves most first."""
    main = comparison.main_axis
    return [main, *(i for i in moving(comparison.peak_flight, comparison.peak_centrifuge) if i != main)]


def _root(comparison: Comparison, axis: int) -> Iterator[_Part]:
    if comparison.root is None:
        return
    history, (bent, k) = comparison.root.history, _MOMENTS[axis]
    for kind, name, flight, centrifuge, i in (
        ("force", _FORCES[axis], history.force_flight, history.force_centrifuge, axis),
        ("moment", bent, history.moment_flight, history.moment_centrifuge, k),
    ):
        lines = {comparison.flight: flight[:, i], comparison.centrifuge: centrifuge[:, i]}
        yield _Part("root's section", kind, name, lines)


def _tip(comparison: Comparison, axis: int) -> Iterator[_Part]:
    parts = comparison.stations
    if parts is None:
        return
    lines = {f"{comparison.centrifuge} − {comparison.flight}": parts.trend_difference[:, axis]}
    if comparison.mismatch is not None and np.isfinite(comparison.mismatch.tip_bound[axis]):
        envelope = comparison.mismatch.tip_envelope[:, axis]
        lines |= {"± what a slow mismatch implies": envelope, "_below": -envelope}
    yield _Part(f"tip's trend, below {parts.cutoff:.3g} Hz", "length", "difference", lines)
    lines = {
        comparison.flight: parts.vibration_flight[:, axis],
        comparison.centrifuge: parts.vibration_centrifuge[:, axis],
    }
    yield _Part(f"tip's elastic vibration, above {parts.cutoff:.3g} Hz", "length", "displacement", lines)


def _mismatch(comparison: Comparison, axis: int) -> Iterator[_Part]:
    if comparison.mismatch is not None:
        field = comparison.mismatch.field(np.array([0.0, comparison.mismatch.length]))[:, :, axis]
        lines = {"at the root": field[:, 0], "at the tip": field[:, 1]}
        yield _Part("load on the machine less in flight", "acceleration", "mismatch", lines)


@styled
def plot_shock(comparison: Comparison, shock: Shock, title: str = "") -> Figure:
    """Plot the shock response spectra of the tip's acceleration, along the axes in which the tip moves."""
    shown = moved(comparison)
    about = f"shock response of the tip's acceleration, Q = {shock.quality:g}"
    figure, drawn = panels(heading(title, about, ()), len(shown), heights=[1.6] * len(shown))
    for panel, axis in zip(drawn, shown, strict=True):
        panel.loglog(shock.frequency, shock.flight[:, axis], label=comparison.flight, **FLIGHT)
        panel.loglog(shock.frequency, shock.centrifuge[:, axis], label=comparison.centrifuge, **machine(0))
        for scale in (panel.xaxis, panel.yaxis):
            scale.set_major_locator(LogLocator(subs=(1, 2, 5)))
            scale.set_minor_locator(NullLocator())
            scale.set_major_formatter("{x:g}")
        panel.set_ylabel(f"largest acceleration\nalong {'xyz'[axis]}, m/s²")
    drawn[-1].set_xlabel("frequency of the oscillator, Hz")
    return figure
