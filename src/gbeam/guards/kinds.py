"""Kinds of quantity of scenarios and of arguments of public functions, and their most frequent units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import unwrap
from typing import Any, TypeVar

from gbeam.constants import DEGREE, RPM, STANDARD_GRAVITY


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its name in a sentence, its SI unit and an example."""

    phrase: str  # with its article, "a length"
    unit: str  # SI, of bare numbers
    example: str  # a quantity as one would write it
    rate: str = ""  # kind of its rate of change, of what profiles are given


KINDS: dict[str, Kind] = {
    "length": Kind("a length", "m", "20 mm"),
    "area": Kind("an area", "m^2", "80 mm^2"),
    "second moment of area": Kind("a second moment of area", "m^4", "8219 mm^4"),
    "mass": Kind("a mass", "kg", "0.1 kg"),
    "density": Kind("a density", "kg/m^3", "2700 kg/m^3"),
    "moment of inertia": Kind("a moment of inertia", "kg m^2", "200 kg m^2"),
    "pressure": Kind("a pressure", "Pa", "70 GPa"),
    "force": Kind("a force", "N", "5 N", "force rate"),
    "force rate": Kind("a rate of force", "N/s", "10 N/s"),
    "force per length": Kind("a force per length", "N/m", "20 N/m", "force per length rate"),
    "force per length rate": Kind("a rate of force per length", "N/m/s", "20 N/m/s"),
    "stiffness": Kind("a stiffness", "N/m", "1e6 N/m"),
    "rotational stiffness": Kind("a rotational stiffness", "N m/rad", "5000 N m/rad"),
    "damping": Kind("a damping", "N s/m", "50 N s/m"),
    "rotational damping": Kind("a rotational damping", "N m s/rad", "2 N m s/rad"),
    "torque": Kind("a torque", "N m", "200 N m", "torque rate"),
    "torque rate": Kind("a rate of torque", "N m/s", "10 N m/s"),
    "time": Kind("a time", "s", "16 s"),
    "speed": Kind("a speed", "m/s", "3 m/s", "acceleration"),
    "acceleration": Kind("an acceleration", "m/s^2", "6 g", "jerk"),
    "jerk": Kind("a jerk", "m/s^3", "4 g/s"),
    "angle": Kind("an angle", "rad", "30 deg"),
    "angular rate": Kind("an angular rate", "rad/s", "3 rad/s", "angular acceleration"),
    "angular acceleration": Kind("an angular acceleration", "rad/s^2", "1 rad/s^2"),
    "angular jerk": Kind("an angular jerk", "rad/s^3", "10 rad/s^3"),
    "power": Kind("a power", "W", "50 kW"),
    "frequency": Kind("a frequency", "1/s", "20 Hz"),
    "temperature": Kind("a temperature", "K", "20 degC", "temperature rate"),
    "temperature rate": Kind("a rate of temperature", "K/s", "0.1 K/s"),
    "expansion": Kind("an expansion per kelvin", "1/K", "23e-6 1/K"),
    "ratio": Kind("a ratio", "", "1 %"),
    "amplitude ratio": Kind("a ratio of amplitudes", "", "3 dB"),
}

# Importing pint takes longer than reading a whole scenario. These units, and each kind's SI unit, are read without it;
# tests/scenario/test_units.py holds them against pint's answers.
USUAL: dict[str, dict[str, float]] = {
    "length": {"km": 1e3, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6},
    "area": {"cm^2": 1e-4, "mm^2": 1e-6},
    "second moment of area": {"cm^4": 1e-8, "mm^4": 1e-12},
    "mass": {"g": 1e-3},
    "density": {"g/cm^3": 1e3},
    "pressure": {"kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "force": {"kN": 1e3},
    "force per length": {"kN/m": 1e3},
    "expansion": {"ppm/K": 1e-6},
    "stiffness": {"kN/m": 1e3, "N/mm": 1e3},
    "torque": {"kN m": 1e3},
    "time": {"ms": 1e-3, "min": 60.0},
    "acceleration": {"g": STANDARD_GRAVITY},
    "jerk": {"g/s": STANDARD_GRAVITY},
    "angle": {"deg": DEGREE},
    "angular rate": {"rpm": RPM, "deg/s": DEGREE, "Hz": 6.283185307179586},
    "angular acceleration": {"deg/s^2": DEGREE},
    "power": {"kW": 1e3},
    "frequency": {"Hz": 1.0},
    "ratio": {"%": 0.01},
    "amplitude ratio": {"%": 0.01},
}

# Of an argument, or of what it holds: by key, or at any, "*", or in order. They may follow from the other arguments.
Kinds = str | Mapping[str, "Kinds"] | tuple[str, ...]
Declared = Kinds | Callable[[Mapping[str, Any]], Kinds]
WRITTEN = "as written"  # of a scenario's value, which has the kind of its place there
PLAIN = "plain"  # of numbers that have no unit, such as the coordinates of a model

T = TypeVar("T", bound=Callable[..., Any])


def kinds(**derived: Declared) -> Callable[[T], T]:
    """Declare kinds of arguments that their annotations cannot say: by key, in order, or by the other arguments."""

    def declare(declaring: T) -> T:
        unwrap(declaring).__kinds__ = derived
        return declaring

    return declare


def element_kinds(kinds: Kinds, key: Any) -> Kinds:
    """Return the kinds of the element at a key or index of an argument of these kinds."""
    if isinstance(kinds, Mapping) and isinstance(key, str):
        return kinds.get(key, kinds.get("*", ""))
    return kinds[key] if isinstance(kinds, tuple) and key in range(len(kinds)) else common_kind(kinds)


def common_kind(kinds: Kinds) -> str:
    """Return the kind that all elements have, or empty if they differ."""
    if isinstance(kinds, str):
        return kinds
    elements = kinds.values() if isinstance(kinds, Mapping) else kinds
    common = {common_kind(element) for element in elements}
    return common.pop() if len(common) == 1 else ""
