"""One body of a response: what its sections or its base carry, the stress of a mesh, the loads of a rigid specimen."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    ROUNDING,
    Figure,
    Level,
    Line,
    Panel,
    components,
    error_note,
    largest_size,
    limit_levels,
    of_motion,
    scale_of,
    stretches,
    support_lines,
    support_names,
)
from gbeam.results.equilibrium import Rest
from gbeam.results.parts import Loads, Supports
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.solids import SolidStress, SpecimenLoads, place_words

Names = tuple[tuple[str, ...], tuple[str, ...]]
FORCES = ("axial N", "shear V_y", "shear V_z")
MOMENTS = ("torque", "bending M_y", "bending M_z")
SECTION, BASE = (FORCES, MOMENTS), (tuple("xyz"),) * 2  # names of components
NEAR = 3.0  # times the largest stress: a strength beyond would press the lines to the ground


def loads(response: Response, body: str, title: str = "") -> Figure:
    """Describe over time the loads of a body's root, the extreme stresses, and the torque about a hub's axis."""
    carried = response.bodies[body].loads
    assert carried is not None
    is_beam = response.bodies[body].shapes is not None
    panels = [*carried_at_root(response.time, carried, SECTION if is_beam else BASE)]
    if carried.beam_torque is not None:
        scale, unit = scale_of("N m", carried.beam_torque)
        panels.append(Panel(f"torque about the axis, {unit}", (Line(response.time, scale * carried.beam_torque),)))
    spans = stretches(response.axes, response.time)
    of_body = f" of {body}" if len(response.bodies) > 1 else ""
    section = f"loads in the root's section{of_body}, and stress anywhere along {'it' if of_body else 'the beam'}"
    words = section if is_beam else f"loads on the base{of_body}, base axes"
    shaded = tuple(replace(panel, spans=spans) for panel in panels)
    subject = of_motion(response.name, words)
    return Figure(title, subject, shaded, error_notes(response, body, carried), (response.outcome,))


def supports(response: Response, body: str, title: str = "") -> Figure:
    """Describe over time the force and moment of every support on a body, with the peaks."""
    described = response.bodies[body]
    carried, peaks = described.loads, described.peaks.loads
    assert carried is not None
    panels, notes = list[Panel](), list[str]()
    kinds = (("force", "N", carried.support_force), ("moment", "N m", carried.support_moment))
    for k, name in enumerate(support_names(carried)):
        for kind, si, histories in kinds:
            values = np.zeros((0, 1, 3)) if histories is None else histories
            if largest_size(values[:, k]) <= ROUNDING * largest_size(values):
                continue
            scale, unit = scale_of(si, values)
            place = f"{kind} at {name}"
            panels.append(components(response.time, scale * values[:, k], "xyz", Panel(f"{place}, {unit}", zero=True)))
            if peaks is not None and (largest := getattr(peaks, f"support_{kind}")) is not None:
                size = largest.size
                notes.append(f"{place} up to {scale * size.value[k]:.4g} {unit} at {size.time[k]:.4g} s")
    spans = stretches(response.axes, response.time)
    shaded = tuple(replace(panel, spans=spans) for panel in panels)
    of_body = f" on {body}" if len(response.bodies) > 1 else ""
    subject = of_motion(response.name, f"loads of the supports{of_body}, axes of the root")
    errors = {name: error for name, error in _errors_of(response, body).items() if name in ("loads", "their peaks")}
    return Figure(title, subject, shaded, ("; ".join(notes), *error_note(errors)), (response.outcome,))


def load_panels_along(loads: Loads, supports: Supports | None = None) -> tuple[Panel, ...]:
    """Loads of the sections at one time, along a beam, with its supports."""
    scale, unit = scale_of("m", loads.stations)
    stress = (loads.stress_tension[0], loads.stress_compression[0])
    panels = _load_panels(scale * loads.stations, loads.section_force[0], loads.section_moment[0], stress, loads)
    support_marks, x = support_lines(supports, scale), f"position from the root, {unit}"
    return tuple(replace(panel, x=x, lines=(*panel.lines, *support_marks)) for panel in panels)


def carried_at_root(time: Floats, carried: Loads, names: Names = SECTION) -> Iterator[Panel]:
    """Loads of the root's section over time, and the extreme stresses along the beam."""
    stress = (carried.stress_tension.max(axis=1), carried.stress_compression.min(axis=1))
    return _load_panels(time, carried.section_force[:, 0], carried.section_moment[:, 0], stress, carried, names)


def error_notes(result: Response | Rest, body: str, carried: Loads) -> tuple[str, ...]:
    """Notes on the estimated errors of a body's loads and, if it is known, stress."""
    kinds = _errors_of(result, body)
    if not np.isfinite(carried.stress).all():
        kinds |= {"stress": math.nan, "its peaks": math.nan}
    return error_note(kinds)


def _errors_of(result: Response | Rest, body: str) -> dict[str, float]:
    """Estimated errors of a body's loads and stress, by name."""
    errors = result.errors
    kinds = {"loads": errors.loads.total, "their peaks": errors.loads.peak}
    kinds |= {"stress": errors.stress.total, "its peaks": errors.stress.peak}
    if len(result.bodies) > 1:  # of which these are the largest
        by_body = errors.loads_by_beam, errors.load_peaks_by_beam, errors.stress_by_beam, errors.stress_peaks_by_beam
        errors_of_body = (dict(zip(errors.beams, values.tolist(), strict=False)) for values in by_body)
        kinds = {kind: values.get(body, math.nan) for kind, values in zip(kinds, errors_of_body, strict=True)}
    return kinds


def _load_panels(
    abscissa: Floats,
    force: Floats,
    moment: Floats,
    stress: tuple[Floats, Floats],
    carried: Loads,
    names: Names = SECTION,
) -> Iterator[Panel]:
    """Panels, over an abscissa (k,), of forces and moments (k, 3) and, if known, of the extreme stresses (k,)."""
    lever = largest_size(force) * float(np.max(carried.stations, initial=0.0))
    moment = np.where(np.abs(moment) <= ROUNDING * lever, 0.0, moment)  # what is no number stays a gap
    for kind, si, values, labels in (("force", "N", force, names[0]), ("moment", "N m", moment, names[1])):
        scale, unit = scale_of(si, values)
        yield components(abscissa, scale * values, labels, Panel(f"{kind}, {unit}", zero=True))
    if np.isfinite(carried.stress).all():
        scale, unit = scale_of("Pa", *stress)
        lines = [Line(abscissa, scale * stress[k], name, colour=k) for k, name in enumerate(("largest", "smallest"))]
        strength = math.inf if carried.yield_strength is None else carried.yield_strength
        levels = limit_levels(scale * strength, scale * np.concatenate(stress), "yield strength")
        yield Panel(f"stress, {unit}", tuple(lines), levels=levels)


def stress(result: SolidStress, title: str = "") -> Figure:
    """Describe the largest von Mises stress over time, and the stress at the named points."""
    scale, unit = scale_of("Pa", result.von_mises)
    lines = [Line(result.time, scale * result.von_mises, "anywhere", **FLIGHT)]
    lines += [
        Line(result.time, scale * result.point_von_mises[:, k], name, colour=k % 5)
        for k, name in enumerate(result.points)
    ]
    levels: tuple[Level, ...] = ()
    critical = result.nearest_yield
    if (
        critical is not None
        and critical.yield_strength is not None
        and critical.yield_strength < NEAR * result.von_mises.max()
    ):
        levels = (Level(scale * critical.yield_strength, f"yield of {critical.material or 'the material'}"),)
    subject = of_motion(result.motion, f"von Mises stress, {result.model}")
    panel = Panel(f"von Mises stress, {unit}", tuple(lines), levels=levels, zero=True, height=2.0)
    place_of_largest = f"at {place_words(result.worst.place)}, {result.worst.time:.4g} s{result.worst.spread_words}"
    return Figure(title, subject, (panel,), (f"largest: {place_of_largest}", *filter(None, [result.left_out])))


def specimen(result: SpecimenLoads, title: str = "") -> Figure:
    """Describe the loads of a rigid specimen: at its corners, force and moment of the fixture, and of the bolts."""
    size = np.linalg.norm(result.acceleration, axis=-1)
    scale, unit = scale_of("m/s^2", size)
    centre = np.linalg.norm(result.centre, axis=-1)
    lines = [Line(result.time, scale * centre, "centre of mass", **FLIGHT)]
    lines += [
        Line(result.time, scale * size.max(axis=1), "largest corner", colour=0),
        Line(result.time, scale * size.min(axis=1), "smallest corner", colour=1, dash="dashed"),
    ]
    panels = [Panel(f"load, {unit}", tuple(lines), zero=True)]
    for values, si, name in ((result.force, "N", "force"), (result.moment, "N m", "moment")):
        factor, factor_unit = scale_of(si, values)
        axes = [f"{name} {axis}" for axis in "xyz"]
        panels.append(components(result.time, factor * values, axes, Panel(f"{name} on the specimen, {factor_unit}")))
    if len(result.bolts):
        panels.append(_bolts(result, result.bolt_pull, "tension (+), compression (−)"))
        panels.append(_bolts(result, result.shear, "shear"))
    subject = of_motion(result.motion, f"rigid specimen of {result.mass:g} kg")
    spread = f"largest spread over the specimen: {100 * result.spread_max:.3g} % of the largest load"
    return Figure(title, subject, tuple(panels), (spread,))


def _bolts(result: SpecimenLoads, values: Floats, name: str) -> Panel:
    """Panel of one quantity of every bolt."""
    factor, unit = scale_of("N", values)
    lines = tuple(
        Line(result.time, factor * values[:, k], f"bolt {k + 1}", colour=k % 6) for k in range(values.shape[1])
    )
    return Panel(f"{name} of bolts, {unit}", lines)
