"""Parts of a file or an xarray Dataset: variables with dimensions, units and frames, before either is there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

BASE_AXES = "B: base axes at the root, x along the beam, y along its width, z through its thickness"


class Variable(NamedTuple):
    """Dimensions, values (numbers, or text), and attributes, which are text or numbers."""

    dims: tuple[str, ...]
    values: Any
    attrs: dict[str, Any]


@dataclass(frozen=True)
class Group:
    """Variables, coordinates and attributes of one result."""

    variables: dict[str, Variable] = field(default_factory=dict)
    coordinates: dict[str, Variable] = field(default_factory=dict)  # each is named as its dimension
    attrs: dict[str, Any] = field(default_factory=dict)


def variable(dims: tuple[str, ...], values: Any, units: str, long_name: str, **more: Any) -> Variable:
    """Return a variable; one along the dimension ``axis`` holds components in base axes, and says so."""
    frame = {"frame": BASE_AXES} if "axis" in dims else {}
    return Variable(dims, np.asarray(values), {"units": units, "long_name": long_name} | frame | more)


def words(dims: tuple[str, ...], values: Any, long_name: str) -> Variable:
    """Return a variable of text."""
    return Variable(dims, np.array(values, dtype=object), {"long_name": long_name})


def flags(dims: tuple[str, ...], values: Any, long_name: str, no: str, yes: str) -> Variable:
    """Return a variable of truth values; netCDF has none, so they are numbers with meanings."""
    meanings = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": f"{no} {yes}"}
    return variable(dims, np.asarray(values).astype(np.int8), "1", long_name, **meanings)


def coordinate(name: str, values: Any, units: str, long_name: str) -> dict[str, Variable]:
    """Return a numeric coordinate along its own dimension, by name."""
    return {name: variable((name,), values, units, long_name)}


def labels(name: str, values: list[str] | tuple[str, ...]) -> dict[str, Variable]:
    """Return a coordinate of text along its own dimension, by name."""
    return {name: Variable((name,), np.array(values, dtype=object), {})}


def thinned(group: Group, every: int) -> Group:
    """The group with one of so many samples of its histories, and with words that say so."""
    if every == 1:
        return group

    def some(of: dict[str, Variable]) -> dict[str, Variable]:
        cuts = {name: tuple(slice(None, None, every if dim == "time" else 1) for dim in of[name].dims) for name in of}
        return {
            name: each._replace(values=np.ascontiguousarray(each.values[cuts[name]])) if "time" in each.dims else each
            for name, each in of.items()
        }

    count = len(group.coordinates["time"].values)
    said = {"histories": f"one of {every} samples, of {count}; peaks, errors and comparisons are of all"}
    return Group(some(group.variables), some(group.coordinates), group.attrs | said | {"histories_every": every})


def known(variables: dict[str, Variable]) -> dict[str, Variable]:
    """The variables but those of which no value is known: a file has no column of nothing."""
    return {name: each for name, each in variables.items() if not _unknown(each.values)}


def known_attrs(attrs: dict[str, Any]) -> dict[str, Any]:
    """The attributes but those of which no value is known."""
    return {name: value for name, value in attrs.items() if isinstance(value, str) or not _unknown(np.asarray(value))}


def _unknown(values: Any) -> bool:
    return values.dtype.kind == "f" and values.size > 0 and bool(np.isnan(values).all())
