"""What a file holds of any record whose fields are declared."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from gbeam.io.groups import Group, Variable, coordinate, known, labels, variable, words
from gbeam.results.declared import Declaration, declarations

_NUMBERED = {"mode": (1, "number of the mode"), "coordinate": (0, "axial, along y, along z")}


def group_of(record: Any, over: tuple[str, ...] = (), prefix: str = "") -> Group:
    """Return what a file holds of a record: variables, with the coordinates of their dimensions, and attributes."""
    group = Group()
    for field, each in declarations(type(record)):
        value = getattr(record, field)
        if each.name is None or (value is None and (each.role != "variable" or each.dims)):
            continue
        name, dims = f"{prefix}{each.name or field}", (*over, *each.dims)
        if each.role == "part":
            inner = group_of(value, dims, prefix + each.name)
            _merge(group, Group(known(inner.variables), inner.coordinates, inner.attrs))
        elif each.role == "rows":
            _merge(group, _columns([group_of(row, prefix=prefix + each.name) for row in value], dims))
        elif each.role == "fact":
            group.attrs[name] = _attribute(value)
        elif each.role == "coordinate":
            group.coordinates[dims[-1]] = _variable(dims[-1:], value, each, record)
        elif np.iscomplexobj(value):
            for end, part in (("real", value.real), ("imag", value.imag)):
                group.variables[f"{name}_{end}"] = _variable(dims, part, each, record, f": {end[:4]} part")
        else:
            group.variables[name] = _variable(dims, value, each, record)
    return group


def whole_group(record: Any) -> Group:
    """Return what a file holds of a result, with the coordinates of the dimensions that have none of their own."""
    group = group_of(record)
    every = group.variables.values()
    sizes = {dim: size for each in every for dim, size in zip(each.dims, each.values.shape, strict=True)}
    if "axis" in sizes:
        group.coordinates.update(labels("axis", ["x", "y", "z"]))
    for dim, (first, meaning) in _NUMBERED.items():
        if dim in sizes and dim not in group.coordinates:
            group.coordinates.update(coordinate(dim, np.arange(first, first + sizes[dim]), "1", meaning))
    return group


def in_files(unit: str) -> str:
    """Return a unit as the conventions of netCDF write it: ``m s-2`` of ``m/s^2``, ``1`` where there is none."""
    above, _, below = unit.partition("/")
    divisor = re.sub(r"\^|$", "-", below, count=1) + ("" if "^" in below else "1") if below else ""
    return " ".join(filter(None, (above if above != "1" or not below else "", divisor))) or "1"


def _variable(dims: tuple[str, ...], value: Any, each: Declaration, record: Any, more: str = "") -> Variable:
    if isinstance(value, tuple) and value and isinstance(value[0], str):
        return words(dims, value, each.words)
    values = np.asarray(np.nan if value is None else value)
    if values.dtype == bool:
        values = values.astype(np.int64)
    unit = each.unit if isinstance(each.unit, str) else each.unit(record)
    return variable(dims, values, in_files(unit), f"{each.words}{more}")


def _attribute(value: Any) -> Any:
    if isinstance(value, tuple):
        return np.array(value, dtype=np.int64)
    return int(value) if isinstance(value, bool) else value


def _columns(every: list[Group], dims: tuple[str, ...]) -> Group:
    """One variable of each name along a further dimension; of words, what were attributes."""
    group = Group()
    for name, first in every[0].variables.items() if every else ():
        values = np.stack([each.variables[name].values for each in every])
        group.variables[name] = Variable((*dims, *first.dims), values, first.attrs)
    return group


def _merge(group: Group, other: Group) -> None:
    group.variables.update(other.variables)
    group.coordinates.update(other.coordinates)
    group.attrs.update(other.attrs)
