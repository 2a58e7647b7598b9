"""Figures of systems and of solids: points and coordinates over time, energies, stress, loads."""

from __future__ import annotations

import numpy as np

from gbeam.figures.description import (
    FLIGHT,
    REFERENCE,
    ROUNDING,
    Dash,
    Figure,
    Level,
    Line,
    Panel,
    components,
    estimated,
    moving,
    not_drawn,
    of_motion,
    scale_of,
)
from gbeam.figures.response import carried_at_root
from gbeam.printable import raised
from gbeam.results.result import Floats
from gbeam.results.solids import SolidStress, SpecimenLoads, place_words
from gbeam.results.system import ENERGIES, named

COLOURS = 6
DASHES: tuple[Dash, ...] = ("solid", "dashed", "dotted")


def points(response: SystemResponse, title: str = "") -> Figure:
    """Describe the displacement of every point from its place at the start along the axes of the ground."""
    moved = response.place - response.place[0]
    scale, unit = scale_of("m", moved)
    axes = moving(moved)
    panels = tuple(
        Panel(
            f"{'xyz'[i]}, {unit}",
            tuple(
                Line(
                    response.time,
                    scale * moved[:, k, i],
                    response.points[k],
                    colour=n % COLOURS,
                    dash=DASHES[n // COLOURS % len(DASHES)],
                )
                for n, k in enumerate(_moving(moved))
            ),
            zero=True,
            named=i == axes[0],
        )
        for i in axes
    )
    subject = "displacement of the points from the start, axes of the ground"
    notes = (*not_drawn(axes, moved), *estimated({"": response.error_estimate}))
    return Figure(title, subject, panels, notes, (response.outcome,))


def _moving(moved: np.ndarray) -> list[int]:
    """Indices of the points that move; of points that move alike only the first."""
    size = np.abs(moved).max(initial=0.0)
    chosen: list[int] = []
    for k in range(moved.shape[1]):
        distances = [np.abs(moved[:, k] - moved[:, other]).max(initial=0.0) for other in chosen]
        if np.abs(moved[:, k]).max(initial=0.0) > ROUNDING * size and min(distances, default=np.inf) > ROUNDING * size:
            chosen.append(k)
    return chosen


def coordinates(response: SystemResponse, title: str = "") -> Figure:
    """Describe the joints' coordinates and the efforts of their drives."""
    panels = []
    histories = named(response)
    size = max((np.abs(history).max(initial=0.0) for history, *_ in histories.values()), default=0.0)
    for name, (history, unit, effort) in histories.items():
        if 0 < np.abs(history).max(initial=0.0) <= ROUNDING * size:  # rounding
            continue
        panels.append(Panel(f"{name}, {unit}", (Line(response.time, history),)))
        if np.any(effort):
            scale, unit = scale_of("N" if unit == "m" else "N m", effort)
            panels.append(Panel(f"drive, {unit}", (Line(response.time, scale * effort),), zero=True))
    return Figure(title, "coordinates of the joints", tuple(panels), outcomes=(response.outcome,))


def loop(response: SystemResponse, title: str = "") -> Figure:
    """Describe measurements and commands of the controllers, as asked for and as applied."""
    assert response.loop is not None
    panels = [
        Panel(f"{name.rpartition(': ')[2]}, {raised(unit)}", (Line(response.time, response.loop.measured[:, k]),))
        for k, (name, unit) in enumerate(zip(response.loop.measurements, response.loop.units, strict=True))
    ]
    for k, (name, unit) in enumerate(zip(response.loop.drives, response.loop.drive_units, strict=True)):
        asked, applied = response.loop.asked[:, k], response.loop.applied[:, k]
        scale, unit = scale_of(unit, asked, applied)
        lines = (
            Line(response.time, scale * asked, "asked for", colour=REFERENCE, dash="dashed"),
            Line(response.time, scale * applied, "applied"),
        )
        panels.append(Panel(f"{name}, {unit}", lines, zero=True))
    return Figure(title, "controllers", tuple(panels), outcomes=(response.outcome,))


def loads(response: SystemResponse, body: str, title: str = "") -> Figure:
    """Describe over time what the root's section of a beam carries, and the extreme stresses along it."""
    subject = f"loads in the root's section of {body}, and stress anywhere along it"
    panels = carried_at_root(response.time, response.beams[body].loads)
    return Figure(title, subject, tuple(panels), outcomes=(response.outcome,))


def energy(response: SystemResponse, title: str = "") -> Figure:
    """Describe kinetic and elastic energy, that of gravity, and their sum."""
    assert response.invariants is not None
    parts = response.invariants.energy
    lines = [Line(response.time, parts[:, k], name, colour=k) for k, name in enumerate(ENERGIES)]
    lines.append(Line(response.time, parts.sum(axis=1), "whole", colour=len(ENERGIES), dash="dashed"))
    return Figure(title, "energy", (Panel("energy, J", tuple(lines)),), outcomes=(response.outcome,))


NEAR = 3.0  # times the largest stress: a strength beyond would press the lines to the ground


def stress(result: SolidStress, title: str = "") -> Figure:
    """Describe the largest von Mises stress over time, and that at the named points."""
    scale, unit = scale_of("Pa", result.von_mises)
    lines = [Line(result.time, scale * result.von_mises, "anywhere", **FLIGHT)]
    lines += [
        Line(result.time, scale * result.point_von_mises[:, k], name, colour=k % 5)
        for k, name in enumerate(result.points)
    ]
    levels: tuple[Level, ...] = ()
    near = result.nearest_yield
    if near is not None and near.yield_strength is not None and near.yield_strength < NEAR * result.von_mises.max():
        levels = (Level(scale * near.yield_strength, f"yield of {near.material or 'the material'}"),)
    subject = of_motion(result.motion, f"von Mises stress, {result.model}")
    panel = Panel(f"von Mises stress, {unit}", tuple(lines), levels=levels, zero=True, height=2.0)
    where = f"at {place_words(result.worst.place)}, {result.worst.time:.4g} s{result.worst.apart}"
    return Figure(title, subject, (panel,), (f"largest: {where}", *filter(None, [result.left_out])))


def specimen(result: SpecimenLoads, title: str = "") -> Figure:
    """Describe the load at the corners, force and moment of the fixture, and of the bolts."""
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
