"""Checks of single values, shared by all who build objects."""

from __future__ import annotations

import math

from gbeam.errors import InputError


def positive(where: str, value: float, unit: str, *, zero: bool = False) -> float:
    """Return `value` as a float if it is finite and positive (or zero, where `zero` allows it)."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(where, f"is {value!r}", f"give a number in {unit}") from None
    if not math.isfinite(number) or number < 0 or (number == 0 and not zero):
        raise InputError(
            where, f"is {number:g} {unit}", f"give a {'non-negative' if zero else 'positive'}, finite value"
        )
    return number
