"""One steady state: where the beam rests, the shapes of its modes, the Campbell diagram, critical speeds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gbeam.figures.bodies import error_notes, load_panels_along
from gbeam.figures.description import (
    FLIGHT,
    GREY,
    REFERENCE,
    ROUNDING,
    SMALL,
    Bars,
    Dash,
    Figure,
    Line,
    Mark,
    Marks,
    Panel,
    Span,
    error_note,
    imitation_look,
    moving_axes,
    not_drawn,
    of_motion,
    readable_scale,
    scale_of,
    support_lines,
    support_note,
    words_and_unit,
)
from gbeam.results.equilibrium import BRANCH_POINT, BodyRest, Critical, CriticalMap, EquilibriumPath, Rest
from gbeam.results.errors import direction_words
from gbeam.results.modal import Campbell, Modes, near_multiples
from gbeam.results.result import Floats
from gbeam.results.state_space import StateSpace

_DASHES: dict[str, Dash] = {"x": "dotted", "y": "solid", "z": "dashed", "twist": "dotted"}
SHOWN = 6  # shapes drawn


def _marks(stations: Floats) -> Marks:
    """Dots where there are too few places for a line."""
    return "joined" if len(stations) < 3 else ""


def static(rests: Sequence[Rest], title: str = "") -> Figure:
    """Describe where a system rests in some motions.

    Each body that deforms along its length has a panel for every direction in which it moves. A system of several
    bodies also has the displacements of its points.
    """
    first = rests[0]
    bending = [name for name, body in first.bodies.items() if body.bends]
    looks = [FLIGHT, *(imitation_look(k) for k in range(len(rests) - 1))] if len(rests) > 1 else [imitation_look(0)]
    panels, notes = list[Panel](), list[str]()
    for name in bending:
        bodies = [rest.bodies[name] for rest in rests]
        moved = [_deflection(body) for body in bodies]
        axes = moving_axes(*(shape for _, shape in moved))
        notes += not_drawn(axes, *(shape for _, shape in moved))
        x_scale, x_unit = scale_of("m", *(points for points, _ in moved))
        for i in axes:
            scale, unit = scale_of(words_and_unit(BodyRest, "displacement")[1], *(shape[:, i] for _, shape in moved))
            lines = tuple(
                Line(x_scale * points, scale * shape[:, i], rest.motion, marks=_marks(points), **look)
                for rest, (points, shape), look in zip(rests, moved, looks, strict=True)
            )
            lines += support_lines(first.bodies[name].supports, x_scale, "xyz"[i])
            quantity = f"{name} {'xyz'[i]}" if len(bending) > 1 else "xyz"[i]
            x = f"position from the root, {x_unit}"
            legend = len(rests) > 1 and not panels
            panels.append(Panel(f"{quantity}, {unit}", lines, x=x, zero=True, named=legend))
    several = len(first.bodies) > 1
    notes += [note for name, body in first.bodies.items() for note in support_note(body.supports, name * several)]
    relative = "displacement at rest relative to the base" if bending else "displacement at rest"
    for rest in rests:
        if rest.several or not bending:
            panels.append(_points_at_rest(rest, rest.motion if len(rests) > 1 else ""))
    errors = [rest.errors.displacement.total for rest in rests]
    error = {"": max((total for total in errors if math.isfinite(total)), default=math.nan)}
    subject = ", ".join((relative, *_models(first), f"t = {first.time:.4g} s"))
    return Figure(title, subject, tuple(panels), (*notes, *error_note(error)))


def _deflection(body: BodyRest) -> tuple[Floats, Floats]:
    """Positions along a body, (p,) m, and the displacement there, (p, 3) m: of its outline where that has more."""
    if body.outline is not None and len(body.outline.points) > len(body.stations):
        return body.outline.points, body.outline.displacement[0]
    return body.stations, body.displacement


def _points_at_rest(rest: Rest, title: str) -> Panel:
    """Panel of the displacement of all points."""
    scale, unit = scale_of("m", rest.point_displacement)
    values = {axis: scale * rest.point_displacement[:, i] for i, axis in enumerate("xyz")}
    return Panel("", title=title, x=f"displacement from the start, {unit}", bars=Bars(rest.points, values), height=2.0)


def _models(result: Rest | Modes) -> list[str]:
    """Kinds of the models of the bodies that deform, each once."""
    return [*dict.fromkeys(body.model for body in result.bodies.values())]


def loads_at_rest(rest: Rest, body: str, title: str = "") -> Figure:
    """Describe, along a body at rest, the sections' force and moment and the largest and smallest stress."""
    carried = rest.bodies[body].loads
    assert carried is not None
    owner = f" of {body}" if len(rest.bodies) > 1 else ""
    subject = of_motion(rest.motion, f"internal loads at rest{owner}, {rest.bodies[body].model}, t = {rest.time:.4g} s")
    supports = rest.bodies[body].supports
    notes = *support_note(supports), *error_notes(rest, body, carried)
    return Figure(title, subject, load_panels_along(carried, supports), notes)


def modes(result: Modes, title: str = "") -> Figure:
    """Describe the lowest modes: each along the bodies that deform, in the direction in which it moves most.

    Of several bodies also their shares in the kinetic energy are drawn.
    """
    panels = [_shapes(result, name) for name in result.bodies]
    if len(result.body_names) > 1 or not panels:
        names = tuple(f"{k + 1}: {frequency:.4g} Hz" for k, frequency in enumerate(result.frequency))
        bars = Bars(names, {body: result.share[:, k] for k, body in enumerate(result.body_names)})
        panels.append(Panel("", x="share of the bodies in the kinetic energy", bars=bars, height=2.0))
    subject = ", ".join((f"modes about the equilibrium at {result.time:.4g} s", *_models(result)))
    errors = {"": math.nan if result.errors is None else result.errors.largest}
    several = len(result.bodies) > 1
    notes = [note for name, body in result.bodies.items() for note in support_note(body.supports, name * several)]
    return Figure(title, of_motion(result.motion, subject), tuple(panels), (*notes, *error_note(errors)))


def _shapes(result: Modes, name: str) -> Panel:
    """Panel of the lowest modes along one body. A complex mode has a second line, a quarter of a period later."""
    body = result.bodies[name]
    lines = []
    x_scale, x_unit = 1.0, "m"
    moving_modes = [k for k, direction in enumerate(body.direction) if direction]
    for k in moving_modes[:SHOWN]:
        points, moved = body.moved(k)
        x_scale, x_unit = scale_of("m", points)
        label = f"{result.frequency[k]:.4g} Hz, {body.direction[k]}"
        real = Line(x_scale * points, moved.real, label, colour=k % SHOWN, marks=_marks(points))
        lines.append(real)
        if np.abs(moved.imag).max() > SMALL:
            lines.append(replace(real, y=moved.imag, label=f"{label}, a quarter later", dash="dotted", marks=""))
    words = f"{name if len(result.bodies) > 1 else 'displacement'}, largest component 1"
    lines += support_lines(body.supports, x_scale)
    return Panel(words, tuple(lines), x=f"position from the root, {x_unit}", height=2.0)


def campbell(diagram: Campbell, title: str = "", unit: tuple[float, str] = (1.0, "rad/s")) -> Figure:
    """Describe a Campbell diagram: frequencies over the speed, its multiples, crossings and the critical speed.

    `unit` is that of the speed: how many of it are 1 rad/s, and its name.
    """
    drawn = near_multiples(diagram.frequency.T, diagram.speed, diagram.orders)
    omitted = len(diagram.direction) - len(drawn)
    factor, name = unit
    speed = factor * diagram.speed
    top = 1.05 * float(np.nanmax(diagram.frequency[:, drawn]))
    lines, texts = [], []
    for order in diagram.orders:
        multiple = order * diagram.speed / (2 * np.pi)
        lines.append(Line(speed, np.where(multiple <= top, multiple, np.nan), f"_{order}P", colour=GREY))
        # Where the line leaves the panel, and a little before.
        end = min(1.0, top / multiple[-1]) * 0.96 if multiple[-1] > 0 else 0.0
        if end * diagram.speed[-1] > diagram.speed[0]:
            texts.append((end * speed[-1], end * multiple[-1], f"{order}P"))
    for k in drawn:
        direction = diagram.direction[k]
        dash = _DASHES[direction.rpartition(" ")[2]]  # of a system it has the body's name before
        lines.append(Line(speed, diagram.frequency[:, k], f"mode {k + 1}, {direction}", colour=k % 6, dash=dash))
    if diagram.crossings:
        points = sorted((factor * crossing.speed, crossing.frequency) for crossing in diagram.crossings)
        speeds, frequency = np.array(points).T
        lines.append(Line(speeds, frequency, "crossings", colour=REFERENCE, marks="rings"))
    marks: tuple[Mark, ...] = ()
    if diagram.critical is not None and diagram.critical.value is not None:
        marks = (Mark(factor * diagram.critical.value, diagram.critical.kind),)
    words, unit_name = words_and_unit(Campbell, "frequency")
    rate = "rate" if diagram.model == "system" else words_and_unit(Campbell, "speed")[0]
    x_label = f"{rate}, {name}"
    spans = tuple((factor * stretch.start, factor * stretch.end, "not stable") for stretch in diagram.unstable)
    panel = Panel(
        f"{words}, {unit_name}", tuple(lines), x=x_label, marks=marks, texts=tuple(texts), limits=(0.0, top),
        height=2.4, spans=spans,
    )  # fmt: skip
    frame_words = ", in the turning frame" if diagram.frame == "turning" else ""
    subject = of_motion(diagram.motion, f"frequencies about the equilibrium{frame_words}, {diagram.model}")
    subject += f"; {omitted} higher mode{'s' if omitted > 1 else ''} not drawn" if omitted else ""
    errors = {"": math.nan if diagram.errors is None else diagram.errors.largest}
    return Figure(title, subject, (panel,), error_note(errors))


def critical(result: Critical, title: str = "") -> Figure:
    """Describe the lowest frequencies on the way to a critical value, and the value's error to both sides."""
    end = float(result.followed[-1])
    factor, quantity = readable_scale(result.quantity, result.unit if "/" in result.unit else "", np.array([end]))
    finite = [k for k in range(result.frequency.shape[1]) if np.isfinite(result.frequency[:, k]).any()]
    # Frequencies that stay far above the lowest two are left out.
    highest = 3 * float(np.nanmax(result.frequency[:, finite[:2]], initial=0.0))
    drawn = [k for k in finite if np.nanmin(result.frequency[:, k]) <= highest]
    dots: Marks = "dots" if len(result.followed) == 1 else ""
    lines = []
    for k in drawn:
        label = f"frequency {k + 1}"
        lines.append(Line(factor * result.followed, result.frequency[:, k], label, colour=k, marks=dots))
    marks: tuple[Mark, ...] = ()
    spans: tuple[Span, ...] = ()
    error = result.errors.total  # not finite where the exact model loses nothing, or it is not known
    if result.value is not None:
        direction = f" {direction_words(result.direction)}" if result.direction else ""
        marks = (Mark(factor * result.value, f"{result.kind}{direction}"),)
        if 0.0 < error < math.inf:
            value = factor * result.value
            spans = (((1 - min(error, 1.0)) * value, (1 + error) * value, "estimated error"),)
    frame = " in the turning frame" if result.frame == "turning" else ""
    panel = Panel(f"frequency{frame}, Hz", tuple(lines), x=quantity, marks=marks, spans=spans, zero=True, height=2.0)
    return Figure(title, of_motion(result.motion, result.reason), (panel,), error_note({"": error}))


def path(result: EquilibriumPath, title: str = "") -> Figure:
    """Describe the factor over the displacement that is largest: dashed where it would not stay."""
    point, axis = result.most_moved
    moved = result.displacement[:, point, axis]
    scale, unit = scale_of("m", moved)
    way = 1.0 if moved[np.abs(moved).argmax()] > 0 else -1.0  # to which it moves, to the right
    scale *= way
    above = 0.03 * float(np.ptp(result.factor))
    # Where stability changes, at a critical point, both lines meet.
    kept = result.stable | np.append(False, result.stable[:-1]) | np.append(result.stable[1:], False)
    lines = [
        Line(scale * moved, np.where(kept, result.factor, np.nan), "stable", colour=0),
        Line(scale * moved, np.where(result.stable, np.nan, result.factor), "not stable", colour=0, dash="dashed"),
    ]
    texts = []
    for kind in dict.fromkeys(critical.kind for critical in result.critical):
        alike = [critical for critical in result.critical if critical.kind == kind]
        x = scale * np.array([critical.displacement[point, axis] for critical in alike])
        y = np.array([critical.factor for critical in alike])
        lines.append(Line(x, y, f"{kind}s", colour=REFERENCE if kind == BRANCH_POINT else 1, marks="rings"))
        texts += [(float(at), float(factor) + above, f"{factor:.4g}") for at, factor in zip(x, y, strict=True)]
    quantity = f"displacement of {result.points[point]} along {'−' if way < 0 else ''}{'xyz'[axis]}, {unit}"
    panel = Panel(
        f"factor of the {result.quantity}", tuple(lines), x=quantity, zero=True, height=2.4, texts=tuple(texts)
    )
    subject = of_motion(
        result.motion, f"equilibria under growing {result.quantity}, {result.model}, t = {result.time:.4g} s"
    )
    return Figure(title, subject, (panel,), error_note({"": result.errors.total}))


def critical_map(critical: CriticalMap, title: str = "") -> Figure:
    """Describe a map of critical speeds with one line per mass (2009 Fig. 9 shows the stiffness at one
    speed instead).
    """
    x_scale, x_unit = scale_of("m", critical.position)
    lines = tuple(
        Line(x_scale * critical.position, speed, f"{mass:g} kg", colour=k % 6, marks="joined")
        for k, (mass, speed) in enumerate(zip(critical.mass, critical.speed, strict=True))
    )
    panel = Panel("hub rate, rad/s", lines, x=f"position of the mass from the root, {x_unit}", zero=True, height=2.0)
    if np.isnan(critical.speed).all():
        remark = f"no loss of equilibrium up to {critical.searched_to:.4g} rad/s"
        middle = x_scale * float(np.mean(critical.position)), critical.searched_to / 2
        panel = replace(panel, texts=((*middle, remark),), limits=(0.0, critical.searched_to))
    subject = of_motion(critical.motion, f"critical hub rate with one more mass, {critical.model}")
    return Figure(title, subject, (panel,))


def poles(linear: StateSpace, title: str = "") -> Figure:
    """Describe the poles of a linear model, frequency over growth; of a pair that oscillates only one is drawn."""
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
