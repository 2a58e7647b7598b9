"""Differences of a centrifuge's response from the flight's: root loads, slow and fast parts, loads, spectra."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    Bars,
    Figure,
    Line,
    Panel,
    ends_of,
    imitation_look,
    moving_axes,
    scale_of,
    stretches,
)
from gbeam.results.comparison import Comparison
from gbeam.results.measures import Shock
from gbeam.results.placement import Placement
from gbeam.results.result import Floats

_BENDS = (0, 2, 1)  # axis of the root's moment that bends along each axis; about x it twists
_Part = tuple[str, str, str, dict[str, Floats]]  # what it shows, SI unit, quantity, values by name


def parts(comparison: Comparison, axis: int, title: str = "") -> Figure:
    """Describe a comparison over time along an axis: root loads, tip and load, or else the tip's difference alone."""
    c = comparison
    histories = [*_root(c, axis), *_tip(c, axis), *_load_difference(c, axis)]
    histories = histories or [("tip displacement", "m", "difference", {_difference_words(c): c.difference[:, axis]})]
    height = 0.85 if len(histories) > 1 else 1.6
    spans = stretches(None, c.time, c.accounting)
    panels = tuple(replace(_panel(c, *part), spans=spans, height=height) for part in histories)
    return Figure(title, f"{c.centrifuge} and {c.flight}, along {'xyz'[axis]}", panels)


def _panel(c: Comparison, title: str, si: str, quantity: str, lines: dict[str, Floats]) -> Panel:
    """Panel of lines by name, the flight's broad, scaled to the times at which the target is the flight's load."""
    is_shown = c.covered if c.covered.any() else ~c.covered
    scale, unit = scale_of(si, *(history[is_shown] for history in lines.values()))
    other_names = [name for name in lines if name != c.flight]
    looks = {name: imitation_look(min(k, 1)) for k, name in enumerate(other_names)} | {c.flight: FLIGHT}
    values = {name: scale * history for name, history in lines.items()}
    panel_lines = tuple(Line(c.time, history, name, **looks[name]) for name, history in values.items())
    limits = ends_of(c.covered, *values.values())
    return Panel(f"{quantity}, {unit}", panel_lines, title, limits=limits, zero=limits is None)


def moved_axes(comparison: Comparison) -> list[int]:
    """Axes (0, 1, 2) along which the tip moves in flight or on the machine, the one along which it moves most first."""
    main = comparison.main_axis
    return [main, *(i for i in moving_axes(comparison.peak_flight, comparison.peak_centrifuge) if i != main)]


def _difference_words(c: Comparison) -> str:
    return f"{c.centrifuge} − {c.flight}"


def _root(c: Comparison, axis: int) -> Iterator[_Part]:
    """Histories of the force along an axis at the root, and of the moment that bends along it."""
    if c.root is None:
        return
    history, k = c.root.history, _BENDS[axis]
    for si, name, flight, centrifuge, i in (
        ("N", f"force along {'xyz'[axis]}", history.force_flight, history.force_centrifuge, axis),
        ("N m", f"moment about {'xyz'[k]}", history.moment_flight, history.moment_centrifuge, k),
    ):
        yield "loads at the root", si, name, {c.flight: flight[:, i], c.centrifuge: centrifuge[:, i]}


def _tip(c: Comparison, axis: int) -> Iterator[_Part]:
    """Histories of the tip's slow difference, of the one that the load's implies, and of the tip's vibrations."""
    stations = c.stations
    if stations is None:
        return
    lines = {_difference_words(c): stations.trend_difference[:, axis]}
    if c.load_difference is not None and np.isfinite(c.load_difference.tip_bound[axis]):
        envelope = c.load_difference.tip_envelope[:, axis]
        lines |= {"what a slow difference of load implies": envelope, "and its negative": -envelope}
    yield f"tip's trend, below {stations.cutoff:.3g} Hz", "m", "difference", lines
    lines = {c.flight: stations.vibration_flight[:, axis], c.centrifuge: stations.vibration_centrifuge[:, axis]}
    yield f"tip's elastic vibration, above {stations.cutoff:.3g} Hz", "m", "displacement", lines


def _load_difference(c: Comparison, axis: int) -> Iterator[_Part]:
    if c.load_difference is not None:
        field = c.load_difference.field(np.array([0.0, c.load_difference.length]))[:, :, axis]
        lines = {"at the root": field[:, 0], "at the tip": field[:, 1]}
        yield "load on the machine less in flight", "m/s^2", "difference", lines


def shock(comparison: Comparison, spectra: Shock, title: str = "") -> Figure:
    """Describe the shock response spectra along the axes in which they are not small."""
    panels, main = [], comparison.main_axis
    scale, unit = scale_of("m/s^2", spectra.flight, spectra.centrifuge)
    for axis in sorted(moving_axes(spectra.flight, spectra.centrifuge), key=lambda k: k != main):
        lines = (
            Line(spectra.frequency, scale * spectra.flight[:, axis], comparison.flight, **FLIGHT),
            Line(spectra.frequency, scale * spectra.centrifuge[:, axis], comparison.centrifuge, **imitation_look(0)),
        )
        label = f"largest acceleration along {'xyz'[axis]}, {unit}"
        panels.append(Panel(label, lines, x="frequency of the oscillator, Hz", logarithmic=True, height=1.6))
    subject = f"shock response of the acceleration of {spectra.control}, Q = {spectra.quality:g}"
    return Figure(title, subject, tuple(panels))


def placement(result: Placement, title: str = "") -> Figure:
    """Describe the difference of the load that a placement leaves, by each measure, beside other control points."""
    measures = tuple(next(iter(result.values.values()), {}))
    bars = {}
    for place, values in result.values.items():
        bars[place] = 100 * np.array([values[name] for name in measures])
    panel = Panel(
        "",
        x="difference of the load over flight's peak, %",
        bars=Bars(measures, bars),
        height=max(1.0, 0.3 * len(measures)),
    )
    return Figure(title, f"{result.centrifuge} in place of {result.flight}: best and other control points", (panel,))
