"""Units of records: how scenarios and files spell them, sizes of counts, and the one that both agree on."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, Any

from gbeam.constants import DEGREE, RPM, STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.units import UnitError
from gbeam.printable import advise, shortened

# Per quantity, the units that a record may be in and their size in SI.
UNITS: dict[str, dict[str, float]] = {
    "acceleration": {
        **{"g": STANDARD_GRAVITY, "m/s^2": 1.0, "ft/s^2": 0.3048, "mg": STANDARD_GRAVITY / 1000},
        **{"mm/s^2": 1e-3, "cm/s^2": 1e-2, "in/s^2": 0.0254},
    },
    "rate": {"rad/s": 1.0, "deg/s": DEGREE, "rpm": RPM},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "day": 86400.0},
}
_FEET = {"ft": "f", "in": "i"}  # in fps2 and ips2
_PER_SECOND_SQUARED = ("{}/s^2", "{}/s2", "{}/s/s", "{}s^-2", "{}s-2", "{}_s2", "{}_s^2", "{}_s_2")
# Spellings after `_plain`: of the units above, and of other quantities, such as those of files that are no records.
_SPELLINGS: dict[str, dict[str, str]] = {
    "acceleration": {
        **dict.fromkeys(("g", "g0", "gn", "gs", "g's", "gee", "g-force", "gforce", "-", "1"), "g"),  # a load factor
        **dict.fromkeys(("mg", "mgs"), "mg"),
        **dict.fromkeys(("gal", "gals"), "cm/s^2"),
        "ms2": "m/s^2",
        **{
            spelling.format(length): f"{length}/s^2"
            for length in ("m", "mm", "cm", "ft", "in")
            for spelling in (*_PER_SECOND_SQUARED, f"{_FEET.get(length, length)}ps2")
        },
    },
    "rate": {
        **dict.fromkeys(("rad/s", "rad_s", "rads-1", "rads^-1", "rps", "radps", "s-1", "s^-1", "1/s"), "rad/s"),
        **dict.fromkeys(("deg/s", "deg_s", "degs-1", "degs^-1", "°/s", "dps", "degps"), "deg/s"),
        "rpm": "rpm",
    },
    "time": {
        **dict.fromkeys(("s", "secs"), "s"),
        **dict.fromkeys(("ms", "msec", "millis"), "ms"),
        **dict.fromkeys(("us", "usec", "micros"), "us"),
        **dict.fromkeys(("ns", "nsec", "nanos"), "ns"),
        **dict.fromkeys(("min", "mins", "minute", "minutes"), "min"),
        **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), "h"),
        **dict.fromkeys(("day", "days"), "day"),
    },
    "length": {unit: unit for unit in ("m", "mm", "cm", "in", "ft")},
    "angle": {unit: unit for unit in ("deg", "rad", "°")},
    "signal": {unit: unit for unit in ("mv", "uv", "volts", "counts", "lsb", "adc")},  # of a sensor without its scale
}
_LONG = {
    **{f"{prefix}met{end}": f"{short}m" for prefix, short in (("milli", "m"), ("centi", "c"), ("", ""))
       for end in ("ers", "res", "er", "re")},
    **dict.fromkeys(("milliseconds", "millisecond"), "ms"), **dict.fromkeys(("microseconds", "microsecond"), "us"),
    **dict.fromkeys(("nanoseconds", "nanosecond"), "ns"), **dict.fromkeys(("seconds", "second", "sec"), "s"),
    **dict.fromkeys(("degrees", "degree"), "deg"), **dict.fromkeys(("radians", "radian"), "rad"),
    **dict.fromkeys(("feet", "foot"), "ft"), **dict.fromkeys(("inches", "inch"), "in"),
    "per": "/", "squared": "^2",
}  # fmt: skip
_WORD = re.compile(rf"(?<![a-z])({'|'.join(_LONG)})(?![a-z])")

_BARE = ("1", "-")  # a load factor's units: in a name they are a number and a dash
_TELLING = ("acceleration", "rate", "signal")  # of which a unit at the end of a name is one of nothing else
# Nothing is read twice, however long a name in a file is: possessive quantifiers, and white space from its beginning.
_BRACKETS = re.compile(r"((?:.*[\])])?[^\[\]()]*)[\[(]([^\])]*)[\])]")
_INDEX = re.compile(r"(?<!\s)\s*+[\[(][\d:, ]*[\])]$")  # acc[1], acc(:,3)
_RANGES = ("high", "low")  # high g: a sensor's range
_NUMBER = r"[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?"
_SIZED = re.compile(rf"(?:({_NUMBER})\s*+)?([^\d\s/.+-].*?)(?:(?<!\s)\s*+/\s*+({_NUMBER})\s*+([^\W\d]*))?")


@dataclass(frozen=True)
class Unit:
    """Unit of columns of a record."""

    text: str  # in words: g, or 1 g / 2048
    size: float  # in SI
    stated: bool = False  # true if the file states one

    def instead(self, key: str, unit: str) -> str:
        """Advice to write another unit at a key of the record, which a file that states this one would contradict."""
        return f'write {key} = "{unit}"' + (' and skip_checks = ["unit"]' if self.stated else "")


@dataclass(frozen=True)
class UnitOfRecord:
    """Annotation of a unit in a record's file: one of a quantity's words, another spelling, or the size of a count."""

    quantity: str  # a key of UNITS
    example: str

    def read(self, text: str) -> str:
        """Return the text; UnitError, with the fix, if it is no unit."""
        try:
            sized("unit", self.quantity, text)
        except InputError as error:
            raise UnitError(error.problem, error.fix) from None
        return text

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> dict[str, Any]:
        """Validate with :meth:`read`, after text."""
        function = {"type": "no-info", "function": self.read}
        return {"type": "function-after", "schema": handler(str), "function": function}

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Describe it as one of the words, or as text."""
        return {"anyOf": [{"enum": [*UNITS[self.quantity]]}, {"type": "string", "examples": [self.example]}]}


LoadUnit = Annotated[str, UnitOfRecord("acceleration", "1 g / 2048")]
RateUnit = Annotated[str, UnitOfRecord("rate", "1 deg/s / 16.4")]
TimeUnit = Annotated[str, UnitOfRecord("time", "1 s / 32768")]


def words_of(name: str) -> list[str]:
    """Words of a column's name, in small letters: ``acc_Z [m/s^2]`` has acc, z, m, s and 2."""
    return _separated(_CAMEL.sub(" ", name))


_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


def _separated(name: str) -> list[str]:
    return re.findall(r"[^\W_]+", name.lower())


def bracketed(name: str) -> tuple[str, str] | None:
    """Parts of a name that ends in brackets: before these and inside, or None of another name."""
    match = _BRACKETS.fullmatch(name.strip())
    return match and (match[1].rstrip(), match[2].strip())


def unit_in_name(name: str) -> str:
    """Unit at the end of a column's name, as files spell it: g of ``a_z_g``, rad/s of ``p_rad_s``; else empty.

    It follows a separator, or has two letters: ``timeUS`` is in µs, ``accHighG`` has no unit.
    """
    stem = _INDEX.sub("", name)
    *earlier_words, last = _separated(stem) or [""]
    camel = _CAMEL.split(stem)[-1].lower()
    candidates = [f"{earlier_words[-1]}/{last}"] if len(earlier_words) > 1 else []
    candidates += [last] if earlier_words and last not in _BARE and earlier_words[-1] not in _RANGES else []
    candidates += [camel] if 1 < len(camel) < len(last) else []
    return next((text for text in candidates if is_unit(text)), "")


def is_unit(text: str) -> bool:
    """True if a cell of a file is a unit of time, acceleration or rate, perhaps in brackets."""
    return any(spelled(text, quantity) is not None for quantity in _SPELLINGS)


def spelled(text: str, quantity: str) -> str | None:
    """Return the unit that a spelling stands for, a key of ``UNITS`` for the quantities there, or None for none."""
    words = text.strip().strip("[]()").replace("²", "^2").replace("**", "^").replace("µ", "u").replace("μ", "u")
    words = words.lower().split(" since ")[0]  # "seconds since 2024-01-01", as netCDF has it
    words = _WORD.sub(lambda word: _LONG[word[1]], words)
    return _SPELLINGS[quantity].get("".join(words.replace("·", "").replace("*", "").split()))


def sized(key: str, quantity: str, text: str) -> tuple[Unit, str | None]:
    """Return the unit that a scenario names at a key of its record, and the file's unit if it sizes that.

    Sizes are such as ``1 g / 2048`` or ``1 g / 100 mV``, for counts or mV. The second is None for one of ``UNITS``
    itself.
    """
    match = _SIZED.fullmatch(text.strip())
    unit = None if match is None else spelled(match[2], quantity)
    if match is None or unit is None or match[2] in _BARE:
        examples = {"acceleration": "1 g / 2048", "rate": "1 deg/s / 16.4", "time": "1 s / 32768"}
        choices = f'choose {" or ".join(UNITS[quantity])}, or the size of a count, such as "{examples[quantity]}"'
        guess = advise(text, UNITS[quantity], listed="")
        raise InputError(f"record.{key}", f"is {shortened(repr(text))}", guess if guess.startswith("did") else choices)
    number, count = float(match[1] or 1), float(match[3] or 1)
    size = number * UNITS[quantity][unit] / count if count else math.inf
    if not 0 < size < math.inf:
        raise InputError(f"record.{key}", f"is {text!r}", "give a size above zero")
    counted = match[1] is not None or match[3] is not None
    return Unit(text.strip() if counted else unit, size), (match[4] or "") if counted else None


def unit_of(
    key: str, quantity: str, declared: str | None, stated: Iterable[tuple[str, str]], *, trust: bool
) -> Unit | None:
    """Return the unit on which the scenario and the file, by column, agree. None if neither says one.

    A unit that gbeam does not know is of use only with its size. With `trust` the scenario's unit holds, whatever the
    file says.
    """
    unit, counts = (None, None) if declared is None else sized(key, quantity, declared)
    if unit is not None and trust:
        return unit
    first = ""
    for column, stated_unit in stated:
        text = (stated_unit or unit_in_name(column)).strip()
        canonical = spelled(text, quantity)
        other_kinds = [kind for kind in _TELLING if kind != quantity and text not in _BARE and spelled(text, kind)]
        # A text that is no known unit counts only if the file states it as a unit, or it is one of another quantity.
        if not text or (canonical is None and not (other_kinds or (stated_unit and text not in _BARE))):
            continue
        if counts is not None and canonical is None:
            if counts and stated_unit and counts.lower() != text.strip("[]()").lower():
                problem = f"is {declared!r}, and the file gives column {column!r} in {text}"
                raise InputError(f"record.{key}", problem, f"give the size of 1 {text}; {_TRUST}")
            unit = None if unit is None else replace(unit, stated=True)
            continue
        problem = f"is {declared or 'missing'}, and the file gives column {column!r} in {text}"
        if canonical is None:
            raise InputError(f"record.{key}", *_unknown(key, quantity, text, problem, other_kinds))
        if first and unit is not None and canonical != unit.text:
            problem = f"is of columns in two units: the file gives {first!r} in {unit.text}, {column!r} in {text}"
            raise InputError(f"record.{key}", problem, f"convert one of them; {_TRUST}")
        if unit is not None and canonical != unit.text:
            raise InputError(f"record.{key}", problem, f'write {key} = "{canonical}"; {_TRUST}')
        unit, first = Unit(canonical, UNITS[quantity][canonical], stated=True), first or column
    return unit


_TRUST = 'if the file is wrong, add skip_checks = ["unit"]'


def _unknown(key: str, quantity: str, text: str, problem: str, other_kinds: list[str]) -> tuple[str, str]:
    """Problem and fix of a unit of another quantity, or of none that is known."""
    if other_kinds and other_kinds != ["signal"]:
        return f"{problem}, of {other_kinds[0]}", f"name another column; {_TRUST}"
    if quantity == "time":
        return f"{problem}, which is no unit of time", 'write time_unit = "s" and skip_checks = ["unit"] if it is in s'
    unit, plain = ("g", text.strip("[]()")) if quantity == "acceleration" else ("deg/s", text.strip("[]()"))
    example = f'such as {key} = "1 {unit} / 100{f" {plain}" if plain.isalpha() else ""}"'
    return f"{problem}, which is no unit of {quantity}", f"give its size, {example}; {_TRUST}"
