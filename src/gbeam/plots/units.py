"""The unit that suits a size: metres for the tip of a long blade, millimetres for a specimen's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.results.result import Floats


class Unit(NamedTuple):
    """A unit of a figure's axis: values there are `factor` times the SI values."""

    factor: float
    name: str


# From this SI size on, ascending; the second is for what is zero.
_UNITS = {
    "length": ((0.0, Unit(1e6, "µm")), (1e-4, Unit(1e3, "mm")), (1.0, Unit(1.0, "m"))),
    "force": ((0.0, Unit(1e3, "mN")), (0.1, Unit(1.0, "N")), (1e4, Unit(1e-3, "kN"))),
    "moment": ((0.0, Unit(1e3, "mN m")), (0.01, Unit(1.0, "N m")), (1e4, Unit(1e-3, "kN m"))),
    "stress": ((0.0, Unit(1e-3, "kPa")), (1e5, Unit(1e-6, "MPa"))),
    "acceleration": ((0.0, Unit(1.0, "m/s²")), (0.5 * STANDARD_GRAVITY, Unit(1 / STANDARD_GRAVITY, "g0"))),
}  # fmt: skip


_READABLE = (0.01, 1e4)  # beyond it a power of ten goes to the axis


def unit_for(kind: str, *values: Floats) -> Unit:
    """Return the unit in which the largest of some values reads well."""
    units = _UNITS[kind]
    size = max((largest(each) for each in values), default=0.0)
    if size == 0:
        return units[1][1]
    return [unit for start, unit in units if size >= start][-1]


def largest(values: Floats) -> float:
    """Return the largest finite size; zero where there is none."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def not_drawn(shown: Sequence[int], *lengths: Floats) -> str:
    """A line about the components (of the last axis) of lengths that are not shown: how large they are; or nothing."""
    sizes = [max(largest(each[..., i]) for each in lengths) for i in range(3)]
    words = []
    for i, size in enumerate(sizes):
        if i not in shown and size > 1e-9 * max(sizes):
            unit = unit_for("length", np.array(size))
            words.append(f"{'xyz'[i]} by {unit.factor * size:.2g} {unit.name}")
    return f"\n(not drawn: {' and '.join(words)} at most)" if words else ""


def scaled_label(name: str, unit: str, values: Floats) -> tuple[int, str]:
    """A power of ten, of three, that makes small and large values readable, and the label of an axis in that unit."""
    size = float(np.nanmax(np.abs(values), initial=0.0, where=np.isfinite(values)))
    low, high = _READABLE
    power = 0 if size == 0 or low <= size < high else 3 * math.floor(math.log10(size) / 3)
    prefix = {-9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G"}.get(power)
    if power and unit and prefix and not unit.startswith(("k", "m/")):
        return power, f"{name}, {prefix}{unit}"
    return power, f"{name}{f', {unit}' if unit else ''}" + (f" × 10^{power}" if power else "")
