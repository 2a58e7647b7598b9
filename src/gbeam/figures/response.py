"""A response: its tip, what its sections carry, the motion of its base, and the machine or the hub that moves it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    REFERENCE,
    ROUNDING,
    Figure,
    Level,
    Line,
    Panel,
    Span,
    components,
    declared,
    ends_of,
    estimated,
    imitating,
    largest,
    limit_levels,
    moving,
    not_drawn,
    of_motion,
    scale_of,
    stretches,
)
from gbeam.printable import raised
from gbeam.results.comparison import Comparison
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Base, Loads
from gbeam.results.response import HubResult, PlotHeading, Response
from gbeam.results.result import Floats
from gbeam.results.sensors import Readings
from gbeam.results.study import ModelStudy, Study

Names = tuple[tuple[str, ...], tuple[str, ...]]
AXES = ("axis 1, the arm", "axis 2, yaw", "axis 3, roll")
FORCES = ("axial N", "shear V_y", "shear V_z")
MOMENTS = ("torque", "bending M_y", "bending M_z")
SECTION, BASE = (FORCES, MOMENTS), (tuple("xyz"),) * 2  # names of components


def looks(study: Study) -> dict[str, dict[str, Any]]:
    """Styles of the lines of every environment: broad of a flight that another imitates."""
    flights = {each.flight for each in study.comparisons}
    others = [name for name in study.responses if name not in flights]
    plain: dict[str, dict[str, Any]] = {name: {"colour": k % 6} for k, name in enumerate(others)}
    compared = {name: imitating(k) for k, name in enumerate(others)} if flights else plain
    return {name: compared.get(name, FLIGHT) for name in study.responses}


def alone(study: Study) -> dict[str, Response]:
    """Responses of a study that are of one body, by the motion's name."""
    return {name: each for name, each in study.responses.items() if isinstance(each, Response)}


def tip(study: Study) -> Figure:
    """Describe the tip's displacement along every axis in which it moves."""
    responses, compared = alone(study), study.comparisons
    sizes = [each.peaks.max_abs for each in responses.values()]
    axes = sorted(moving(*sizes), key=lambda axis: -max(each[axis] for each in sizes))
    spans = [_spans(responses, each) for each in compared]
    shaded = spans[0] if len(compared) == 1 else ()
    if not compared and len(responses) == 1:
        shaded = tuple(span for each in responses.values() for span in stretches(each.axes, each.time))
    panels = []
    for axis in axes:
        panel = _displacement(study, axis, named=len(responses) > 1 and axis == axes[0])
        panels.append(replace(panel, spans=shaded, height=1.6 if len(axes) == 1 else 1.2))
        panels += [_difference(study, each, axis, span) for each, span in zip(compared, spans, strict=True)]
    if len(panels) == 1:
        panels[0] = replace(panels[0], height=2.0)
    errors = {name if len(responses) > 1 else "": each.error_estimate for name, each in responses.items()}
    notes = (*not_drawn(axes, *sizes), *estimated(errors))
    outcomes = tuple(each.outcome for each in responses.values())
    return Figure(study.title, "tip displacement relative to the base", tuple(panels), notes, outcomes)


def models(study: ModelStudy, title: str = "") -> Figure:
    """Describe the tip's displacement by every model, in every motion; the one compared with is broad."""
    panels = []
    for name, axis in study.direction.items():
        rows = [row for row in study.rows if row.motion == name and len(row.time)]
        scale, unit = scale_of("m", *(row.history for row in rows))
        looks = [FLIGHT if row.model == study.reference else imitating(k) for k, row in enumerate(rows)]
        lines = [Line(row.time, scale * row.history, row.model, **look) for row, look in zip(rows, looks, strict=True)]
        heading = name if len(study.direction) > 1 else ""
        panels.append(Panel(f"{axis}, {unit}", tuple(lines), heading, zero=True, height=1.6))
    subject = f"tip displacement by every model, {study.reference} broad"
    return Figure(title or study.title, subject, tuple(panels), outcomes=(study.outcome,))


def _displacement(study: Study, axis: int, *, named: bool) -> Panel:
    """Panel of the tip's displacement along an axis, a line for every environment."""
    scale, unit = scale_of("m", *(each.tip[:, axis] for each in alone(study).values()))
    lines = [
        # A run that diverged at once is no line.
        Line(
            each.time,
            scale * each.tip[:, axis],
            name,
            marks="joined" if len(each.time) == 1 else "",
            **looks(study)[name],
        )
        for name, each in alone(study).items()
    ]
    return Panel(f"{'xyz'[axis]}, {unit}", tuple(lines), zero=True, named=named)


def _difference(study: Study, compared: Comparison, axis: int, spans: tuple[Span, ...]) -> Panel:
    """Panel of the difference from flight along an axis, scaled to the times at which the target was not held."""
    difference, covered = compared.difference[:, axis], compared.covered
    counted = difference[covered] if covered.any() else difference
    scale, unit = scale_of("m", counted)
    # A difference from flight while the target is held must not set the scale.
    limits = ends_of(covered, scale * difference)
    beyond = limits is not None and largest(difference) > 1.05 * largest(counted)
    title = f"{compared.centrifuge} − {compared.flight}" + (", scaled to the times compared" if beyond else "")
    line = Line(compared.time, scale * difference, title, **looks(study).get(compared.centrifuge, imitating(0)))
    label = f"difference in {'xyz'[axis]}, {unit}"
    return Panel(label, (line,), title, spans=spans, limits=limits, zero=limits is None, named=False, height=0.9)


def _spans(responses: Mapping[str, Response], compared: Comparison) -> tuple[Span, ...]:
    response = responses.get(compared.centrifuge)
    if response is None:
        return stretches(None, compared.time, compared.accounting)
    return stretches(response.axes, response.time, compared.accounting)


def sizes(study: Study) -> Figure:
    """Describe the sizes of stress, root force and root moment of all environments together."""
    loaded = {name: each for name, each in alone(study).items() if each.loads is not None}
    kinds: tuple[tuple[str, str, Callable[[Response, Any], Floats]], ...] = (
        ("largest stress", "Pa", lambda of, its: its.stress.max(axis=1) if of.solid is None else of.solid.von_mises),
        ("root force", "N", lambda _, loads: np.linalg.norm(loads.section_force[:, 0], axis=1)),
        ("root moment", "N m", lambda _, loads: np.linalg.norm(loads.section_moment[:, 0], axis=1)),
    )
    panels: list[Panel] = []
    for words, si, size in kinds:
        values = {name: (each.time, size(each, each.loads)) for name, each in loaded.items()}
        known = {name: each for name, each in values.items() if np.isfinite(each[1]).any()}
        scale, unit = scale_of(si, *(each for _, each in known.values()))
        look = looks(study)
        lines = tuple(Line(time, scale * each, name, **look[name]) for name, (time, each) in known.items())
        if lines:
            panels.append(Panel(f"{words}, {unit}", lines, zero=True, named=not panels))
    stress = " and largest stress anywhere" if len(panels) == len(kinds) else ""
    return Figure(study.title, f"sizes of the loads at the root{stress}", tuple(panels))


def carried_along(loads: Loads) -> tuple[Panel, ...]:
    """Loads of the sections at one time, along the beam."""
    scale, unit = scale_of("m", loads.stations)
    stress = (loads.stress_tension[0], loads.stress_compression[0])
    panels = _carried(scale * loads.stations, loads.section_force[0], loads.section_moment[0], stress, loads)
    return tuple(replace(each, x=f"position from the root, {unit}") for each in panels)


def loads(response: Response, carried: Loads, title: str = "") -> Figure:
    """Describe over time what the root, or the base of a solid, carries, the extreme stresses, and a hub's torque."""
    beam = response.point_acceleration is None  # which only the loads of a beam have
    panels = [*carried_at_root(response.time, carried, SECTION if beam else BASE)]
    if carried.beam_torque is not None:
        scale, unit = scale_of("N m", carried.beam_torque)
        panels.append(Panel(f"torque from the hub, {unit}", (Line(response.time, scale * carried.beam_torque),)))
    spans = stretches(response.axes, response.time)
    words = (
        "loads in the root's section, and stress anywhere along the beam" if beam else "loads on the base, base axes"
    )
    subject = of_motion(response.name, words)
    shaded = tuple(replace(each, spans=spans) for each in panels)
    return Figure(title, subject, shaded, judged(response.errors, carried), (response.outcome,))


def carried_at_root(time: Floats, carried: Loads, names: Names = SECTION) -> Iterator[Panel]:
    """Loads of the root's section over time, and the extreme stresses along the beam."""
    stress = (carried.stress_tension.max(axis=1), carried.stress_compression.min(axis=1))
    return _carried(time, carried.section_force[:, 0], carried.section_moment[:, 0], stress, carried, names)


def judged(errors: Any, carried: Loads) -> tuple[str, ...]:
    """Notes on the estimated errors of loads and, where it is known, stress."""
    known = bool(np.isfinite(carried.stress).all())
    stress = (errors.stress.total, errors.stress.peak) if known else (math.nan,) * 2
    parts = ("loads", "their peaks", "stress", "its peaks"), (errors.loads.total, errors.loads.peak, *stress)
    return estimated(dict(zip(*parts, strict=True)))


def _carried(
    where: Floats,
    force: Floats,
    moment: Floats,
    stress: tuple[Floats, Floats],
    carried: Loads,
    names: Names = SECTION,
) -> Iterator[Panel]:
    """Panels of forces and moments (k, 3) over `where` (k,) and, if known, of the largest and smallest stress (k,)."""
    lever = largest(force) * float(np.max(carried.stations, initial=0.0))
    moment = np.where(np.abs(moment) <= ROUNDING * lever, 0.0, moment)  # what is no number stays a gap
    for kind, si, values, labels in (("force", "N", force, names[0]), ("moment", "N m", moment, names[1])):
        scale, unit = scale_of(si, values)
        yield components(where, scale * values, labels, Panel(f"{kind}, {unit}", zero=True))
    if np.isfinite(carried.stress).all():
        scale, unit = scale_of("Pa", *stress)
        lines = [Line(where, scale * stress[k], name, colour=k) for k, name in enumerate(("largest", "smallest"))]
        strength = math.inf if carried.yield_strength is None else carried.yield_strength
        levels = limit_levels(scale * strength, scale * np.concatenate(stress), "yield strength")
        yield Panel(f"stress, {unit}", tuple(lines), levels=levels)


def base(response: Response, title: str = "") -> Figure:
    """Describe the motion of the root."""
    motion, panels = response.base, []
    spans = stretches(response.axes, response.time)
    turning = bool(np.any(motion.w_WB_B) or np.any(motion.alpha_WB_B))
    for name in ("a_WO_B", "w_WB_B", "alpha_WB_B") if turning else ("a_WO_B",):
        values = getattr(motion, name)
        words, si = declared(Base, name)
        scale, unit = scale_of(si, values) if name == "a_WO_B" else (1.0, raised(si))
        panel = Panel(f"{words}, {unit}", spans=spans, height=1.0 if turning else 1.6)
        panels.append(components(response.time, scale * values, "xyz", panel))
    subject = of_motion(response.name, "motion of the base, base axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def sensors(response: Response, readings: Readings, title: str = "") -> Figure:
    """Describe what accelerometers read, a panel for each."""
    scale, unit = scale_of(declared(Readings, "acceleration")[1], readings.acceleration)
    panels = [
        components(response.time, scale * readings.acceleration[:, k], "xyz", Panel(f"{point}, {unit}", height=1.2))
        for k, point in enumerate(readings.points)
    ]
    subject = of_motion(response.name, "readings of the accelerometers, along their axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def hub(response: Response, motion: HubResult, title: str = "") -> Figure:
    """Describe the turning of a hub about z."""
    shown = [(f"{field}, {declared(HubResult, field)[1]}", getattr(motion, field)) for field in ("angle", "rate")]
    torque = motion.drive_torque
    if torque is None and response.loads is not None:
        torque = response.loads.drive_torque
    if torque is not None:
        scale, unit = scale_of("N m", torque)
        shown.append((f"drive torque, {unit}", scale * torque))
    panels = tuple(Panel(label, (Line(response.time, values),)) for label, values in shown)
    return Figure(title, of_motion(response.name, "the hub, about z"), panels, outcomes=(response.outcome,))


def axes_of(response: PlotHeading, axes: AxesResult, quantity: str, title: str = "") -> Figure:
    """Describe one quantity of a centrifuge's axes, a panel for each axis, with its limits."""
    history: Floats = getattr(axes, quantity)
    unit = raised(declared(AxesResult, quantity)[1])
    allowed = {use.axis: use.allowed for use in axes.limits if use.quantity == quantity}
    spans, panels = stretches(axes, response.time), []
    for i in range(3):
        limit = allowed.get(f"axis {i + 1}", math.inf)
        levels = limit_levels(limit, history[:, i])
        beyond = ", beyond the panel" if math.isfinite(limit) and not levels else ""
        title_of = f"{AXES[i]}: {_used(history[:, i], limit, unit)}{beyond}"
        lines = (Line(response.time, history[:, i], **imitating(0)),)
        panels.append(Panel(f"{quantity}, {unit}", lines, title_of, levels=levels, spans=spans, zero=True))
    if quantity == "acceleration":
        panels[0] = _with_power(panels[0], axes)
    subject = of_motion(response.name, f"{quantity} of the machine's axes")
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def _with_power(panel: Panel, axes: AxesResult) -> Panel:
    """Add the arm's acceleration that a limit on its power leaves at its rate."""
    (line,) = panel.lines
    rate, size = np.abs(axes.rate[:, 0]), np.abs(line.y)
    most = max([float(size.max()), *(abs(each.value) for each in panel.levels)])
    for use in axes.limits:
        if use.quantity == "power" and math.isfinite(use.allowed) and use.used > 0:
            available = float((rate * size).max()) / use.share / np.maximum(rate, 1e-12)
            bound = np.where(available < 1.3 * most, available, np.nan)
            power = Line(line.x, bound, "limit of the power", colour=REFERENCE, dash="dotted")
            panel = replace(panel, lines=(*panel.lines, power, replace(power, y=-bound, label=f"_{power.label}")))
    return panel


def _used(history: Floats, limit: float, unit: str) -> str:
    """Use of a limit, in words."""
    used = float(np.nanmax(np.abs(history)))
    return f"{_plain(used)} of {_plain(limit)} {unit}" if math.isfinite(limit) else f"up to {_plain(used)} {unit}"


def _plain(value: float) -> str:
    """Three digits, below a million without an exponent."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 1000 <= rounded < 1e6 else f"{rounded:g}"


def tracking(response: PlotHeading, axes: AxesResult, title: str = "") -> Figure:
    """Figure of the load at the control point over time: size and components, target, machine's and flight's."""
    components = moving(axes.actual, axes.reference)  # those that are not negligible
    time = response.time
    scale, unit = scale_of("m/s^2", axes.reference)
    loads: list[tuple[Floats, Floats, str, dict[str, Any]]] = [
        (time, axes.reference, "target", {"colour": REFERENCE, "dash": "dashed"}),
        (time, axes.actual, "machine", imitating(0)),
    ]
    if axes.flight is not None:
        near = 1e-9 * (time[-1] - time[0])
        flown = (time >= axes.span[0] - near) & (time <= axes.span[1] + near)
        loads.insert(0, (time[flown], axes.flight[flown], "flight", FLIGHT))
    size = tuple(Line(times, scale * np.linalg.norm(load, axis=1), name, **look) for times, load, name, look in loads)
    idle = (Level(scale * axes.idle, "idle", "dotted"),) if axes.idle > 0 else ()
    panels = [Panel(f"size, {unit}", size, levels=idle, zero=True)]
    for i in components:
        lines = tuple(Line(times, scale * load[:, i], name, **look) for times, load, name, look in loads)
        panels.append(Panel(f"{'xyz'[i]}, {unit}", lines, named=False, height=0.8))
    panels.append(_error(time, axes, scale, unit))
    spans = stretches(axes, time)
    about = of_motion(response.name, "load at the control point: flight's, the target and the machine's")
    return Figure(title, about, tuple(replace(each, spans=spans) for each in panels), outcomes=(response.outcome,))


def _error(time: Floats, axes: AxesResult, scale: float, unit: str) -> Panel:
    """Panel of the tracking error, in the unit of the loads, scaled to the times that are followed."""
    error, followed = axes.tracking_error, ~axes.not_followed
    ends = ends_of(followed, scale * error)
    # Below a millionth of the load it is rounding, and shown as none.
    top = max(ends[1] if ends else 1.05 * scale * float(error.max()), 1e-6 * scale * largest(axes.reference)) or 1.0
    title = f"size of machine − target{', scaled to the times that are followed' if ends else ''}"
    line = Line(time, scale * error, "machine − target", **imitating(0))
    return Panel(f"tracking error, {unit}", (line,), title, limits=(0.0, top), named=False, height=0.8)
