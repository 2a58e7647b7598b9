"""The unit that suits a size: metres for the tip of a long blade, millimetres for a specimen's."""

from __future__ import annotations

import math
import re

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.results.result import Floats

# By the SI unit: size from which on, factor, name; ascending, and the second is for what is zero.
_UNITS = {
    "m": ((0.0, 1e6, "µm"), (1e-4, 1e3, "mm"), (1.0, 1.0, "m")),
    "N": ((0.0, 1e3, "mN"), (0.1, 1.0, "N"), (1e4, 1e-3, "kN")),
    "N m": ((0.0, 1e3, "mN m"), (0.01, 1.0, "N m"), (1e4, 1e-3, "kN m")),
    "Pa": ((0.0, 1e-3, "kPa"), (1e5, 1e-6, "MPa")),
    "m/s^2": ((0.0, 1.0, "m/s²"), (0.5 * STANDARD_GRAVITY, 1 / STANDARD_GRAVITY, "g0")),
}
_READABLE = (0.01, 1e4)  # beyond it a power of ten goes to the axis
_EXPONENTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def scale_of(si: str, *values: Floats | float) -> tuple[float, str]:
    """Factor and name of the unit in which the largest of some values in an SI unit reads well."""
    units = _UNITS[si]
    size = max((largest(np.asarray(each)) for each in values), default=0.0)
    chosen = units[1] if size == 0 else [unit for unit in units if size >= unit[0]][-1]
    return chosen[1:]


def largest(values: Floats) -> float:
    """Return the largest finite size; zero where there is none."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def raised(unit: str) -> str:
    """A unit with its exponents as they are printed, rad/s² for rad/s^2."""
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(_EXPONENTS), unit)


def scaled(name: str, unit: str, values: Floats) -> tuple[float, str]:
    """A factor of a power of ten, of three, that makes values readable, and the label of an axis in that unit."""
    low, high = _READABLE
    size, unit = largest(values), raised(unit)
    power = 0 if size == 0 or low <= size < high else 3 * math.floor(math.log10(size) / 3)
    prefix = {-9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G"}.get(power)
    if power and unit and prefix and not unit.startswith(("k", "m/")):
        return 10.0**-power, ", ".join(filter(None, (name, f"{prefix}{unit}")))
    return 10.0**-power, ", ".join(filter(None, (name, unit))) + (f" × 10^{power}" if power else "")
