"""Checks of single values, shared by all who build objects.

What JAX traces has no value to check: it passes, so that objects can be built under ``grad`` and ``vmap``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from gbeam.arrays.namespace import as_array, is_jax
from gbeam.errors import InputError
from gbeam.printable import shortened


def positive(where: str, value: Any, unit: str, *, zero: bool = False) -> Any:
    """Return `value` as a float if it is finite and positive (or zero, where `zero` allows it)."""
    if is_jax(value):
        return value
    number = _number(where, value, f"give a number in {unit}")
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InputError(
            where, f"is {number:g} {unit}", f"give a {'non-negative' if zero else 'positive'}, finite value"
        )
    return number


def finite(where: str, value: Any) -> Any:
    """Return `value` as a float if it is a finite number."""
    if is_jax(value):
        return value
    number = _number(where, value, "give a number")
    if not math.isfinite(number):
        raise InputError(where, f"is {number}", "give a finite value")
    return number


def array(where: str, value: Any) -> Any:
    """Return `value` as an array of float64 of its own library."""
    try:
        if _holds_text(value):
            raise TypeError(value)
        return as_array(value)
    except (TypeError, ValueError):
        raise InputError(where, f"is {shortened(repr(value))}", "give numbers in SI") from None


def vector(where: str, value: Any) -> Any:
    """Return `value` as an array of three finite numbers."""
    checked = array(where, value)
    if checked.shape != (3,) or not (is_jax(checked) or all(map(math.isfinite, checked))):
        raise InputError(where, f"is {value!r}", "give three finite components, along x, y and z")
    return checked


def _holds_text(value: Any) -> bool:
    """Whether a value is a text, or a list of some: NumPy would read them."""
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
        import difflib

        close = difflib.get_close_matches(str(name), names, n=1)
        guess = f"did you mean {close[0]!r}? " if close else ""
        raise InputError(where, f"is {name!r}", f"{guess}choose one of {', '.join(names)}")
