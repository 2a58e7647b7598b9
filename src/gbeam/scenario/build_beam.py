"""Beams and models of a scenario as objects of the core."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gbeam.scenario import schema
from gbeam.scenario.origin import Collector

if TYPE_CHECKING:
    from gbeam.mechanics.models import Model
    from gbeam.structure.attachments import Load
    from gbeam.structure.beam import Beam
    from gbeam.structure.line import Line


def beam_of(parts: Collector, where: str, table: schema.Beam) -> Beam | None:
    """The beam of a table at a place of the scenario."""
    from gbeam.structure.attachments import Point, PointMass, Root
    from gbeam.structure.beam import Beam
    from gbeam.structure.material import Material
    from gbeam.structure.section import Section

    dimensions = table.section.model_dump(exclude={"shape", "stations"}, exclude_none=True)
    section = parts.attempt(f"{where}.section", Section.of, table.section.shape, table.section.stations, **dimensions)
    given = None if table.material is None else table.material.model_dump(exclude_none=True)
    material = None if given is None else parts.attempt(f"{where}.material", Material, **given)
    masses = []
    for i, body in enumerate(table.masses):
        moments = (body.inertia.x, body.inertia.y, body.inertia.z) if body.inertia else (0.0, 0.0, 0.0)
        offset = body.offset or (0.0, 0.0, 0.0)
        named = body.name or ""
        masses.append(parts.attempt(f"{where}.masses[{i}]", PointMass, body.at, body.mass, moments, offset, named))
    root = parts.attempt(f"{where}.root", Root, **table.root.model_dump())
    loads = [_load(parts, f"{where}.loads[{i}]", entry) for i, entry in enumerate(table.loads)]
    points = [parts.attempt(f"{where}.points[{i}]", Point, each.name, each.at) for i, each in enumerate(table.points)]
    line = None if table.line is None else _line(parts, f"{where}.line", table.line)
    if section is None or (material is None) != (given is None) or root is None or None in [*masses, *loads, *points]:
        return None
    if line is None and table.line is not None:
        return None
    return parts.attempt(
        where,
        Beam,
        line.length if table.length is None else table.length,  # type: ignore[union-attr]
        section,
        material,
        masses,
        table.damping_ratio,
        root,
        loads,
        points,
        table.rotary_inertia,
        line,
    )


def _line(parts: Collector, where: str, table: schema.Line) -> Line | None:
    from gbeam.structure.line import Line

    twist = table.twist or 0.0
    if table.points is not None:
        return parts.attempt(where, Line.of_points, table.points, twist, smooth=table.smooth)
    if table.stations is not None:
        along = [(x, 0.0, 0.0) for x in table.stations]
        return parts.attempt(where, Line.of_points, along, twist, smooth=False)
    lengths, *turns = zip(*((p.length, p.twist, p.turn_y, p.turn_z) for p in table.pieces or ()), strict=True)
    named = dict(zip(("twist", "turn_y", "turn_z"), turns, strict=True))
    return parts.attempt(where, Line.of_pieces, lengths, **named)


def _load(parts: Collector, where: str, table: schema.Load) -> Load | None:
    from gbeam.scenario.build_motion import components
    from gbeam.structure.attachments import Load

    vectors = {"force": table.force, "distributed": table.distributed, "moment": table.moment}
    built = {
        "moment" if name == "moment" else "force": components(parts, f"{where}.{name}", vector)
        for name, vector in vectors.items()
        if vector is not None
    }
    return None if None in built.values() else parts.attempt(where, Load, table.at, follower=table.follower, **built)


def model_of(parts: Collector, where: str, table: schema.Model) -> Model | None:
    """The model of a table at a place of the scenario."""
    from gbeam.mechanics.models import Model

    if table.modes is None:
        return parts.attempt(where, Model.of, table.kind, table.shapes)
    return parts.attempt(where, Model, table.kind, shapes=table.shapes or "clamped-free", **table.modes.model_dump())
