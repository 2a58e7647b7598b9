"""Units that a record may be in, and how files spell them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError

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
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return re.findall(r"[^\W_]+", parted.lower())


def unit_in_name(name: str) -> str:
    """Unit in which a column's name ends, as files spell it: g of ``a_z_g``, rad/s of ``p_rad_s``; empty if none."""
    *before, last = words_of(name) or [""]
    candidates = [f"{before[-1]}/{last}"] if len(before) > 1 else []
    candidates += [last] if before and last not in _BARE else []
    return next((text for text in candidates if is_unit(text)), "")


def is_unit(text: str) -> bool:
    """Whether a cell of a file is a unit of time, acceleration or rate, perhaps in brackets."""
    return any(_canonical(text, quantity) is not None for quantity in _SPELLINGS)


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
        canonical = _canonical(text, quantity)
        if canonical is None:
            other = [kind for kind in _TELLING if kind != quantity and _canonical(text, kind) and text not in _BARE]
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


def _canonical(text: str, quantity: str) -> str | None:
    words = text.strip().strip("[]()").replace("²", "^2").replace("**", "^").replace("µ", "u").replace("μ", "u")
    words = words.split(" since ")[0]  # "seconds since 2024-01-01", as netCDF has it
    return _SPELLINGS[quantity].get("".join(words.replace("·", "").replace("*", "").lower().split()))


def spelled(text: str, quantity: str) -> str | None:
    """Return the unit that a file's spelling stands for, whether a record may be in it or not; None for none."""
    return _canonical(text, quantity)
