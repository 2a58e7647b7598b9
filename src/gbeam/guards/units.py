"""Quantities as text: "300 mm", "15 g/s", "60 rpm". One small registry, in which angle is a dimension.

pint's default registry takes 1 Hz for 1 rad/s and `g` for a gram everywhere, and lets an angle pass for
a number. The parser is pint's, the registry is gbeam's.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError
from gbeam.guards.kinds import KINDS, PLAIN, USUAL, WRITTEN, Kind, Kinds, common_kind, element_kinds
from gbeam.guards.limits import QUANTITY
from gbeam.printable import closest, shortened

if TYPE_CHECKING:
    from pint import UnitRegistry

# `gee` is what a bare `g` becomes where an acceleration is expected.
_DEFINITIONS = """
nano- = 1e-9 = n-
micro- = 1e-6 = µ- = μ- = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-

meter = [length] = m = metre
gram = [mass] = g
second = [time] = s = sec
kelvin = [temperature] = K
radian = [angle] = rad
percent = 0.01 = %
ppm = 1e-6

minute = 60 * second = min
hour = 60 * minute = h
degree = 0.017453292519943295 * radian = deg = °
revolution = 6.283185307179586 * radian = rev
rpm = revolution / minute
hertz = revolution / second = Hz
gee = 9.80665 * meter / second ** 2 = g0 = g_0
newton = kilogram * meter / second ** 2 = N
pascal = newton / meter ** 2 = Pa
watt = newton * meter / second = W
inch = 0.0254 * meter = in
foot = 12 * inch = ft
pound = 453.59237 * gram = lb
pound_force = pound * gee = lbf
psi = pound_force / inch ** 2
ksi = 1000 * psi
Msi = 1000000 * psi
"""
# Units that a misspelt one is compared with: the usual spellings, not every prefix of every unit.
_SPELLINGS = """
m mm cm km µm um g kg mg s ms us min h rad mrad deg rev rpm Hz kHz g0 N kN MN W kW MW Pa kPa MPa GPa in ft lb lbf
psi ksi Msi % ppm K watt meter metre millimeter gram kilogram second millisecond minute hour radian degree revolution
hertz newton pascal inch foot pound percent
"""
CELSIUS, ICE = ("degC", "°C"), 273.15  # names of the degree Celsius, and its zero in K
BEGINNING = re.compile(r"\s*+(?:[+-]\s*+)?(\.?\d|inf|nan)", re.IGNORECASE)  # of a text that gives a number: 20 mm
# A number and what follows it: its unit, or nothing.
NUMBER = re.compile(r"\s*+([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*+((?:.*\S)?)\s*", re.DOTALL)
# pint's tokenizer drops what it does not know ("5 m$", "5 m # note"), so the letters are checked first.
_UNIT = re.compile(r"[\w°%()*/^+\-·.⁻⁰¹²³⁴-⁹ ]+")

# Powers that would take for ever to work out: any power but by one digit, a power of a power, two superscripts.
_POWER = re.compile(r"(?:\^|\*\*)(?!\s*+(?:[+-]\s*+)?[0-9](?![0-9.eE_]|\s*(?:\^|\*\*)))|[⁰¹²³⁴-⁹]{2}")


class UnitError(ValueError):
    """A quantity that cannot be read: `problem` says what is wrong with it, `hint` what would be right."""

    def __init__(self, problem: str, hint: str = "") -> None:
        self.problem, self.hint = problem, hint
        super().__init__(f"{problem}; {hint}" if hint else problem)


def quantity(value: object, kind: str) -> float:
    """Return a number, or a text with a unit, as a float in SI; UnitError unless it is of that kind and finite."""
    expected = KINDS[kind]
    such_as = f'{expected.phrase}, such as "{expected.example}"'
    # bool is an int to Python, a mistake to the reader of a scenario.
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            value_words = shortened(f"{value!r}")
        except ValueError:  # too many digits to write
            value_words = "the number"
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    elif isinstance(value, str):
        value_words = f'"{shortened(value)}"'
        if len(value) > QUANTITY:
            raise UnitError(f"{value_words} has {len(value)} characters", f"expected {such_as}")
        match = NUMBER.fullmatch(value)
        if match is None:
            raise UnitError(f"{value_words} is not a number with a unit", f"expected {such_as}")
        number, unit = float(match[1]), match[2]
        if not unit:
            raise UnitError(f"{value_words} has no unit", _no_unit(match[1], expected))
        try:
            if unit == "dB" and kind == "amplitude ratio":
                number = math.inf if number > 6000 else 10.0 ** (number / 20)
            elif unit in CELSIUS and kind == "temperature":
                number += ICE
            else:
                number *= _factor(unit, kind)
        except UnitError as error:
            raise UnitError(f"{value_words} {error.problem}", error.hint) from None
    else:
        raise UnitError(f"{spoken(value)} is not a number", f"expected {such_as}")
    if not math.isfinite(number):
        raise UnitError(f"{value_words} is not finite", f"expected {such_as}")
    return number


def in_si(where: str, value: Any, kinds: Kinds) -> Any:
    """Return a value, list or mapping in which texts that begin with a number, and pint's quantities, are in SI.

    Raises InputError if one is of another kind. All else stays as it is.
    """
    if isinstance(value, dict):
        return {key: in_si(f"{where}.{key}", element, element_kinds(kinds, key)) for key, element in value.items()}
    if isinstance(value, (list, tuple)):
        parts = [in_si(f"{where}[{i}]", element, element_kinds(kinds, i)) for i, element in enumerate(value)]
        unchanged = all(part is element for part, element in zip(parts, value, strict=True))
        return value if unchanged else type(value)(parts)
    kind = common_kind(kinds)
    if kind in ("", PLAIN):
        return value
    if getattr(getattr(value, "dtype", None), "kind", "") == "U":
        listed = value.tolist()
        numbers = in_si(where, listed, kind)
        return value if numbers is listed else numbers
    try:
        if isinstance(value, str):
            return quantity(value, kind) if kind != WRITTEN and BEGINNING.match(value) else value
        if hasattr(value, "magnitude") and hasattr(value, "dimensionality"):  # of pint
            return _of_pint(value, kind)
    except UnitError as error:
        raise InputError(where, error.problem, error.hint) from None
    return value


def _of_pint(value: Any, kind: str) -> Any:
    """Return a quantity of pint as a number in SI, or, for the kind WRITTEN, as text of a scenario."""
    unit, number = re.sub(r"\bg\b", "gram", f"{value.units:~P}"), value.magnitude
    if kind == WRITTEN:
        texts = [f"{float(entry)!r} {unit}".strip() for entry in getattr(number, "flat", [number])]
        return texts if getattr(number, "ndim", 0) else texts[0]
    if not unit and not KINDS[kind].unit:
        return number
    if isinstance(number, (int, float)):
        return quantity(f"{float(number)!r} {unit}", kind)
    return number * quantity(f"1 {unit}", kind)


def argument(text: str, kind: str) -> float:
    """Read a quantity of the command line in SI: ``60 rpm``, or a bare number such as ``2.5``, which is in SI."""
    match = NUMBER.fullmatch(text) if len(text) <= QUANTITY else None
    return quantity(float(text) if match and not match[2] else text, kind)


def read_quantity(where: str, text: str, kind: str, prefix: str = "") -> float:
    """Read a quantity of the command line in SI; the problem of an InputError at `where` begins with `prefix`."""
    try:
        return argument(text, kind)
    except UnitError as error:
        raise InputError(where, f"{prefix}{error.problem}", error.hint or "write a number with its unit") from None


def unit_of(text: str, kind: str) -> tuple[str, float]:
    """Return the unit of a quantity and its size in SI: rpm and 2π/60 for ``60 rpm``; the SI unit of a bare number."""
    match = NUMBER.fullmatch(text)
    unit = (match[2] if match else "") or KINDS[kind].unit
    return unit, _factor(unit, kind)


def spoken(value: object) -> str:
    """Return a value of the wrong type in the words of a scenario: ``true``, ``'text'``, ``1.5``, ``a list``."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float, str)):
        return shortened(repr(value))
    names = {list: "a list", dict: "a table", type(None): "null"}
    return names.get(type(value), f"a {type(value).__name__}")


def _no_unit(number: str, expected: Kind) -> str:
    if not expected.unit:
        return f"write the bare number {number}, without quotes"
    return f'add a unit, such as "{expected.example}", or write the bare number {number} for {expected.unit}'


def _factor(unit: str, kind: str) -> float:
    """SI value of one `unit` read as a `kind`; UnitError if it is not one."""
    if unit == KINDS[kind].unit:
        return 1.0
    usual = USUAL.get(kind, {}).get(unit)
    return parsed_factor(unit, kind) if usual is None else usual


@cache
def parsed_factor(unit: str, kind: str) -> float:
    """SI value of one `unit` read as a `kind`, by pint's parser; UnitError if it is not one."""
    from pint import UndefinedUnitError

    expected = KINDS[kind]
    registry = _registry()
    unreadable = UnitError(f"has the unreadable unit {unit!r}", f'write it such as "{expected.example}"')
    if not _UNIT.fullmatch(unit) or _POWER.search(unit):
        raise unreadable
    # The same letter is two units: of a mass, except where only an acceleration makes sense.
    text = re.sub(r"\bg\b", "gee", unit) if kind in ("acceleration", "jerk") else unit
    try:
        # "60 1/min": parse_units takes no number in front, parse_expression takes any.
        parsed = registry.parse_units(re.sub(r"^1\s*/", "dimensionless/", text))
    except UndefinedUnitError as error:
        names = error.unit_names
        name = names if isinstance(names, str) else next(iter(names))
        suggestion = _meant(name, text, kind)
        hint = (
            f"did you mean {suggestion!r}?"
            if suggestion
            else f'expected {expected.phrase}, such as "{expected.example}"'
        )
        raise UnitError(f"has the unknown unit {name!r}", hint) from None
    except Exception:  # pint's parser lets tokenizer, syntax, type and value errors through
        raise unreadable from None
    try:
        return _converted(registry.Quantity(1.0, parsed), kind, expected)
    except UnitError:
        raise
    except (ArithmeticError, ValueError):  # beyond what a float holds
        raise unreadable from None


def _meant(name: str, unit: str, kind: str) -> str | None:
    """Usual spelling that an unknown unit `name` in `unit` was probably meant to be, or None if none gives the kind."""
    registry = _registry()

    def makes_the_kind(spelling: str) -> bool:
        try:
            parsed = registry.parse_units(re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", spelling, unit))
            return bool(_converted(registry.Quantity(1.0, parsed), kind, KINDS[kind]))
        except Exception:  # as in parsed_factor
            return False

    def mistyped(spelling: str) -> int:
        return sum(a != b for a, b in zip(name.lower(), spelling.lower(), strict=True))

    for corrected in (re.sub("([2-4])$", r"^\1", name), re.sub("N(m+)$", r"N \1", name)):  # mm2, kNm
        if corrected != name and makes_the_kind(corrected):
            return corrected
    fitting = [spelling for spelling in _SPELLINGS.split() if makes_the_kind(spelling)]
    as_long = [spelling for spelling in fitting if len(spelling) == len(name) > 1 and mistyped(spelling) <= 1]
    return min(as_long, key=mistyped, default=None) or closest(name, fitting)


def _converted(amount: Any, kind: str, expected: Kind) -> float:
    """Number in SI of an amount of pint's; UnitError if it is of another kind."""
    registry = _registry()
    if kind == "frequency" and amount.dimensionality == registry.parse_units("rad/s").dimensionality:
        return float(amount.to("hertz").magnitude)
    if amount.dimensionality != registry.parse_units(expected.unit).dimensionality:
        raise UnitError(
            _dimension_words(amount.dimensionality), f'expected {expected.phrase}, such as "{expected.example}"'
        )
    return float(amount.to(expected.unit or "dimensionless").magnitude)


@cache
def _registry() -> UnitRegistry[Any]:
    from pint import UnitRegistry

    return UnitRegistry(_DEFINITIONS.strip().splitlines())


def _dimension_words(dimensionality: Any) -> str:
    """Return words for a dimension, such as ``is a mass``, for a message."""
    registry = _registry()
    for kind in KINDS.values():
        if registry.parse_units(kind.unit).dimensionality == dimensionality:
            return f"is {kind.phrase}"
    return f"has the dimension {dimensionality}"
