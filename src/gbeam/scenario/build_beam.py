"""Beams and models of a scenario as objects of the core."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError, naming
from gbeam.guards.limits import ENTRIES
from gbeam.guards.units import UnitError, quantity
from gbeam.scenario import schema
from gbeam.scenario.collector import Collector

if TYPE_CHECKING:
    from gbeam.io.table import Table
    from gbeam.mechanics.models import Model
    from gbeam.structure.attachments import Load
    from gbeam.structure.beam import Beam
    from gbeam.structure.line import Line
    from gbeam.structure.material import Material
    from gbeam.structure.section import Section


def beam_of(parts: Collector, where: str, table: schema.Beam) -> Beam | None:
    """The beam of a table at a path of the scenario; None if a part of it is refused, with the reasons in `parts`."""
    from gbeam.structure.attachments import Point, PointMass, Root
    from gbeam.structure.beam import Beam
    from gbeam.structure.material import Material

    values = None if table.material is None else table.material.model_dump(exclude_none=True)
    material = None if values is None else parts.attempt(f"{where}.material", Material, **values)
    drawn = isinstance(table.section, schema.Drawn)
    can_build = material is not None or not drawn  # the matrices of a drawn section need its material
    section = parts.attempt(f"{where}.section", _section, table.section, material) if can_build else None
    masses = []
    for i, body in enumerate(table.masses):
        moments = (body.inertia.x, body.inertia.y, body.inertia.z) if body.inertia else (0.0, 0.0, 0.0)
        offset = body.offset or (0.0, 0.0, 0.0)
        name = body.name or ""
        masses.append(parts.attempt(f"{where}.masses[{i}]", PointMass, body.at, body.mass, moments, offset, name))
    root = parts.attempt(f"{where}.root", Root, **table.root.model_dump())
    loads = [_load(parts, f"{where}.loads[{i}]", entry) for i, entry in enumerate(table.loads)]
    points = [parts.attempt(f"{where}.points[{i}]", Point, each.name, each.at) for i, each in enumerate(table.points)]
    line = None if table.line is None else _line(parts, f"{where}.line", table.line)
    if section is None or (material is None) != (values is None) or root is None or None in [*masses, *loads, *points]:
        return None
    if line is None and table.line is not None:
        return None
    return parts.attempt(
        where,
        Beam,
        length=line.length if table.length is None else table.length,  # type: ignore[union-attr]
        section=section,
        material=None if drawn else material,
        masses=masses,
        damping_ratio=table.damping_ratio,
        root=root,
        loads=loads,
        points=points,
        rotary_inertia=table.rotary_inertia,
        line=line,
    )


def _section(table: Any, material: Material | None) -> Section:
    """A section by its outline and material, by files of matrices, or by shape and dimensions."""
    from gbeam.structure.section import Section

    values = table.model_dump(exclude={"shape", "stations"}, exclude_none=True)
    if isinstance(table, schema.Drawn):
        assert material is not None
        return Section.drawn(values.pop("outline"), material, **values)
    if values.get("file") is None:
        return Section.of(table.shape, table.stations, **values)
    file = values.pop("file")
    with naming({"path": "file", "paths": "file"}):
        return Section.read(*((file,) if isinstance(file, str) else file), stations=table.stations, **values)


def _line(parts: Collector, where: str, table: schema.Line) -> Line | None:
    """A line from a file of points, points, a twist at stations, or pieces; None if it is refused."""
    from gbeam.structure.line import Line

    twist = table.twist or 0.0
    if isinstance(table.points, str):
        return parts.attempt(f"{where}.points", _through, table.points, table.length_unit, table.twist, table.smooth)
    if table.points is not None:
        return parts.attempt(where, Line.of_points, table.points, twist, smooth=table.smooth)
    if table.stations is not None:
        along = [(x, 0.0, 0.0) for x in table.stations]
        return parts.attempt(where, Line.of_points, along, twist, smooth=False)
    lengths, *turns = zip(*((p.length, p.twist, p.turn_y, p.turn_z) for p in table.pieces or ()), strict=True)
    named = dict(zip(("twist", "turn_y", "turn_z"), turns, strict=True))
    return parts.attempt(where, Line.of_pieces, lengths, **named)


_COLUMNS = {"x": "length", "y": "length", "z": "length", "twist": "angle"}  # of a line's file, with their kinds
_POINT = re.compile(r"points\[(\d+)\]")
_NAMED = "name the columns x [mm], y [mm], z [mm], twist [deg], in units of their own, and leave others out"


def _through(file: str, unit: str | None, twist: Any, smooth: bool) -> Line:
    """The line through the points in the rows of a text file; InputErrors name the file and its row."""
    import numpy as np

    from gbeam.motion.records.text import read_text
    from gbeam.structure.line import Line

    rows: Any = None
    try:
        rows = read_text(file)
        columns = _columns(rows, unit)
        if twist is not None and "twist" in columns:
            raise InputError("", "has a column twist, and twist is given too", "leave one of them out")
        count = len(columns["x"])
        if not 2 <= count <= ENTRIES:
            raise InputError("", f"has {count} row(s) of numbers", f"give 2 to {ENTRIES}")
        if twist is not None and len(twist) != count:
            raise InputError("", f"has {count} rows, and twist {len(twist)} values", "give one for each row")
        points = np.stack([columns.get(axis, np.zeros(count)) for axis in "xyz"], axis=1)
        return Line.of_points(points, columns.get("twist", 0.0 if twist is None else twist), smooth=smooth)
    except InputError as error:
        point = f"{error.where} " if error.where.startswith("points[") else ""
        problem = re.sub(_POINT, lambda k: rows.place(int(k[1])), point + error.problem.removeprefix(f"{file} "))
        raise InputError("", f"is {Path(file).name}: {problem}", error.fix) from None


def _columns(rows: Table, unit: str | None) -> dict[str, Any]:
    """Columns of a line's file by name, in SI; `unit` is of lengths without one. InputError for an unknown column."""
    from gbeam.motion.records.units import unit_in_name, words_of

    columns: dict[str, Any] = {}
    for column in rows.columns:
        stated = column.unit.strip("[]() ") or unit_in_name(column.name)
        name, *others = words_of(column.name) or [""]
        kind = _COLUMNS.get(name)
        if kind is None or others not in ([], words_of(stated)) or name in columns:
            problem = f"has a column {column.name!r}" + (" a second time" if name in columns else "")
            raise InputError("", problem, _NAMED)
        length_unit = unit if kind == "length" else None
        if not (stated or length_unit):
            also = ', or add length_unit = "mm"' if kind == "length" else ""
            raise InputError("", f"does not say the unit of {name}", f"{_NAMED}{also}")
        try:
            size = quantity(f"1 {stated or length_unit}", kind)
            if length_unit and size != quantity(f"1 {length_unit}", kind):
                raise InputError(
                    "", f"has {name} in {stated}, and length_unit is {length_unit}", "leave length_unit out"
                )
        except UnitError as error:
            raise InputError(
                "", f"has {name} in {stated or length_unit}: {error.problem}", error.hint or _NAMED
            ) from None
        columns[name] = size * rows.numbers(name, column.name)
    if "x" not in columns:
        raise InputError("", "has no column x", _NAMED)
    return columns


def _load(parts: Collector, where: str, table: schema.Load) -> Load | None:
    """A load of a table; None if it is refused."""
    from gbeam.scenario.build_motion import components
    from gbeam.structure.attachments import Load

    vectors = {"force": table.force, "distributed": table.distributed, "moment": table.moment}
    built = {
        "moment" if name == "moment" else "force": components(parts, f"{where}.{name}", vector)
        for name, vector in vectors.items()
        if vector is not None
    }
    return None if None in built.values() else parts.attempt(where, Load, table.at, follower=table.follower, **built)


def model_of(parts: Collector, where: str, table: schema.Model, beam: Beam | None) -> Model | None:
    """The model of a table for a beam; without numbers of modes, one that chooses them. None if it is refused."""
    from gbeam.mechanics.models import Model

    if table.modes is None:
        coupled = beam is not None and beam.coupled
        return parts.attempt(where, Model.of, table.kind, table.shapes or ("clamped-free" if coupled else None))
    return parts.attempt(where, Model, table.kind, shapes=table.shapes or "clamped-free", **table.modes.model_dump())
