"""Layout of files: groups of variables with dimensions, units and frames, of any record whose fields are declared."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from gbeam.results.declared import BESIDE, INSIDE, Declaration, declarations
from gbeam.results.facts import unknown

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


_LABELLED = {
    "axis": ["x", "y", "z"],
    "side": ["low", "high"],
    "form": ["kinetic", "elastic", "gravity"],
    "euler": ["e0", "e1", "e2", "e3"],
}
_NUMBERED = {
    "machine_axis": (1, "axis of the centrifuge"),
    "mode": (1, "number of the mode"),
    "coordinate": (0, "axial, along y, along z"),
}


def name_of(key: str, each: Declaration, pattern: str) -> str:
    """Name of a field in files, of a record whose names have a pattern."""
    before, _, after = pattern.partition("*")
    return before.rstrip("_") if each.name == INSIDE else f"{before}{each.name or key}{after}".rpartition("/")[2]


def pattern_of(each: Declaration, pattern: str) -> str:
    """Pattern of the names of a part in files."""
    assert each.name is not None
    return pattern.replace("*", each.name if "*" in each.name else f"{each.name.removesuffix(INSIDE)}*")


def group_of(record: Any, over: tuple[str, ...] = (), pattern: str = "*", unit: str = "") -> Group:
    """Return what a file holds of a record: variables, with the coordinates of their dimensions, and attributes.

    Of a record within another, `over` are the dimensions before its own, `pattern` that of its names, and `unit` that
    of the fields that have none of their own.
    """
    group = Group()
    for key, each in declarations(type(record)):
        value = getattr(record, key)
        if each.name is None or (value is None and (each.role != "variable" or each.dims)):
            continue
        if each.optional and unknown(value):
            continue
        name, after = name_of(key, each, pattern), pattern.partition("*")[2]
        dims = tuple(dim + after.lstrip("_") if dim.endswith("_") else dim for dim in (*over, *each.dims))
        si = unit if each.unit is BESIDE and unit else each.unit(record) if callable(each.unit) else str(each.unit)
        within = pattern_of(each, pattern)
        if each.role == "part":
            inner = group_of(value, dims, within, si or unit)
            _merge(group, Group(known(inner.variables), inner.coordinates, inner.attrs))
        elif each.role == "rows" and isinstance(value, Mapping):
            units = each.unit if isinstance(each.unit, dict) else {}
            for row, of in value.items():
                inner = group_of(of, (), within.replace("*", f"{row}_*"), units.get(row, ""))
                alone = {dim for each in inner.variables.values() for dim in each.dims} - {"time", *_LABELLED}
                inner = _renamed(inner, {dim: f"{row}_{dim}" for dim in alone})
                group.coordinates.update({dim: each for dim, each in inner.coordinates.items() if dim})
                for label, one in known(inner.variables).items():
                    words = f"{row.replace('_', ' ')}, {one.attrs['long_name']}"
                    group.variables[label] = one._replace(attrs=one.attrs | {"long_name": words})
        elif each.role == "rows":
            _merge(group, _columns([group_of(row, (), within) for row in value], dims))
        elif each.role == "fact" and isinstance(value, Mapping):
            group.attrs.update({f"{name}{part}".replace("-", "_"): one for part, one in value.items()})
        elif each.role == "fact":
            group.attrs[name] = _attribute(value)
        elif each.role == "labels":
            where = dims[-1] if dims else ""  # of a row its own name, which `_columns` places
            group.coordinates[where] = Variable((where,), np.array(value, dtype=object), {})
        elif each.role == "coordinate":
            group.coordinates[dims[-1]] = _variable(dims[-1:], value, each, si)
        elif each.dims[-1:] == ("ends",):
            for end, order, one in zip(("from", "to"), ("first", "last"), value, strict=True):
                group.variables[f"{name}_{end}"] = _variable(dims[:-1], one, each, si, before=f"{order} ")
        elif np.iscomplexobj(value):
            for end, part in (("real", value.real), ("imag", value.imag)):
                group.variables[f"{name}_{end}"] = _variable(dims, part, each, si, f": {end[:4]} part")
        else:
            where = f", {after.strip('_')}" if after else ""
            group.variables[name] = _variable(dims, value, each, si, where)
    return group


def whole_group(record: Any) -> Group:
    """Return what a file holds of a result, with the coordinates of the dimensions that have none of their own."""
    return completed(_renamed(group_of(record), getattr(record, "file_dims", {})))


def completed(group: Group) -> Group:
    """Return a group with the coordinates of dimensions that are the same everywhere, without what is empty."""
    every = group.variables.values()
    sizes = {dim: size for each in every for dim, size in zip(each.dims, each.values.shape, strict=True)}
    for dim, names in _LABELLED.items():
        if dim in sizes:
            group.coordinates.update(labels(dim, names))
    for dim, (first, meaning) in _NUMBERED.items():
        if dim in sizes and dim not in group.coordinates:
            group.coordinates.update(coordinate(dim, np.arange(first, first + sizes[dim]), "1", meaning))
    filled = {name: each for name, each in group.variables.items() if each.values.size}  # a length of zero is unlimited
    return Group(filled, group.coordinates, known_attrs(group.attrs))


def in_files(unit: str) -> str:
    """Return a unit as the conventions of netCDF write it: ``m s-2`` of ``m/s^2``, ``1`` where there is none."""
    above, _, below = unit.partition("/")
    divisor = re.sub(r"\^|$", "-", below, count=1) + ("" if "^" in below else "1") if below else ""
    return " ".join(filter(None, (above if above != "1" or not below else "", divisor))) or "1"


def _variable(
    dims: tuple[str, ...], value: Any, each: Declaration, unit: str, more: str = "", before: str = ""
) -> Variable:
    values = np.asarray(np.nan if value is None else value)
    if values.dtype.kind in "OU":
        return words(dims, value, each.words)
    if each.flags:
        return flags(dims, values, each.words, *each.flags)
    if values.dtype == bool:
        values = values.astype(np.int64)
    frame = {"frame": each.frame} if each.frame else {}
    return variable(dims, values, in_files(unit), f"{before}{each.words}{more}", **frame)


def _attribute(value: Any) -> Any:
    if isinstance(value, tuple) and (not value or isinstance(value[0], str)):
        return "\n".join(value)
    if isinstance(value, tuple):
        return np.array(value)
    return int(value) if isinstance(value, bool) else value


def _columns(every: list[Group], dims: tuple[str, ...]) -> Group:
    """One variable of each name along a further dimension, NaN or empty where one has none; of words, what were
    attributes.
    """
    group = Group()
    for name in dict.fromkeys(name for each in every for name in each.variables):
        some = [each.variables.get(name) for each in every]
        first, *others = (each for each in some if each is not None)
        none = np.full(np.shape(first.values), "" if np.asarray(first.values).dtype.kind in "UO" else np.nan)
        values = np.stack([none if each is None else each.values for each in some])
        units = {each.attrs.get("units") for each in (first, *others)}
        mixed = {"units": "mixed"} if len(units) > 1 else {}
        group.variables[name] = Variable((*dims, *first.dims), values, first.attrs | mixed)
    if every and "" in every[0].coordinates:
        group.coordinates.update(labels(dims[-1], [each.coordinates[""].values.item() for each in every]))
    return group


def _renamed(group: Group, names: Mapping[str, str]) -> Group:
    """The group with other names of some dimensions."""
    if not names:
        return group

    def of(variables: dict[str, Variable]) -> dict[str, Variable]:
        dims = {key: tuple(names.get(dim, dim) for dim in each.dims) for key, each in variables.items()}
        return {names.get(key, key): each._replace(dims=dims[key]) for key, each in variables.items()}

    return Group(of(group.variables), of(group.coordinates), group.attrs)


def _merge(group: Group, other: Group) -> None:
    group.variables.update(other.variables)
    group.coordinates.update(other.coordinates)
    group.attrs.update(other.attrs)
