"""Checks of single values for the constructors of objects; one table of plausible and of possible ranges.

Values that JAX traces pass unchecked, so that objects can be built under ``grad`` and ``vmap``. An implausible value
is computed with, and a warning names the unit that was probably meant; an impossible one, with which nothing can be
computed, is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from gbeam.arrays.namespace import as_array, is_jax, is_traced
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.printable import closest, shortened


def positive(where: str, value: Any, unit: str, *, zero: bool = False) -> Any:
    """Return `value` as a float; InputError unless it is finite and positive, or zero with `zero`."""
    if is_jax(value):
        return value
    number = _number(where, value, f"give a number in {unit}")
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InputError(
            where, f"is {number:g} {unit}", f"give a {'non-negative' if zero else 'positive'}, finite value"
        )
    return number


def damping_ratios(where: str, value: Any) -> None:
    """Raise InputError unless a ratio of critical damping, or each of several, is from 0 up to, but not, 1."""
    ratios = as_array(value)
    for i, ratio in enumerate(ratios.ravel()):
        if not 0 <= ratio < 1:
            place = f"{where}[{i}]" if ratios.ndim else where
            raise InputError(place, f"is {ratio:g}", "give a ratio of critical damping from 0 up to 1, such as 0.01")


def finite(where: str, value: Any) -> Any:
    """Return `value` as a float; InputError unless it is a finite number."""
    if is_jax(value):
        return value
    number = _number(where, value, "give a number")
    if not math.isfinite(number):
        raise InputError(where, f"is {number}", "give a finite value")
    return number


def array(where: str, value: Any) -> Any:
    """Return `value` as an array of float64, of JAX if it is JAX's; InputError for texts."""
    try:
        if _holds_text(value):
            raise TypeError(value)
        return as_array(value)
    except (TypeError, ValueError):
        raise InputError(where, f"is {shortened(repr(value))}", "give numbers in SI") from None


def refuse_traced(where: str, value: Any, reason: str) -> None:
    """Raise InputError, with the reason, if JAX traces a number."""
    if is_traced(value):
        raise InputError(where, f"is traced by JAX, and {reason}", "give a number")


def vector(where: str, value: Any) -> Any:
    """Return `value` as an array of three finite numbers; InputError otherwise."""
    checked = array(where, value)
    if checked.shape != (3,) or not (is_jax(checked) or all(map(math.isfinite, checked))):
        raise InputError(where, f"is {value!r}", "give three finite components, along x, y and z")
    return checked


def _holds_text(value: Any) -> bool:
    """True for a text, or a list with texts, which NumPy would convert to numbers."""
    return isinstance(value, str) or (isinstance(value, (list, tuple)) and any(map(_holds_text, value)))


def _number(where: str, value: Any, fix: str) -> float:
    try:
        if _holds_text(value):
            raise TypeError(value)
        return float(value)
    except (TypeError, ValueError):
        raise InputError(where, f"is {value!r}", fix) from None


def choice(where: str, name: str, choices: Iterable[str]) -> None:
    """Raise InputError unless the name is one of the choices."""
    names = tuple(choices)
    if name not in names:
        spelling = closest(str(name), names)
        guess = f"did you mean {spelling!r}? " if spelling else ""
        raise InputError(where, f"is {name!r}", f"{guess}choose one of {', '.join(names)}")


def index_of(where: str, name: str, names: Sequence[str]) -> int:
    """Return the index of a name in `names`; InputError if it is not among them."""
    if name not in names:
        raise InputError(where, f"is {name!r}", f"choose from {', '.join(names)}")
    return names.index(name)


@dataclass(frozen=True)
class Range:
    """Plausible values of a quantity."""

    low: float  # plausible, in `unit`
    high: float  # likewise
    least: float  # possible
    most: float  # likewise
    unit: str  # SI
    slips: tuple[tuple[str, float], ...] = ()  # units, with sizes, in which a number may have been meant


_LENGTHS = (("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6), ("m", 1.0))
_PRESSURES = (("GPa", 1e9), ("MPa", 1e6))
RANGES = {
    "length": Range(1e-3, 200.0, 1e-9, 1e9, "m", _LENGTHS),
    "section": Range(1e-6, 5.0, 1e-12, 1e6, "m", _LENGTHS),  # a dimension of it
    "area": Range(1e-10, 10.0, 1e-24, 1e12, "m^2", (("mm^2", 1e-6), ("cm^2", 1e-4))),
    "second moment": Range(1e-20, 10.0, 1e-48, 1e24, "m^4", (("mm^4", 1e-12), ("cm^4", 1e-8))),
    "density": Range(10.0, 3e4, 1e-15, 1e15, "kg/m^3", (("g/cm^3", 1e3), ("t/mm^3", 1e12))),
    "modulus": Range(1e5, 2e12, 1e-9, 1e24, "Pa", _PRESSURES),
    "strength": Range(1e5, 2e10, 1e-9, 1e24, "Pa", _PRESSURES),
    "shear coefficient": Range(0.05, 1.2, 1e-6, 1e3, ""),
    "damping": Range(0.0, 0.3, 0.0, 1.0, "", (("%", 1e-2),)),
    "radius": Range(0.0, 200.0, 0.0, 1e9, "m", _LENGTHS),
    "arm": Range(0.02, 100.0, 1e-9, 1e9, "m", _LENGTHS),
    "gravity": Range(1.2, 30.0, 0.0, 1e9, "m/s^2", (("g", STANDARD_GRAVITY),)),
    "acceleration": Range(0.0, 1e5, 0.0, 1e12, "m/s^2", (("mm/s^2", 1e-3),)),
    "rate": Range(0.0, 3e3, 0.0, 1e9, "rad/s", (("deg/s", 0.017453292519943295), ("rpm", 0.10471975511965977))),
    "duration": Range(1e-5, 1e5, 1e-12, 1e9, "s", (("ms", 1e-3), ("us", 1e-6))),
    "step": Range(1e-8, 1e3, 1e-12, 1e9, "s", (("ms", 1e-3), ("s", 1.0))),
}


def implausible(where: str, kind: str, value: Any) -> tuple[str, ...]:
    """Return a tuple with a warning of a value outside the plausible range, or empty if it is plausible."""
    limits = RANGES[kind]
    if is_jax(value) or limits.low <= abs(value) <= limits.high:
        return ()
    range_words = f"{_figures(limits.low)} to {_figures(limits.high)} {limits.unit}".rstrip()
    slip = _slip(limits, float(value))
    advice = f"did you mean {slip}?" if slip else "is its unit right?"
    return (f"{where} is {float(value):g} {limits.unit}".rstrip() + f", outside the plausible {range_words}; {advice}",)


def possible(where: str, kind: str, value: Any) -> None:
    """Raise InputError if a value is outside the range that can be computed with."""
    limits = RANGES[kind]
    if is_jax(value) or limits.least <= abs(value) <= limits.most:
        return
    slip = _slip(limits, float(value))
    fix = f"give {_figures(limits.least)} to {_figures(limits.most)} {limits.unit}".rstrip()
    raise InputError(where, f"is {float(value):g} {limits.unit}".rstrip(), f"did you mean {slip}?" if slip else fix)


def _slip(limits: Range, value: float) -> str:
    """Value as text in the first other unit in which it would be plausible, or empty if there is none."""
    for unit, size in limits.slips:
        if unit != limits.unit and limits.low < abs(value) * size <= limits.high:
            return f"{value:g} {unit}"
    return ""


def _figures(value: float) -> str:
    return f"{value:g}"
