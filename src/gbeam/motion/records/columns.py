"""Columns of a record: what their names say that they are, and in which axes."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from gbeam.errors import InputError
from gbeam.io.table import Table
from gbeam.motion.records.units import words_of

_TRUST = 'if the name misleads, add skip_checks = ["columns"]'
_LOADS = re.compile(r"(a|n|f|g|nlf|load|factor|acc\w*)[xyz]?")  # words of which a name is a load's
_FACTOR = re.compile(r"\b(n ?[xyz]|nlf|load factor)\b")
_AXIS = re.compile(r"(?:a|n|f|g|acc|accel|imu)?([xyz])")
# Words, or ends of names, of what is no load.
_OTHERS = {
    "a rate of rotation": ("p", "q", "r", "wx", "wy", "wz", "gyro", "gyr", "omega", "rad/s", "deg/s", "dps", "rpm"),
    "an angle": ("roll", "pitch", "yaw", "heading", "phi", "theta", "psi", "alpha", "beta", "aoa", "deg", "rad"),
    "a speed": ("speed", "velocity", "vel", "tas", "ias", "cas", "eas", "mach", "kt", "kts", "knots", "mps", "fps"),
    "a height": ("altitude", "alt", "height", "agl", "msl"),
    "a time": ("time", "timestamp", "utc"),
    "a temperature": ("temperature", "temp"),
}


def refuse_other_kinds(table: Table, names: dict[str, str]) -> None:
    """Refuse a column that is no load by its name, and one that is named for two components."""
    used: dict[str, str] = {}
    for axis, name in names.items():
        _, column = table.signed(name)
        if column is None:
            continue
        table.column(axis, column)
        kind = _other_kind(column)
        if kind:
            loads = [other.name for other in table.columns if any(map(_is_load, words_of(other.name)))]
            fix = f"name a column of load, such as {loads[0]!r}" if loads else "name a column of load"
            raise InputError(f"record.{axis}", f"names {column!r}, by its name {kind} and no load", f"{fix}; {_TRUST}")
        if column in used:
            fix = 'name each once, and "0" for a component that is zero; or add skip_checks = ["columns"]'
            raise InputError(f"record.{axis}", f"names {column!r}, which is {used[column]} too", fix)
        used[column] = axis


def mirrored(table: Table, names: dict[str, str]) -> Iterator[str]:
    """Warn where the columns' axes, right-handed by their names, become left-handed ones of the beam."""
    mapping = np.zeros((3, 3))
    for row, name in zip(mapping, names.values(), strict=True):
        sign, column = table.signed(name)
        axes = [] if column is None else [match[1] for word in words_of(column) if (match := _AXIS.fullmatch(word))]
        if len(axes) == 1:
            row["xyz".index(axes[0])] = sign
    if round(float(np.linalg.det(mapping))) == -1:
        listed = ", ".join(f"{axis} = {name!r}" for axis, name in names.items())
        yield (
            f"{listed} mirrors the columns' axes (determinant -1): two are exchanged, or one has the wrong sign; "
            'aircraft axes, x forward, y right, z down, want x = "X", y = "-Y", z = "-Z". If the columns themselves '
            'are left-handed, such as with a load factor upwards, add skip_checks = ["columns"]'
        )


def load_factors(table: Table, names: dict[str, str], unit: str, *, specific: bool) -> Iterator[str]:
    """Warn of columns that are load factors by their names, and are taken for something else."""
    columns = [column for _, column in map(table.signed, names.values()) if column is not None]
    factors = [column for column in columns if _FACTOR.search(" ".join(words_of(column)))]
    if factors and unit != "g":
        yield f"{factors[0]!r} is a load factor by its name, which is in g, and unit is {unit}"
    if factors and not specific:
        yield (
            f"{factors[0]!r} is a load factor by its name, which is specific force, 1 g in level flight, and quantity "
            "is acceleration"
        )


def _other_kind(name: str) -> str:
    """Kind of quantity that a column's name says it is, such as "a speed"; empty for a load, or an unknown name."""
    words = words_of(name)
    if any(map(_is_load, words)):
        return ""
    ends = {*words, "/".join(words[-2:])}
    return next((kind for kind, known in _OTHERS.items() if ends & set(known)), "")


def _is_load(word: str) -> bool:
    return _LOADS.fullmatch(word) is not None
