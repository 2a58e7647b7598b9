"""Layout of files: groups of variables with dimensions, units and frames, of any record whose fields are declared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from gbeam.results.declared import BESIDE, INSIDE, Declaration, declarations
from gbeam.results.facts import is_unknown

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


def variable(dims: tuple[str, ...], values: Any, units: str, long_name: str, **attrs: Any) -> Variable:
    """Return a variable. One along the dimension ``axis`` holds components in base axes, and says so."""
    frame = {"frame": BASE_AXES} if "axis" in dims else {}
    return Variable(dims, np.asarray(values), {"units": units, "long_name": long_name} | frame | attrs)


def words(dims: tuple[str, ...], values: Any, long_name: str) -> Variable:
    """Return a variable of text."""
    return Variable(dims, np.array(values, dtype=object), {"long_name": long_name})


def flags(dims: tuple[str, ...], values: Any, long_name: str, no: str, yes: str) -> Variable:
    """Return a variable of truth values. NetCDF has none, so they are numbers with meanings."""
    meanings = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": f"{no} {yes}"}
    return variable(dims, np.asarray(values).astype(np.int8), "1", long_name, **meanings)


def coordinate(name: str, values: Any, units: str, long_name: str) -> dict[str, Variable]:
    """Return a numeric coordinate along its own dimension, by name."""
    return {name: variable((name,), values, units, long_name)}


def labels(name: str, values: list[str] | tuple[str, ...]) -> dict[str, Variable]:
    """Return a coordinate of text along its own dimension, by name."""
    return {name: Variable((name,), np.array(values, dtype=object), {})}


def thinned(group: Group, every: int) -> Group:
    """Return a group with one of `every` samples of its histories, and an attribute that says so."""
    if every == 1:
        return group

    def cut(variable: Variable) -> Variable:
        if "time" not in variable.dims:
            return variable
        samples = tuple(slice(None, None, every if dim == "time" else 1) for dim in variable.dims)
        return variable._replace(values=np.ascontiguousarray(variable.values[samples]))

    variables = {name: cut(variable) for name, variable in group.variables.items()}
    coordinates = {name: cut(variable) for name, variable in group.coordinates.items()}
    count = len(group.coordinates["time"].values)
    attrs = {"histories": f"one of {every} samples, of {count}; peaks, errors and comparisons are of all"}
    return Group(variables, coordinates, group.attrs | attrs | {"histories_every": every})


def drop_unknown(variables: dict[str, Variable]) -> dict[str, Variable]:
    """Return the variables but those of which no value is known: a file has no column of nothing."""
    return {name: entry for name, entry in variables.items() if not _is_unknown(entry.values)}


def known_attrs(attrs: dict[str, Any]) -> dict[str, Any]:
    """Return the attributes but those of which no value is known."""
    return {name: fact for name, fact in attrs.items() if isinstance(fact, str) or not _is_unknown(np.asarray(fact))}


def _is_unknown(values: Any) -> bool:
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


SHARED = {"time", "mode", *_LABELLED}  # dimensions that rows by name share


def name_of(key: str, declaration: Declaration, pattern: str) -> str:
    """Return the name of a field in files, which stands for the ``*`` of the pattern of its record."""
    before, _, after = pattern.partition("*")
    if declaration.name == INSIDE:
        return before.rstrip("_")
    return f"{before}{declaration.name or key}{after}".rpartition("/")[2]


def pattern_of(declaration: Declaration, pattern: str) -> str:
    """Return the pattern of the names of a part's fields in files, from that of its record."""
    name = declaration.name
    assert name is not None
    return pattern.replace("*", name if "*" in name else f"{name.removesuffix(INSIDE)}*")


def group_of(record: Any, outer_dims: tuple[str, ...] = (), pattern: str = "*", unit: str = "") -> Group:
    """Return what a file holds of a record: variables, with the coordinates of their dimensions, and attributes.

    Of a record within another, `outer_dims` are the dimensions before its own, `pattern` is that of its names, and
    `unit` that of the fields that have none of their own.
    """
    group = Group()
    for key, declaration in declarations(type(record)):
        value = getattr(record, key)
        if declaration.name is None or (value is None and (declaration.role != "variable" or declaration.dims)):
            continue
        if declaration.optional and is_unknown(value):
            continue
        name = name_of(key, declaration, pattern)
        after = pattern.partition("*")[2]
        dims = tuple(dim + after.lstrip("_") if dim.endswith("_") else dim for dim in (*outer_dims, *declaration.dims))
        if isinstance(value, (np.ndarray, np.generic)) and value.ndim < len(dims):
            dims = tuple(dim for dim in dims if dim != "time")  # of one time
        stated = declaration.unit
        if stated is BESIDE and unit:
            si = unit
        else:
            si = stated(record) if callable(stated) else str(stated)
        part_pattern = pattern_of(declaration, pattern)
        if declaration.role == "part":
            inner = group_of(value, dims, part_pattern, si or unit)
            _merge(group, Group(drop_unknown(inner.variables), inner.coordinates, inner.attrs))
        elif declaration.role == "rows" and isinstance(value, Mapping):
            units = declaration.unit if isinstance(declaration.unit, dict) else {}
            for row, part in value.items():
                inner = group_of(part, (), f"{row}_{part_pattern}", units.get(row, ""))
                dims_of_row = {dim for entry in inner.variables.values() for dim in entry.dims} - SHARED
                inner = _renamed(inner, {dim: f"{row}_{dim}" for dim in dims_of_row})
                group.attrs.update(inner.attrs)
                group.coordinates.update({dim: entry for dim, entry in inner.coordinates.items() if dim})
                for label, entry in drop_unknown(inner.variables).items():
                    long_name = f"{row.replace('_', ' ')}, {entry.attrs['long_name']}"
                    group.variables[label] = entry._replace(attrs=entry.attrs | {"long_name": long_name})
        elif declaration.role == "rows":
            _merge(group, _columns([group_of(row, (), part_pattern) for row in value], dims))
        elif declaration.role == "fact" and isinstance(value, Mapping):
            group.attrs.update({f"{name}{entry}".replace("-", "_"): fact for entry, fact in value.items()})
        elif declaration.role == "fact":
            group.attrs[name] = _attribute(value)
        elif declaration.role == "labels":
            where = dims[-1] if dims else ""  # of a row its own name, which `_columns` places
            group.coordinates[where] = Variable((where,), np.array(value, dtype=object), {})
        elif declaration.role == "coordinate":
            group.coordinates[dims[-1]] = _variable(dims[-1:], value, declaration, si)
        elif declaration.dims[-1:] == ("ends",):
            for suffix, order, bound in zip(("from", "to"), ("first", "last"), value, strict=True):
                group.variables[f"{name}_{suffix}"] = _variable(dims[:-1], bound, declaration, si, prefix=f"{order} ")
        elif np.iscomplexobj(value):
            for suffix, values in (("real", value.real), ("imag", value.imag)):
                group.variables[f"{name}_{suffix}"] = _variable(dims, values, declaration, si, f": {suffix} part")
        else:
            where = f", {after.strip('_')}" if after else ""
            group.variables[name] = _variable(dims, value, declaration, si, where)
    return group


def whole_group(record: Any) -> Group:
    """Return what a file holds of a result, with the coordinates of the dimensions that have none of their own."""
    return completed(_renamed(group_of(record), getattr(record, "file_dims", {})))


def completed(group: Group) -> Group:
    """Return a group without empty variables, and with coordinates of the dimensions that all files share."""
    sizes: dict[str, int] = {}
    for entry in group.variables.values():
        sizes |= dict(zip(entry.dims, entry.values.shape, strict=True))
    for dim, names in _LABELLED.items():
        if dim in sizes:
            group.coordinates.update(labels(dim, names))
    for dim, (first, meaning) in _NUMBERED.items():
        if dim in sizes and dim not in group.coordinates:
            group.coordinates.update(coordinate(dim, np.arange(first, first + sizes[dim]), "1", meaning))
    # netCDF takes a dimension of length zero for an unlimited one.
    variables = {name: entry for name, entry in group.variables.items() if entry.values.size}
    coordinates = {name: entry for name, entry in group.coordinates.items() if entry.values.size}
    return Group(variables, coordinates, known_attrs(group.attrs))


def in_files(unit: str) -> str:
    """Return a unit as the conventions of netCDF write it: ``m s-2`` of ``m/s^2``, ``1`` where there is none."""
    numerator, _, denominator = unit.partition("/")
    if not denominator:
        return numerator or "1"
    divisor = denominator.replace("^", "-", 1) if "^" in denominator else f"{denominator}-1"
    return divisor if numerator in ("", "1") else f"{numerator} {divisor}"


def _variable(
    dims: tuple[str, ...], value: Any, declaration: Declaration, unit: str, suffix: str = "", prefix: str = ""
) -> Variable:
    """Variable of a field by its declaration: text, flags, or numbers with their unit and frame."""
    values = np.asarray(np.nan if value is None else value)
    if values.dtype.kind in "OU":
        return words(dims, value, declaration.words)
    if declaration.flags:
        return flags(dims, values, declaration.words, *declaration.flags)
    if values.dtype == bool:
        values = values.astype(np.int64)
    frame = {"frame": declaration.frame} if declaration.frame else {}
    return variable(dims, values, in_files(unit), f"{prefix}{declaration.words}{suffix}", **frame)


def _attribute(value: Any) -> Any:
    """Value of an attribute: a text with a line for each word, an array of a tuple of numbers, 0 or 1 of a flag."""
    if isinstance(value, tuple) and (not value or isinstance(value[0], str)):
        return "\n".join(value)
    if isinstance(value, tuple):
        return np.array(value)
    return int(value) if isinstance(value, bool) else value


def _columns(rows: list[Group], dims: tuple[str, ...]) -> Group:
    """Return the variables of rows, stacked along a further dimension; NaN or empty where a row has none.

    Attributes are those of the first row that has the variable. If units differ, the unit is mixed.
    """
    group = Group()
    for name in dict.fromkeys(name for row in rows for name in row.variables):
        cells = [row.variables.get(name) for row in rows]
        known_cells = [cell for cell in cells if cell is not None]
        first = known_cells[0]
        missing: Any = "" if np.asarray(first.values).dtype.kind in "UO" else np.nan
        filler = np.full(np.shape(first.values), missing)
        values = np.stack([filler if cell is None else cell.values for cell in cells])
        units = {cell.attrs.get("units") for cell in known_cells}
        mixed = {"units": "mixed"} if len(units) > 1 else {}
        group.variables[name] = Variable((*dims, *first.dims), values, first.attrs | mixed)
    if rows and "" in rows[0].coordinates:
        group.coordinates.update(labels(dims[-1], [row.coordinates[""].values.item() for row in rows]))
    return group


def _renamed(group: Group, names: Mapping[str, str]) -> Group:
    """Return the group with other names for some dimensions, and for their coordinates."""
    if not names:
        return group

    def renamed(variables: dict[str, Variable]) -> dict[str, Variable]:
        entries = {}
        for key, entry in variables.items():
            dims = tuple(names.get(dim, dim) for dim in entry.dims)
            entries[names.get(key, key)] = entry._replace(dims=dims)
        return entries

    return Group(renamed(group.variables), renamed(group.coordinates), group.attrs)


def _merge(group: Group, addition: Group) -> None:
    group.variables.update(addition.variables)
    group.coordinates.update(addition.coordinates)
    group.attrs.update(addition.attrs)
