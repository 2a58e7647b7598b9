"""Numbers with a unit, such as pint's, are refused: NumPy would take 20 mm for 20."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gbeam.arrays.namespace import has_unit
from gbeam.errors import InputError
from gbeam.printable import shortened

_BARE = frozenset({float, int, bool, complex, str, bytes, type(None)})


def refuse_units(where: str, value: Any) -> None:
    """Raise InputError if a value, or what a list or a mapping holds, is a number with a unit."""
    if type(value) in _BARE:
        return
    if has_unit(value):
        raise InputError(where, f"is {shortened(str(value), 60)}", f"give numbers without a unit, in SI{_in_si(value)}")
    listed = value.tolist() if getattr(getattr(value, "dtype", None), "kind", "") == "O" else value
    if isinstance(listed, Mapping):
        parts = {f"{where}[{key!r}]": each for key, each in listed.items()}
    elif isinstance(listed, (list, tuple, set)) and not _BARE.issuperset(map(type, listed)):
        parts = {f"{where}[{i}]": each for i, each in enumerate(listed)}
    else:
        return
    for place, each in parts.items():
        refuse_units(place, each)


def _in_si(value: Any) -> str:
    """How pint makes a number in SI of a quantity of its own; empty of another library's."""
    try:
        unit = f"{value.to_base_units().units:~}" or "dimensionless"
    except (AttributeError, ValueError):
        return ""
    hertz = "; 1 Hz is 6.2832 rad/s as an angular rate" if unit == "1 / s" else ""
    return f': .to("{unit}").magnitude{hertz}'
