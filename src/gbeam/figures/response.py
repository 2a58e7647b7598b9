"""A response as a whole: its tips, points and coordinates, the motion of its base, its controllers and energy."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.constants import RPM
from gbeam.figures.description import (
    FLIGHT,
    REFERENCE,
    ROUNDING,
    Dash,
    Figure,
    Line,
    Marks,
    Panel,
    Span,
    components,
    ends_of,
    error_note,
    imitation_look,
    largest_size,
    moving_axes,
    not_drawn,
    of_motion,
    scale_of,
    stretches,
    support_names,
    words_and_unit,
)
from gbeam.printable import MOST_TURNS, raised
from gbeam.results.body_response import BodyResponse
from gbeam.results.comparison import Comparison
from gbeam.results.parts import Base
from gbeam.results.response import HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.sensors import Readings
from gbeam.results.study import ModelStudy, Study
from gbeam.results.system import ENERGIES, Invariants, Loop

Coordinates = Mapping[str, tuple[Floats, str, Floats]]  # of joints: history, unit and effort by name
Size = tuple[str, str, Callable[[BodyResponse, Any], Floats]]  # words, unit and history of a body's loads
COLOURS = 6
DASHES: tuple[Dash, ...] = ("solid", "dashed", "dotted")


def looks(study: Study) -> dict[str, dict[str, Any]]:
    """Styles of the lines of every environment: broad of a flight that another imitates."""
    flights = {comparison.flight for comparison in study.comparisons}
    other_names = [name for name in study.responses if name not in flights]
    coloured: dict[str, dict[str, Any]] = {name: {"colour": k % 6} for k, name in enumerate(other_names)}
    compared = {name: imitation_look(k) for k, name in enumerate(other_names)} if flights else coloured
    return {name: compared.get(name, FLIGHT) for name in study.responses}


def bodies(study: Study) -> tuple[str, ...]:
    """Names of the bodies of a study's responses."""
    return tuple(dict.fromkeys(name for run in study.responses.values() for name in run.bodies))


def at_tip(compared: Comparison, body: str) -> bool:
    """True if a comparison is of the tip of a body."""
    owner, _, point = (compared.point or "tip").rpartition(".")
    return point == "tip" and owner in ("", body)


def tip(study: Study, body: str) -> Figure:
    """Describe the displacement of a body's tip along every axis in which it moves, and its difference
    in comparisons.
    """
    responses = {name: run for name, run in study.responses.items() if body in run.bodies}
    motions = {name: run.bodies[body] for name, run in responses.items()}
    comparisons = [comparison for comparison in study.comparisons if at_tip(comparison, body)]
    sizes = [motion.peaks.max_abs for motion in motions.values()]
    axes = sorted(moving_axes(*sizes), key=lambda axis: -max(size[axis] for size in sizes))
    spans = [_spans(responses, comparison) for comparison in comparisons]
    shaded = spans[0] if len(comparisons) == 1 else ()
    if not comparisons and len(responses) == 1:
        (run,) = responses.values()
        shaded = tuple(stretches(run.axes, run.time))
    panels = []
    for axis in axes:
        panel = _displacement(study, motions, axis, named=len(responses) > 1 and axis == axes[0])
        panels.append(replace(panel, spans=shaded, height=1.6 if len(axes) == 1 else 1.2))
        panels += [_difference(study, pair, axis, span) for pair, span in zip(comparisons, spans, strict=True)]
    if len(panels) == 1:
        panels[0] = replace(panels[0], height=2.0)
    errors = {name if len(responses) > 1 else "": _error(run, body) for name, run in responses.items()}
    notes = (*not_drawn(axes, *sizes), *error_note(errors))
    outcomes = tuple(run.outcome for run in responses.values())
    origin = f"of {body} relative to its root" if len(bodies(study)) > 1 else "relative to the base"
    return Figure(study.title, f"tip displacement {origin}", tuple(panels), notes, outcomes)


def _error(response: Response, body: str) -> float:
    """Estimated error of the displacement of a body, of its largest."""
    if len(response.bodies) == 1:
        return response.error_estimate
    errors = response.errors
    return dict(zip(errors.beams, errors.displacement_by_beam.tolist(), strict=False)).get(body, math.nan)


def models(study: ModelStudy, title: str = "") -> Figure:
    """Describe the tip's displacement by every model, in every motion. The line of the reference model is broad."""
    panels = []
    for name, axis in study.direction.items():
        rows = [row for row in study.rows if row.motion == name and len(row.time)]
        scale, unit = scale_of("m", *(row.history for row in rows))
        lines = []
        for k, row in enumerate(rows):
            look = FLIGHT if row.model == study.reference else imitation_look(k)
            lines.append(Line(row.time, scale * row.history, row.model, **look))
        heading = name if len(study.direction) > 1 else ""
        panels.append(Panel(f"{axis}, {unit}", tuple(lines), heading, zero=True, height=1.6))
    subject = f"tip displacement by every model, {study.reference} broad"
    return Figure(title or study.title, subject, tuple(panels), outcomes=(study.outcome,))


def _displacement(study: Study, motions: Mapping[str, BodyResponse], axis: int, *, named: bool) -> Panel:
    """Panel of a tip's displacement along an axis, with a line for every motion."""
    scale, unit = scale_of("m", *(body.tip[:, axis] for body in motions.values()))
    lines = []
    for name, body in motions.items():
        time = study.responses[name].time
        marks: Marks = "joined" if len(time) == 1 else ""  # a run that diverged at once is no line
        lines.append(Line(time, scale * body.tip[:, axis], name, marks=marks, **looks(study)[name]))
    return Panel(f"{'xyz'[axis]}, {unit}", tuple(lines), zero=True, named=named)


def _difference(study: Study, compared: Comparison, axis: int, spans: tuple[Span, ...]) -> Panel:
    """Panel of the difference from the flight along an axis, scaled to the times at which the target is its load."""
    difference, is_counted = compared.difference[:, axis], compared.covered
    counted = difference[is_counted] if is_counted.any() else difference
    scale, unit = scale_of("m", counted)
    # A difference from flight while the target is another load must not set the scale.
    limits = ends_of(is_counted, scale * difference)
    exceeds = limits is not None and largest_size(difference) > 1.05 * largest_size(counted)
    title = f"{compared.centrifuge} − {compared.flight}" + (", scaled to the times compared" if exceeds else "")
    line = Line(compared.time, scale * difference, title, **looks(study).get(compared.centrifuge, imitation_look(0)))
    label = f"difference in {'xyz'[axis]}, {unit}"
    return Panel(label, (line,), title, spans=spans, limits=limits, zero=limits is None, named=False, height=0.9)


def _spans(responses: Mapping[str, Response], compared: Comparison) -> tuple[Span, ...]:
    response = responses.get(compared.centrifuge)
    if response is None:
        return stretches(None, compared.time, compared.accounting)
    return stretches(response.axes, response.time, compared.accounting)


def sizes(study: Study, body: str) -> Figure:
    """Describe the sizes of stress and of force and moment of a body's root and supports, in all motions together."""
    loaded = {name: run for name, run in study.responses.items() if run.bodies[body].loads is not None}
    kinds: list[Size] = [
        ("largest stress", "Pa", _largest_stress),
        ("root force", "N", lambda _, loads: np.linalg.norm(loads.section_force[:, 0], axis=1)),
        ("root moment", "N m", lambda _, loads: np.linalg.norm(loads.section_moment[:, 0], axis=1)),
    ]
    kinds += _on_supports([run.bodies[body].loads for run in loaded.values()])
    panels: list[Panel] = []
    for words, si, size in kinds:
        histories = {}
        for name, run in loaded.items():
            history = size(run.bodies[body], run.bodies[body].loads)
            if np.isfinite(history).any():
                histories[name] = run.time, history
        scale, unit = scale_of(si, *(history for _, history in histories.values()))
        look = looks(study)
        lines = tuple(Line(time, scale * history, name, **look[name]) for name, (time, history) in histories.items())
        if lines:
            panels.append(Panel(f"{words}, {unit}", lines, zero=True, named=not panels))
    stress = " and largest stress anywhere" if len(panels) == len(kinds) else ""
    support_words = " and the supports" if any(words.startswith("support") for words, *_ in kinds) else ""
    of_body = f" of {body}" if len(bodies(study)) > 1 else ""
    return Figure(study.title, f"sizes of the loads at the root{support_words}{of_body}{stress}", tuple(panels))


def _on_supports(loads: Sequence[Any]) -> list[Size]:
    """Sizes of force and moment of every support of one body, in runs of it, that are not zero in all of them."""
    if not loads or loads[0].supports is None:
        return []
    sizes = list[Size]()
    for k, place in enumerate(support_names(loads[0])):
        for kind, si in (("force", "N"), ("moment", "N m")):
            if any(getattr(carried, f"support_{kind}")[:, k].any() for carried in loads):
                sizes.append((f"support {kind} at {place}", si, partial(_on_support, k, kind)))
    return sizes


def _on_support(k: int, kind: str, _: BodyResponse, loads: Any) -> Floats:
    """Size of the force or the moment of a support over time, (t,)."""
    return np.asarray(np.linalg.norm(getattr(loads, f"support_{kind}")[:, k], axis=1))


def _largest_stress(body: BodyResponse, loads: Any) -> Floats:
    """Largest stress over time (t,), Pa: von Mises of a mesh, or of the extreme fibres of a beam."""
    return np.asarray(loads.stress.max(axis=1) if body.solid is None else body.solid.von_mises)


def points(response: Response, title: str = "") -> Figure:
    """Describe the displacement of every point from its place at the start, along the axes of the ground."""
    moved = response.place - response.place[0]
    scale, unit = scale_of("m", moved)
    axes = moving_axes(moved)
    panels = []
    for axis in axes:
        lines = []
        for n, k in enumerate(_moving_points(moved)):
            look: dict[str, Any] = {"colour": n % COLOURS, "dash": DASHES[n // COLOURS % len(DASHES)]}
            lines.append(Line(response.time, scale * moved[:, k, axis], response.points[k], **look))
        panels.append(Panel(f"{'xyz'[axis]}, {unit}", tuple(lines), zero=True, named=axis == axes[0]))
    subject = of_motion(response.name, "displacement of the points from the start, axes of the ground")
    notes = (*not_drawn(axes, moved), *error_note({"": response.errors.place.total}))
    return Figure(title, subject, tuple(panels), notes, (response.outcome,))


def _moving_points(moved: np.ndarray) -> list[int]:
    """Indices of the points that move. Of points that move alike only the first is listed."""
    size = np.abs(moved).max(initial=0.0)
    chosen: list[int] = []
    for k in range(moved.shape[1]):
        distances = [np.abs(moved[:, k] - moved[:, chosen_point]).max(initial=0.0) for chosen_point in chosen]
        if np.abs(moved[:, k]).max(initial=0.0) > ROUNDING * size and min(distances, default=np.inf) > ROUNDING * size:
            chosen.append(k)
    return chosen


def coordinates(response: Response, histories: Coordinates, title: str = "") -> Figure:
    """Describe the coordinates of joints, each with its unit, and the efforts of their drives."""
    panels = []
    size = max((np.abs(history).max(initial=0.0) for history, *_ in histories.values()), default=0.0)
    for name, (history, unit, effort) in histories.items():
        if 0 < np.abs(history).max(initial=0.0) <= ROUNDING * size:  # rounding
            continue
        panels.append(Panel(f"{name}, {unit}", (Line(response.time, history),)))
        if np.any(effort):
            scale, unit = scale_of("N" if unit == "m" else "N m", effort)
            panels.append(Panel(f"drive, {unit}", (Line(response.time, scale * effort),), zero=True))
    subject = of_motion(response.name, "coordinates of the joints")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def loop(response: Response, control: Loop, title: str = "") -> Figure:
    """Describe the measurements of controllers, and their commands as asked for and as applied."""
    panels = [
        Panel(f"{name.rpartition(': ')[2]}, {raised(unit)}", (Line(response.time, control.measured[:, k]),))
        for k, (name, unit) in enumerate(zip(control.measurements, control.units, strict=True))
    ]
    for k, (name, unit) in enumerate(zip(control.drives, control.drive_units, strict=True)):
        asked, applied = control.asked[:, k], control.applied[:, k]
        scale, unit = scale_of(unit, asked, applied)
        lines = (
            Line(response.time, scale * asked, "asked for", colour=REFERENCE, dash="dashed"),
            Line(response.time, scale * applied, "applied"),
        )
        panels.append(Panel(f"{name}, {unit}", lines, zero=True))
    return Figure(title, of_motion(response.name, "controllers"), tuple(panels), outcomes=(response.outcome,))


def base(response: Response, motion: Base, title: str = "") -> Figure:
    """Describe the motion of the base."""
    panels = []
    spans = stretches(response.axes, response.time)
    is_turning = bool(np.any(motion.w_WB_B) or np.any(motion.alpha_WB_B))
    for name in ("a_WO_B", "w_WB_B", "alpha_WB_B") if is_turning else ("a_WO_B",):
        values = getattr(motion, name)
        words, si = words_and_unit(Base, name)
        scale, unit = scale_of(si, values) if name == "a_WO_B" else (1.0, raised(si))
        panel = Panel(f"{words}, {unit}", spans=spans, height=1.0 if is_turning else 1.6)
        panels.append(components(response.time, scale * values, "xyz", panel))
    subject = of_motion(response.name, "motion of the base, base axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def sensors(response: Response, readings: Readings, title: str = "") -> Figure:
    """Describe what accelerometers read, a panel for each."""
    scale, unit = scale_of(words_and_unit(Readings, "acceleration")[1], readings.acceleration)
    panels = [
        components(response.time, scale * readings.acceleration[:, k], "xyz", Panel(f"{point}, {unit}", height=1.2))
        for k, point in enumerate(readings.points)
    ]
    subject = of_motion(response.name, "readings of the accelerometers, along their axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def hub(response: Response, motion: HubResult, title: str = "") -> Figure:
    """Describe the turning of a hub or an arm about z: its angle, its rate and, if known, the torque of its drive."""
    turns = np.abs(motion.angle).max(initial=0.0) / (2 * math.pi)
    unit, angle = ("turns", motion.angle / (2 * math.pi)) if turns > MOST_TURNS else ("deg", np.degrees(motion.angle))
    histories = [(f"angle, {unit}", angle), ("rate, rpm", motion.rate / RPM)]
    if motion.drive_torque is not None:
        scale, unit = scale_of("N m", motion.drive_torque)
        histories.append((f"drive torque, {unit}", scale * motion.drive_torque))
    panels = tuple(Panel(label, (Line(response.time, values),)) for label, values in histories)
    subject = of_motion(response.name, f"the {response.environment}, about z")
    return Figure(title, subject, panels, outcomes=(response.outcome,))


def energy(response: Response, invariants: Invariants, title: str = "") -> Figure:
    """Describe kinetic and elastic energy, that of gravity, and their sum."""
    parts = invariants.energy
    lines = [Line(response.time, parts[:, k], name, colour=k) for k, name in enumerate(ENERGIES)]
    lines.append(Line(response.time, parts.sum(axis=1), "whole", colour=len(ENERGIES), dash="dashed"))
    panel = Panel("energy, J", tuple(lines))
    return Figure(title, of_motion(response.name, "energy"), (panel,), outcomes=(response.outcome,))
