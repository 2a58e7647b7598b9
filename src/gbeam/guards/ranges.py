"""Ranges of plausible and of possible values: one table, and the slip of a unit that an implausible one looks like.

An implausible value is computed with and warned of; an impossible one, with which nothing can be computed, is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gbeam.arrays.namespace import is_jax
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError


@dataclass(frozen=True)
class Range:
    """Plausible values of a quantity.

    Parameters
    ----------
    low, high : float
        What is plausible, in `unit`.
    least, most : float
        What is possible.
    unit : str
        SI.
    slips : tuple of (unit, size)
        Units in which a number may have been meant that was given without one, or with a wrong one.
    """

    low: float
    high: float
    least: float
    most: float
    unit: str
    slips: tuple[tuple[str, float], ...] = ()


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
    """A warning, or none."""
    limits = RANGES[kind]
    if is_jax(value) or limits.low <= abs(value) <= limits.high:
        return ()
    between = f"{_number(limits.low)} to {_number(limits.high)} {limits.unit}".rstrip()
    slip = _slip(limits, float(value))
    advice = f"did you mean {slip}?" if slip else "is its unit right?"
    return (f"{where} is {float(value):g} {limits.unit}".rstrip() + f", outside the plausible {between}; {advice}",)


def possible(where: str, kind: str, value: Any) -> None:
    """Raise InputError where nothing can be computed with a value."""
    limits = RANGES[kind]
    if is_jax(value) or limits.least <= abs(value) <= limits.most:
        return
    slip = _slip(limits, float(value))
    fix = f"give {_number(limits.least)} to {_number(limits.most)} {limits.unit}".rstrip()
    raise InputError(where, f"is {float(value):g} {limits.unit}".rstrip(), f"did you mean {slip}?" if slip else fix)


def _slip(limits: Range, value: float) -> str:
    """Number in the first other unit in which it is plausible; empty where there is none."""
    for unit, size in limits.slips:
        if unit != limits.unit and limits.low < abs(value) * size <= limits.high:
            return f"{value:g} {unit}"
    return ""


def _number(value: float) -> str:
    return f"{value:g}"
