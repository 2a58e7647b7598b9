"""One steady state: where the beam rests, the shapes of its modes, the Campbell diagram, critical speeds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    GREY,
    REFERENCE,
    ROUNDING,
    Dash,
    Figure,
    Line,
    Mark,
    Marks,
    Panel,
    Span,
    declared,
    estimated,
    imitating,
    moving,
    not_drawn,
    of_motion,
    scale_of,
    scaled,
)
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.errors import along
from gbeam.results.modal import Campbell, Modes, near_multiples
from gbeam.results.result import Floats
from gbeam.results.state_space import StateSpace

_DASHES: dict[str, Dash] = {"x": "dotted", "y": "solid", "z": "dashed", "twist": "dotted"}
SHOWN = 6  # shapes drawn


def _few(stations: Floats) -> Marks:
    """Dots where there are too few places for a line."""
    return "joined" if len(stations) < 3 else ""


def static(deflections: Sequence[Deflection], title: str = "") -> Figure:
    """Describe where the beam rests, one panel for each direction in which it moves."""
    shapes = [each.displacement for each in deflections]
    axes = moving(*shapes)
    si = declared(Deflection, "displacement")[1]
    x_scale, x_unit = scale_of("m", *(each.stations for each in deflections))
    errors = [each.errors.displacement.total for each in deflections]
    panels = []
    for i in axes:
        scale, unit = scale_of(si, *(each[:, i] for each in shapes))
        looks = [FLIGHT, *(imitating(k) for k in range(len(shapes) - 1))] if len(shapes) > 1 else [imitating(0)]
        lines = tuple(
            Line(x_scale * d.stations, scale * d.displacement[:, i], d.motion, marks=_few(d.stations), **look)
            for d, look in zip(deflections, looks, strict=True)
        )
        named = len(shapes) > 1 and i == axes[0]
        along = f"position from the root, {x_unit}"
        panels.append(Panel(f"{'xyz'[i]}, {unit}", lines, x=along, zero=True, named=named))
    subject = f"displacement at rest relative to the base, {deflections[0].model}, t = {deflections[0].time:.4g} s"
    error = {"": max((each for each in errors if math.isfinite(each)), default=math.nan)}
    return Figure(title, subject, tuple(panels), (*not_drawn(axes, *shapes), *estimated(error)))


def modes(result: Modes, title: str = "") -> Figure:
    """Describe the lowest modes, each in the direction in which it moves most."""
    x_scale, x_unit = scale_of("m", result.stations)
    lines = []
    for k in range(min(SHOWN, len(result.frequency))):
        direction = result.direction[k]
        shape = result.edge[k] if direction == "twist" else result.shape[k, :, "xyz".index(direction)]
        label = f"{result.frequency[k]:.4g} Hz, {direction}"
        real = Line(x_scale * result.stations, shape.real, label, colour=k, marks=_few(result.stations))
        lines.append(real)
        if np.abs(shape.imag).max() > 1e-6:
            lines.append(replace(real, y=shape.imag, label=f"{label}, a quarter later", dash="dotted", marks=""))
    subject = of_motion(result.motion, f"modes about the equilibrium at {result.time:.4g} s, {result.model}")
    words = declared(Modes, "shape")[0]
    panel = Panel(words, tuple(lines), x=f"position from the root, {x_unit}", height=2.0)
    errors = {"": math.nan if result.errors is None else result.errors.largest}
    return Figure(title, subject, (panel,), estimated(errors))


def campbell(diagram: Campbell, title: str = "", unit: tuple[float, str] = (1.0, "rad/s")) -> Figure:
    """Describe a Campbell diagram; `unit` is that of the speed: how many of it are 1 rad/s, and its name."""
    shown = near_multiples(diagram.frequency.T, diagram.speed, diagram.orders)
    omitted = len(diagram.direction) - len(shown)
    factor, name = unit
    speed = factor * diagram.speed
    top = 1.05 * float(np.nanmax(diagram.frequency[:, shown]))
    lines, texts = [], []
    for order in diagram.orders:
        multiple = order * diagram.speed / (2 * np.pi)
        lines.append(Line(speed, np.where(multiple <= top, multiple, np.nan), f"_{order}P", colour=GREY))
        # Where the line leaves the panel, and a little before.
        end = min(1.0, top / multiple[-1]) * 0.96 if multiple[-1] > 0 else 0.0
        if end * diagram.speed[-1] > diagram.speed[0]:
            texts.append((end * speed[-1], end * multiple[-1], f"{order}P"))
    for k in shown:
        direction = diagram.direction[k]
        dash = _DASHES[direction.rpartition(" ")[2]]  # of a system it has the body's name before
        lines.append(Line(speed, diagram.frequency[:, k], f"mode {k + 1}, {direction}", colour=k % 6, dash=dash))
    if diagram.crossings:
        met = sorted((factor * each.speed, each.frequency) for each in diagram.crossings)
        speeds, frequency = np.array(met).T
        lines.append(Line(speeds, frequency, "crossings", colour=REFERENCE, marks="rings"))
    marks: tuple[Mark, ...] = ()
    if diagram.critical is not None and diagram.critical.value is not None:
        marks = (Mark(factor * diagram.critical.value, diagram.critical.kind),)
    words, unit_name = declared(Campbell, "frequency")
    rate = "rate" if diagram.model == "system" else declared(Campbell, "speed")[0]
    over = f"{rate}, {name}"
    spans = tuple((factor * each.start, factor * each.end, "not stable") for each in diagram.unstable)
    panel = Panel(
        f"{words}, {unit_name}", tuple(lines), x=over, marks=marks, texts=tuple(texts), limits=(0.0, top), height=2.4,
        spans=spans,
    )  # fmt: skip
    turning = ", in the turning frame" if diagram.frame == "turning" else ""
    subject = of_motion(diagram.motion, f"frequencies about the equilibrium{turning}, {diagram.model}")
    subject += f"; {omitted} higher mode{'s' if omitted > 1 else ''} not drawn" if omitted else ""
    errors = {"": math.nan if diagram.errors is None else diagram.errors.largest}
    return Figure(title, subject, (panel,), estimated(errors))


def critical(lost: Critical, title: str = "") -> Figure:
    """Describe the lowest frequencies on the way to a critical value, and its errors to both sides of it."""
    end = float(lost.followed[-1])
    factor, quantity = scaled(lost.quantity, lost.unit if "/" in lost.unit else "", np.array([end]))
    known = [k for k in range(lost.frequency.shape[1]) if np.isfinite(lost.frequency[:, k]).any()]
    near = 3 * float(np.nanmax(lost.frequency[:, known[:2]], initial=0.0))
    shown = [k for k in known if np.nanmin(lost.frequency[:, k]) <= near]
    dots: Marks = "dots" if len(lost.followed) == 1 else ""
    lines = tuple(
        Line(factor * lost.followed, lost.frequency[:, k], f"frequency {k + 1}", colour=k, marks=dots) for k in shown
    )
    marks: tuple[Mark, ...] = ()
    spans: tuple[Span, ...] = ()
    error = lost.errors.total  # not finite where the exact model loses nothing, or it is not known
    if lost.value is not None:
        way = f" {along(lost.direction)}" if lost.direction else ""
        marks = (Mark(factor * lost.value, f"{lost.kind}{way}"),)
        if 0.0 < error < math.inf:
            at = factor * lost.value
            spans = (((1 - min(error, 1.0)) * at, (1 + error) * at, "estimated error"),)
    frame = " in the turning frame" if lost.frame == "turning" else ""
    panel = Panel(f"frequency{frame}, Hz", lines, x=quantity, marks=marks, spans=spans, zero=True, height=2.0)
    return Figure(title, of_motion(lost.motion, lost.reason), (panel,), estimated({"": error}))


def critical_map(critical: CriticalMap, title: str = "") -> Figure:
    """Describe a map of critical speeds, one line per mass (2009 Fig. 9 shows the stiffness at one speed instead)."""
    x_scale, x_unit = scale_of("m", critical.position)
    lines = tuple(
        Line(x_scale * critical.position, speed, f"{mass:g} kg", colour=k % 6, marks="joined")
        for k, (mass, speed) in enumerate(zip(critical.mass, critical.speed, strict=True))
    )
    panel = Panel("hub rate, rad/s", lines, x=f"position of the mass from the root, {x_unit}", zero=True, height=2.0)
    if np.isnan(critical.speed).all():
        none = f"no loss of equilibrium up to {critical.searched_to:.4g} rad/s"
        middle = x_scale * float(np.mean(critical.position)), critical.searched_to / 2
        panel = replace(panel, texts=((*middle, none),), limits=(0.0, critical.searched_to))
    subject = of_motion(critical.motion, f"critical hub rate with one more mass, {critical.model}")
    return Figure(title, subject, (panel,))


def poles(linear: StateSpace, title: str = "") -> Figure:
    """Describe the poles of a linear model, of a pair that oscillates one: frequency over growth."""
    values = np.sort(linear.eigenvalue[linear.eigenvalue.imag >= 0])  # by growth
    grows = values.real > ROUNDING * np.abs(values).max(initial=0.0)
    lines = tuple(
        Line(group.real, group.imag / (2 * np.pi), label, colour=colour, marks="dots")
        for label, colour, group in (("decays or stays", 0, values[~grows]), ("grows", REFERENCE, values[grows]))
        if group.size
    )
    marks = (Mark(0.0, "neither grows nor decays"),) if lines else ()
    panel = Panel("frequency, Hz", lines, x="growth, 1/s", marks=marks, height=2.0)
    sampled = f", sampled every {linear.step:.4g} s" if linear.step else ""
    subject = f"poles about the equilibrium at {linear.time:.4g} s, {linear.model}{sampled}"
    return Figure(title, of_motion(linear.motion, subject), (panel,))
