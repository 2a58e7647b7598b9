"""JSON of any result whose fields are declared, and the units of the figures in it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import NoneType
from typing import Any, get_args, get_origin

import numpy as np

from gbeam.arrays.types import Complex
from gbeam.results.declared import INSIDE, NAMES, Declaration, annotation, declarations, record_in, records_in, types_in

ANY = "*"  # in units: any key that has no entry of its own
Units = dict[str, Any]
_NUMBERS = frozenset({float, int, np.float64, np.complex128, np.int_, np.intp})


def json_of(result: Any) -> dict[str, Any]:
    """Return a whole result as JSON: how it ended, its figures, and its warnings."""
    return {"outcome": getattr(result, "outcome", "done"), **facts_of(result)}


def facts_of(record: Any) -> dict[str, Any]:
    """Return the quantities of a record as JSON: vectors by axis, arrays along a dimension of its `json_rows` as one
    value in each row.
    """
    facts: dict[str, Any] = {}
    row_keys: dict[str, str] = getattr(record, "json_rows", {})
    for name, declaration in declarations(type(record)):
        value = getattr(record, name)
        if declaration.key is None or (declaration.optional and is_unknown(value)):
            continue
        key, row_dim = declaration.key or name, _row_dimension(declaration, row_keys)
        for suffix, part in _parts(value):
            if row_dim is None:
                _put(facts, f"{key}{suffix}", _json_value(part, declaration))
                continue
            row_labels = _labels(record, row_dim)
            axis = declaration.dims.index(row_dim)
            rows = _rows(facts, row_keys[row_dim], row_labels, _count(part, axis))
            if part is None:  # not estimated: no number in any row
                cells: list[Any] = [dict.fromkeys(units_of(record_in(type(record), name)), math.nan)] * len(rows)
            else:
                of_row = replace(declaration, dims=tuple(dim for dim in declaration.dims if dim != row_dim))
                cells = [_json_value(at_place(part, i, axis), of_row) for i in range(len(rows))]
            for row, cell in zip(rows, cells, strict=True):
                _put(row, f"{key}{suffix}", cell)
    return facts


class Rows(dict[str, Any]):
    """In a tree: entries of a list's rows."""


class Nullable(dict[str, Any]):
    """In a tree: entries of a part that may be null."""


@dataclass(frozen=True)
class Entry:
    """A leaf of a tree: a quantity in JSON."""

    unit: str  # SI; empty of what has none; ``unit`` where the facts have it beside the number
    words: str
    ends: tuple[str, ...] = ()  # names of its components; ``[i]`` where it is a list
    types: tuple[str, ...] = ("number",)  # in JSON: number, boolean, string; array where it may be one or several


def tree_of(kind: type) -> dict[str, Any]:
    """Return the layout of the JSON of :func:`facts_of` for a kind of record: an :class:`Entry` at the key of each
    quantity, :data:`ANY` for names, and :class:`Rows` for lists.
    """
    tree: dict[str, Any] = {}
    row_keys: dict[str, str] = getattr(kind, "json_rows", {})
    for name, declaration in declarations(kind):
        if declaration.key is None:
            continue
        key, hint = declaration.key or name, annotation(kind, name)
        records = records_in(kind, name) if declaration.role in ("part", "rows") else ()
        inner = next(iter(records), None)
        leaf: Any = _joined(*map(tree_of, records)) if records else _leaf(declaration, row_keys, hint)
        row_dim = _row_dimension(declaration, row_keys)
        if declaration.role == "part" and NoneType in types_in(hint) and row_dim is None and not declaration.optional:
            leaf = Nullable(leaf)
        if inner and declaration.unit and isinstance(declaration.unit, str):
            leaf = _changed(leaf, partial(_with_unit, unit=declaration.unit))
        if inner and declaration.role == "part" and key != INSIDE and not declaration.words.startswith("of "):
            leaf = _changed(leaf, partial(_with_words, words=declaration.words))
        if inner and declaration.role == "part" and declaration.dims and row_dim is None:
            leaf = _changed(leaf, lambda entry: replace(entry, ends=entry.ends or ("[i]",)))
        if isinstance(declaration.unit, dict):
            named_unit = {"unit": Entry("", "SI unit", types=("string",))} if inner else {}
            leaf = leaf if inner else replace(leaf, ends=())
            for row, unit in declaration.unit.items():
                united = _changed(leaf, partial(_with_unit, unit=unit))
                _put(tree, f"{key}.{row}" if inner else row, united | named_unit if inner else united)
            continue
        if declaration.role == "rows":
            named = get_origin(hint) is Mapping or (inner and _label(inner))
            leaf = {ANY: leaf} if named else Rows(leaf)
        parent = tree
        if row_dim is not None and row_keys[row_dim]:
            parent = tree.setdefault(row_keys[row_dim], {} if _is_labelled(kind, row_dim) else Rows())
        if row_dim is not None and _is_labelled(kind, row_dim):
            parent = parent.setdefault(ANY, {})
        _put(parent, key, leaf)
        if hint == Complex:
            _put(parent, f"{key}_imaginary", leaf)
    return tree


def _leaf(declaration: Declaration, row_keys: Mapping[str, str], hint: Any) -> Entry:
    """Entry of a quantity that is no record: its unit, words, components and type in JSON."""
    in_rows = not (declaration.key or "").startswith("/")
    dims = [dim for dim in declaration.dims if dim not in row_keys or not in_rows]
    types = list(types_in(hint))
    origins = [get_origin(kind) for kind in types]
    alternatives = get_args(hint)
    number_or_list = float in alternatives and any(get_origin(kind) is tuple for kind in alternatives)
    depth = sum(origin in (dict, Mapping) for origin in origins)
    ends: tuple[str, ...] = ()
    if depth:
        ends = (".".join([ANY] * depth),)
    elif dims and dims[-1] in NAMES:
        ends = NAMES[dims[-1]]
    elif dims or (tuple in origins and not declaration.dims and not number_or_list):
        ends = ("[i]",)
    if any(kind is Any or kind in _NUMBERS for kind in types):
        json_type = "number"
    else:
        json_type = "boolean" if bool in types or np.bool_ in types else "string"
    unit = declaration.unit if isinstance(declaration.unit, str) else "unit"
    return Entry(unit, declaration.words, ends, (json_type, "array") if number_or_list else (json_type,))


def _joined(tree: dict[str, Any], *others: dict[str, Any]) -> dict[str, Any]:
    """Return a tree with the entries of any of several; where more have one, that of the first."""
    for branches in others:
        for key, branch in branches.items():
            both_tables = isinstance(branch, dict) and isinstance(tree.get(key), dict)
            tree[key] = type(tree[key])(_joined(tree[key], branch)) if both_tables else tree.get(key, branch)
    return tree


def _changed(tree: Any, change: Callable[[Entry], Entry]) -> Any:
    """Return the tree with `change` applied to every entry."""
    if isinstance(tree, dict):
        return type(tree)({key: _changed(branch, change) for key, branch in tree.items()})
    return change(tree)


def _with_unit(entry: Entry, unit: str) -> Entry:
    if entry.unit != "unit":
        return entry
    return replace(entry, unit="" if unit == "1" else unit)


def _with_words(entry: Entry, words: str) -> Entry:
    return replace(entry, words=f"{words}: {entry.words}")


def units_of(kind: type) -> Units:
    """Return the unit of every quantity that :func:`facts_of` makes of a record of this kind, at its place."""

    def units(tree: Any) -> Any:
        return {key: units(branch) for key, branch in tree.items()} if isinstance(tree, dict) else tree.unit

    return dict(units(tree_of(kind)))


def paths_of(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Entry]]:
    """Yield path and entry of every quantity that is not text. ``*`` in a path is a name, ``[i]`` a place in a list."""
    for key, branch in tree.items():
        path = f"{prefix}{key}"
        if isinstance(branch, dict):
            yield from paths_of(branch, f"{path}{'[i]' if isinstance(branch, Rows) else ''}.")
        elif "string" not in branch.types:
            for end in branch.ends or ("",):
                yield f"{path}{'.' if end and end != '[i]' else ''}{end}", branch


def schema_of(tree: Any) -> dict[str, Any]:
    """Return the JSON schema of a tree; a number may be null, which is what is not finite."""
    if isinstance(tree, Rows):
        return {"type": "array", "items": schema_of(dict(tree))}
    if isinstance(tree, dict):
        properties = {key: schema_of(branch) for key, branch in tree.items() if key != ANY}
        types = ["object", "null"] if isinstance(tree, Nullable) else "object"
        schema = {"type": types, "properties": properties}
        if ANY in tree:
            schema["additionalProperties"] = schema_of(tree[ANY])
        return schema
    form: dict[str, Any] = {"type": [*tree.types, "null"]}
    if tree.ends and tree.ends[0] != "[i]":
        form = {"type": ["object", "null"]}
    elif tree.ends:
        form = {"type": ["array", "null"]}
    form["description"] = tree.words
    if tree.unit not in ("", "unit"):
        form["unit"] = tree.unit
    return form


def unit_at(facts: Any, tree: Any, keys: tuple[str | int, ...]) -> str | None:
    """Return the unit of the figure at `keys` of facts of this tree: empty without one, None where none is declared."""
    for word in (key for key in keys if isinstance(key, str)):
        tree = tree.get(word, tree.get(ANY)) if isinstance(tree, dict) else tree
        if tree is None:
            return None
    if not isinstance(tree, Entry):
        return None
    record = facts  # the innermost: its unit stands beside a list of numbers, too
    for key in keys[:-1] if tree.unit == "unit" else ():
        facts = facts[key]
        record = facts if isinstance(facts, dict) else record
    return str(record["unit"]) if tree.unit == "unit" else tree.unit


def is_unknown(value: Any) -> bool:
    """Return True for None, for what is empty, and for numbers that are all NaN."""
    if isinstance(value, (float, np.ndarray)):
        values = np.asarray(value)
        return values.size == 0 or (values.dtype.kind in "fc" and bool(np.isnan(values).all()))
    return value is None or (isinstance(value, (str, tuple, Mapping)) and not value)


def _parts(value: Any) -> list[tuple[str, Any]]:
    """Return ("", value), or of complex values the real part with "" and the imaginary part with "_imaginary"."""
    if np.iscomplexobj(value):
        return [("", value.real), ("_imaginary", value.imag)]
    return [("", value)]


def _json_value(value: Any, declaration: Declaration) -> Any:
    """JSON of a value: records as objects, rows as a list or by name, vectors by component."""
    if value is None:
        return None
    if declaration.role == "part":
        return facts_of(value)
    if declaration.role == "rows" and isinstance(value, Mapping):
        rows = {name: facts_of(row) for name, row in value.items()}
        units = declaration.unit if isinstance(declaration.unit, dict) else {}
        for name in rows.keys() & units.keys():
            rows[name]["unit"] = units[name]
        return rows
    if declaration.role == "rows":
        label = _label(type(value[0])) if value else ""
        if label:
            return {getattr(row, label): facts_of(row) for row in value}
        return [facts_of(row) for row in value]
    if declaration.dims and declaration.dims[-1] in NAMES:
        return dict(zip(NAMES[declaration.dims[-1]], np.asarray(value).T.tolist(), strict=True))
    return _plain_lists(value)


def _plain_lists(value: Any) -> Any:
    """A value as JSON has it: lists for tuples and arrays, at any depth."""
    if isinstance(value, Mapping):
        return {key: _plain_lists(entry) for key, entry in value.items()}
    if isinstance(value, tuple):
        return [_plain_lists(entry) for entry in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def _put(facts: dict[str, Any], key: str, value: Any) -> None:
    """Set `facts` at a key, whose dots lead deeper; an object at INSIDE, or beside one, is merged into that."""
    if key == INSIDE:
        _merge(facts, value)
        return
    *outer, last = key.removeprefix("/").split(".")
    for word in outer:
        facts = facts.setdefault(word, {})
    if isinstance(value, dict) and isinstance(facts.get(last), dict):
        _merge(facts[last], value)
    else:
        facts[last] = value


def _merge(facts: dict[str, Any], others: dict[str, Any]) -> None:
    """Merge JSON into `facts`: objects key by key, lists row by row; any other value replaces the old one."""
    for key, value in others.items():
        if isinstance(value, list) and isinstance(facts.get(key), list):
            for row, other in zip(facts[key], value, strict=True):
                _merge(row, other)
        elif isinstance(value, dict) and isinstance(facts.get(key), dict):
            _merge(facts[key], value)
        else:
            facts[key] = value


def _row_dimension(declaration: Declaration, row_keys: Mapping[str, str]) -> str | None:
    """Dimension along which JSON has a value in each row, or None where it has none."""
    if declaration.role == "rows" or (declaration.key or "").startswith("/"):
        return None
    return next((dim for dim in declaration.dims if dim in row_keys), None)


def _labels(record: Any, dim: str) -> tuple[str, ...] | None:
    """Keys by which JSON has the places along a dimension, or None where it lists them."""
    if dim in NAMES:
        return NAMES[dim]
    name = next((name for name, declaration in declarations(type(record)) if _names(declaration, dim)), None)
    return None if name is None else getattr(record, name)


def _label(kind: type) -> str:
    """Name of the field that is the key of a row in JSON, or empty where rows are listed."""
    labels = (name for name, field in declarations(kind) if field.role == "labels" and field.key is None)
    return next(labels, "")


def _is_labelled(kind: type, dim: str) -> bool:
    return dim in NAMES or any(_names(declaration, dim) for _, declaration in declarations(kind))


def _names(declaration: Declaration, dim: str) -> bool:
    return declaration.role == "labels" and declaration.key is None and declaration.dims == (dim,)


def _rows(facts: dict[str, Any], key: str, labels: tuple[str, ...] | None, count: int) -> list[dict[str, Any]]:
    """Objects of the rows along a dimension under `key`: by label, or in a list of `count`. Missing ones are added."""
    if labels is not None:
        objects = facts.setdefault(key, {}) if key else facts
        return [objects.setdefault(label, {}) for label in labels]
    listed: list[dict[str, Any]] = facts.setdefault(key, [])
    listed.extend({} for _ in range(count - len(listed)))
    return listed


def _count(value: Any, axis: int) -> int:
    """Number of places along an axis of an array or a tuple, or of the arrays of a record, or zero for None."""
    if value is None:
        return 0
    if not dataclasses.is_dataclass(value):
        return np.shape(value)[axis]
    return max(_count(array, axis) for _, array in _arrays(value))


def at_place(value: Any, place: int, axis: int = 0) -> Any:
    """Return what an array, a tuple, or every array of a record holds at one place along an axis."""
    if isinstance(value, tuple):
        return value[place]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{name: at_place(array, place, axis) for name, array in _arrays(value)})
    return np.take(value, place, axis)


def _arrays(record: Any) -> Iterator[tuple[str, Any]]:
    """Yield name and value of the fields of a record that are arrays, or records of arrays."""
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if dataclasses.is_dataclass(value) or isinstance(value, np.ndarray):
            yield field.name, value
