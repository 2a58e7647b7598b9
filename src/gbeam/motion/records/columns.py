"""Columns of a record: the units that they may be in and how files spell them, and what their names say."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.io.table import Table

# Per quantity, the units that a scenario may name and their size in SI.
UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"g": STANDARD_GRAVITY, "m/s^2": 1.0, "ft/s^2": 0.3048},
    "rate": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
}
# Spellings after _plain; where the unit is none of the above, a record in it is refused.
_SPELLINGS: dict[str, dict[str, str]] = {
    "acceleration": {
        **dict.fromkeys(("g", "g0", "gn", "gs", "g's", "-", "1"), "g"),  # a load factor has no dimension
        **dict.fromkeys(("m/s^2", "m/s2", "m/s/s", "ms^-2", "ms-2", "ms2", "m/sec^2", "m/sec2", "mps2"), "m/s^2"),
        **{unit: unit for unit in ("mg", "mm/s^2", "mm/s2", "cm/s^2", "cm/s2", "in/s^2", "gal")},
        **dict.fromkeys(("ft/s^2", "ft/s2", "ft/s/s", "ft/sec^2", "ft/sec2", "fts^-2", "fps2"), "ft/s^2"),
    },
    "rate": {
        **dict.fromkeys(("rad/s", "rads-1", "rads^-1", "rad/sec", "rps", "radps"), "rad/s"),
        **dict.fromkeys(
            ("deg/s", "degs-1", "degs^-1", "deg/sec", "°/s", "degrees/s", "degree/s", "dps", "degps"), "deg/s"
        ),
        "rpm": "rpm",
    },
    "time": {
        **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
        **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds"), "ms"),
        **dict.fromkeys(("us", "usec", "microsecond", "microseconds"), "us"),
        **dict.fromkeys(("min", "mins", "minute", "minutes"), "min"),
        **{unit: unit for unit in ("h", "hour", "hours", "day", "days", "ns", "nanoseconds")},
    },
    # Of other files than records.
    "length": {unit: unit for unit in ("m", "mm", "cm", "in", "ft")},
    "angle": {unit: unit for unit in ("deg", "rad", "°")},
}


_BARE = ("1", "-")  # a load factor's units: in a name they are a number and a dash
_TELLING = ("acceleration", "rate")  # of which a unit is one of nothing else


def words_of(name: str) -> list[str]:
    """Words of a column's name, in small letters: ``acc_Z [m/s^2]`` has acc, z, m, s and 2."""
    separated = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return re.findall(r"[^\W_]+", separated.lower())


def unit_in_name(name: str) -> str:
    """Unit in which a column's name ends, as files spell it: g of ``a_z_g``, rad/s of ``p_rad_s``; empty if none."""
    *before, last = words_of(name) or [""]
    candidates = [f"{before[-1]}/{last}"] if len(before) > 1 else []
    candidates += [last] if before and last not in _BARE else []
    return next((text for text in candidates if is_unit(text)), "")


def is_unit(text: str) -> bool:
    """True if a cell of a file is a unit of time, acceleration or rate, perhaps in brackets."""
    return any(spelled(text, quantity) is not None for quantity in _SPELLINGS)


def unit_of(
    key: str, quantity: str, declared: str | None, stated: Iterable[tuple[str, str]], *, trust: bool
) -> str | None:
    """Return the unit that the scenario and the file agree on, a key of ``UNITS[quantity]``; None without one."""
    units = UNITS[quantity]
    declared = declared.replace("²", "^2") if declared else None
    if declared is not None and declared not in units:
        raise InputError(f"record.{key}", f"is {declared!r}", f"choose {' or '.join(units)}")
    if declared is not None and trust:
        return declared
    unit = declared
    for column, stated_unit in stated:
        text = stated_unit or unit_in_name(column)
        canonical = spelled(text, quantity)
        if canonical is None:
            other = [kind for kind in _TELLING if kind != quantity and spelled(text, kind) and text not in _BARE]
            if other:
                problem = f"is {unit or 'missing'}, and the file gives column {column!r} in {text}, of {other[0]}"
                fix = 'name another column; if the file is wrong, add skip_checks = ["unit"]'
                raise InputError(f"record.{key}", problem, fix)
            continue
        if canonical not in units:
            raise InputError(
                f"record.{key}",
                f"is {unit or 'missing'}, and the file gives column {column!r} in {text}",
                f"convert the column to {' or '.join(units)}",
            )
        if unit is not None and canonical != unit:
            raise InputError(
                f"record.{key}",
                f"is {unit}, and the file gives column {column!r} in {text}",
                f'write {key} = "{canonical}"; if the file is wrong, add skip_checks = ["unit"]',
            )
        unit = canonical
    return unit


def spelled(text: str, quantity: str) -> str | None:
    """Return the unit that a file's spelling stands for, whether a record may be in it or not; None for none."""
    words = text.strip().strip("[]()").replace("²", "^2").replace("**", "^").replace("µ", "u").replace("μ", "u")
    words = words.split(" since ")[0]  # "seconds since 2024-01-01", as netCDF has it
    return _SPELLINGS[quantity].get("".join(words.replace("·", "").replace("*", "").lower().split()))


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
