"""Columns of a record: what their names say that they are, and in which axes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import permutations, product

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.io.table import Table
from gbeam.motion.records.units import words_of

_TRUST = 'if the name misleads, add skip_checks = ["columns"]'
_LOADS = re.compile(r"(a|n|f|g|nlf|load|factor|acc\w*)[xyz]?")  # words of which a name is a load's
_FACTOR = re.compile(r"\b(n ?[xyz]|nlf|load factor)\b")
_AXIS = re.compile(r"(?:a|n|f|g|acc|accel|imu)?([xyz])")
_AXIS_OF_RATE = re.compile(r"(?:w|g|gyro?|omega|rate|imu)?([xyz])|([pqr])|(roll|pitch|yaw)(?:rate|speed)?")
_AXIS_OF = {"x": 0, "y": 1, "z": 2, "p": 0, "q": 1, "r": 2, "roll": 0, "pitch": 1, "yaw": 2}
_VECTOR = re.compile(r"(.*)[\[(](?::,\s*)?(\d)(?:,\s*:)?[\])]")  # acc[1], acc[:,1], acc(2,:)
_ROTATIONS = [
    turn
    for order in permutations(np.eye(3))
    for signs in product((1.0, -1.0), repeat=3)
    if np.linalg.det(turn := np.array(order) * np.array(signs)) > 0
]
RATE = "a rate of rotation"
# Words, or ends of names, of what is no load.
_OTHERS = {
    RATE: (
        *("p", "q", "r", "wx", "wy", "wz", "gyro", "gyr", "omega", "rad/s", "deg/s", "dps", "rpm"),
        *("rate", "rates", "angular", "ang"),
    ),
    "an angle": ("roll", "pitch", "yaw", "heading", "phi", "theta", "psi", "alpha", "beta", "aoa", "deg", "rad"),
    "a speed": ("speed", "velocity", "vel", "tas", "ias", "cas", "eas", "mach", "kt", "kts", "knots", "mps", "fps"),
    "a height": ("altitude", "alt", "height", "agl", "msl"),
    "a time": ("time", "timestamp", "utc"),
    "a temperature": ("temperature", "temp"),
}


def refuse_other_kinds(table: Table, names: dict[str, str], kind: str = "a load") -> None:
    """Refuse a column that is named twice, and one whose name says that it is of another kind: a rate
    and not a load.
    """
    used: dict[str, str] = {}
    for axis, name in names.items():
        _, column = table.signed(name)
        if column is None:
            continue
        table.column(axis, column)
        other_kind = _kind(column)
        if other_kind not in ("", kind):
            fitting = [column.name for column in table.columns if _kind(column.name) == kind]
            fix = f"name a column of {kind[2:]}" + (f", such as {fitting[0]!r}" if fitting else "")
            problem = f"names {column!r}, by its name {other_kind} and no {kind[2:]}"
            raise InputError(f"record.{axis}", problem, f"{fix}; {_TRUST}")
        if column in used:
            fix = 'name each once, and "0" for a component that is zero; or add skip_checks = ["columns"]'
            raise InputError(f"record.{axis}", f"names {column!r}, which is {used[column]} too", fix)
        used[column] = axis


def mirrored(table: Table, names: dict[str, str]) -> Iterator[str]:
    """Warn where columns with right-handed axes, by their names, are read as left-handed axes of the beam."""
    mapping = _mapping(table, names, _AXIS)
    if round(float(np.linalg.det(mapping))) == -1:
        listed = ", ".join(f"{axis} = {name!r}" for axis, name in names.items())
        yield (
            f"{listed} mirrors the columns' axes (determinant -1): two are exchanged, or one has the wrong sign; "
            'aircraft axes, x forward, y right, z down, want x = "X", y = "-Y", z = "-Z". If the columns themselves '
            'are left-handed, such as with a load factor upwards, add skip_checks = ["columns"]'
        )


def upended(table: Table, names: dict[str, str]) -> dict[str, str]:
    """Columns with another sign of z, and of y where axes would be mirrored without."""
    keys = "yz" if round(float(np.linalg.det(_mapping(table, names, _AXIS)))) == 1 else "z"
    signed = {key: table.signed(names[key]) for key in keys}
    return {key: column if sign < 0 else f"-{column}" for key, (sign, column) in signed.items() if column is not None}


def refuse_other_axes(table: Table, names: dict[str, str], turns: dict[str, str]) -> None:
    """Refuse body rates p, q and r about other axes than those of the loads x, y and z, by the columns' names.

    One rotation takes both from the file's axes to the beam's. If the loads are mirrored, such as with a load factor
    upwards, none fits them, and the rates may have any.
    """
    loads, rates = _mapping(table, names, _AXIS), _mapping(table, turns, _AXIS_OF_RATE)
    fitting = [turn for turn in _ROTATIONS if _fits(turn, loads)]
    if any(_fits(turn, rates) for turn in fitting or _ROTATIONS):
        return
    axis = next((k for k in range(3) if fitting and not any(_fits(turn[k], rates[k]) for turn in fitting)), 0)
    key, load = "pqr"[axis], "xyz"[axis]
    problem = f"is {turns[key]!r} beside {load} = {names[load]!r}: p, q and r are about other axes than x, y, z"
    if not fitting:
        listed = ", ".join(f"{key} = {name!r}" for key, name in turns.items())
        problem = f"mirrors the columns' axes (determinant -1): {listed}"
    raise InputError(f"record.{key}", problem, "; ".join([_rate_advice(table, turns, rates, fitting), _TRUST]))


def _rate_advice(table: Table, turns: dict[str, str], rates: Floats, fitting: list[Floats]) -> str:
    """Advice on the columns of p, q and r, by the only rotation that fits the loads; else on their signs."""
    # Columns of rates by the axis of the file that their names say.
    columns = {int(np.abs(row).argmax()): table.signed(turns[key])[1] for key, row in zip("pqr", rates, strict=True)}
    axes = [] if len(fitting) != 1 else [int(np.abs(row).argmax()) for row in fitting[0]]
    all_names_say_axes = np.abs(rates).any(axis=1).all()
    if not axes or not all_names_say_axes or set(columns) != set(axes):
        return "give p, q and r the signs and the order of x, y and z"
    signs = ("-" if row.sum() < 0 else "" for row in fitting[0])
    named = zip("pqr", signs, axes, strict=True)
    return "write " + ", ".join(f'{key} = "{sign}{columns[axis]}"' for key, sign, axis in named)


def _mapping(table: Table, names: dict[str, str], pattern: re.Pattern[str]) -> Floats:
    """Axes that the names of three columns say, (3, 3): a row for each column has its sign at that axis.

    Names say an axis by a letter, or as the three vectors of one array. Rows of columns that say none are zero.
    """
    signed = [table.signed(name) for name in names.values()]
    matches = [[pattern.fullmatch(word) for word in words_of(column or "")] for _, column in signed]
    axes = [[_AXIS_OF[match.group(match.lastindex or 0)] for match in in_words if match] for in_words in matches]
    indexed = [_VECTOR.fullmatch(column or "") for _, column in signed]
    if not any(axes) and all(indexed):
        stems, numbers = zip(*((match[1], int(match[2])) for match in indexed if match), strict=True)
        if len(set(stems)) == 1 and sorted(numbers) in ([0, 1, 2], [1, 2, 3]):
            axes = [[number - min(numbers)] for number in numbers]
    mapping = np.zeros((3, 3))
    for row, (sign, _), axes_of_name in zip(mapping, signed, axes, strict=True):
        if len(axes_of_name) == 1:
            row[axes_of_name[0]] = sign
    return mapping


def _fits(rotation: Floats, mapping: Floats) -> bool:
    """True if a mapping, or a row of it, is a rotation's but for rows that are not known."""
    return bool(((mapping == rotation) | ~np.abs(mapping).any(axis=-1, keepdims=True)).all())


def load_factors(table: Table, names: dict[str, str], unit: str, *, specific: bool) -> Iterator[str]:
    """Warn of columns that are load factors by their names, but are read in another unit than g or as acceleration."""
    columns = [column for _, column in map(table.signed, names.values()) if column is not None]
    factors = [column for column in columns if _FACTOR.search(" ".join(words_of(column)))]
    if factors and unit != "g":
        yield f"{factors[0]!r} is a load factor by its name, which is in g, and unit is {unit}"
    if factors and not specific:
        yield (
            f"{factors[0]!r} is a load factor by its name, which is specific force, 1 g in level flight, and quantity "
            "is acceleration"
        )


def _kind(name: str) -> str:
    """Kind of quantity that a column's name says it is, such as "a speed", or empty for an unknown name."""
    words = words_of(name)
    if any(_LOADS.fullmatch(word) for word in words):
        return "a load"
    ends = {*words, "/".join(words[-2:])}
    return next((kind for kind, known in _OTHERS.items() if ends & set(known)), "")
