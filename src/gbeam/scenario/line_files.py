"""Lines of beams from files of text: a row for each point."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import ENTRIES
from gbeam.guards.parameters import parameters_of
from gbeam.guards.units import UnitError, quantity
from gbeam.structure.line import Line

if TYPE_CHECKING:
    from gbeam.io.table import Table

_COLUMNS = dict.fromkeys("xyz", "points") | {"twist": "twist"}  # of a line's file, with the parameters that they give
_POINT = re.compile(r"points\[(\d+)\]")
_NAMED = "name the columns x [mm], y [mm], z [mm], twist [deg], in units of their own, and leave others out"


def read_line(file: str, unit: str | None, twist: Any, smooth: bool) -> Line:
    """The line through the points in the rows of a text file; InputErrors name the file and its row."""
    from gbeam.motion.records.text import read_text

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
    """Columns of a line's file by name, in SI. `unit` is of lengths without one. InputError for an unknown column."""
    from gbeam.motion.records.units import unit_in_name, words_of

    declared = parameters_of(Line.of_points)
    kinds = {name: declared[parameter].quantity for name, parameter in _COLUMNS.items()}
    columns: dict[str, Any] = {}
    for column in rows.columns:
        stated = column.unit.strip("[]() ") or unit_in_name(column.name)
        name, *further_words = words_of(column.name) or [""]
        kind = known.kind if (known := kinds.get(name)) else ""
        if not kind or further_words not in ([], words_of(stated)) or name in columns:
            problem = f"has a column {column.name!r}" + (" a second time" if name in columns else "")
            raise InputError("", problem, _NAMED)
        length_unit = unit if kind == "length" else None
        if not (stated or length_unit):
            advice = ', or add length_unit = "mm"' if kind == "length" else ""
            raise InputError("", f"does not say the unit of {name}", f"{_NAMED}{advice}")
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
