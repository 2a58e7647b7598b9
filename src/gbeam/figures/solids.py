"""Stress of a solid over time, and the loads of a rigid specimen."""

from __future__ import annotations

import numpy as np

from gbeam.figures.description import FLIGHT, Figure, Level, Line, Panel, components, of_motion, scale_of
from gbeam.results.result import Floats
from gbeam.results.solids import SolidStress, SpecimenLoads

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
    about = of_motion(result.motion, f"von Mises stress, {result.model}")
    panel = Panel(f"von Mises stress, {unit}", tuple(lines), levels=levels, zero=True, height=2.0)
    return Figure(title, about, (panel,), (f"largest: {_where(result)}",))


def _where(result: SolidStress) -> str:
    x, y, z = (1e3 * float(each) for each in result.worst.place)
    at = f"at ({x:.4g}, {y:.4g}, {z:.4g}) mm, {result.worst.time:.4g} s"
    return f"{at}; elements there differ by {100 * result.worst.spread:.2g} %"


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
        factor, named = scale_of(si, values)
        axes = [f"{name} {way}" for way in "xyz"]
        panels.append(components(result.time, factor * values, axes, Panel(f"{name} on the specimen, {named}")))
    if len(result.bolts):
        panels.append(_bolts(result, result.tension, "tension"))
        panels.append(_bolts(result, result.shear, "shear"))
    about = of_motion(result.motion, f"rigid specimen of {result.mass:g} kg")
    spread = f"largest spread over the specimen: {100 * result.spread_max:.3g} % of the largest load"
    return Figure(title, about, tuple(panels), (spread,))


def _bolts(result: SpecimenLoads, values: Floats, name: str) -> Panel:
    factor, unit = scale_of("N", values)
    lines = tuple(
        Line(result.time, factor * values[:, k], f"bolt {k + 1}", colour=k % 6) for k in range(values.shape[1])
    )
    return Panel(f"{name} of bolts, {unit}", lines)
