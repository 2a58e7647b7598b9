"""JSON of any result whose fields are declared, and the units of the figures in it."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.results.declared import INSIDE, NAMES, Declaration, annotation, declarations, record_in

ANY = "*"  # in units: any key that has no entry of its own
Units = dict[str, Any]


def json_of(result: Any) -> dict[str, Any]:
    """Return a whole result as JSON: how it ended, its figures, and its warnings."""
    return {"outcome": getattr(result, "outcome", "done"), **facts_of(result)}


def facts_of(record: Any) -> dict[str, Any]:
    """Return a record as JSON: vectors by their axes; what stands along a dimension of its `json_rows` row by row."""
    facts: dict[str, Any] = {}
    lists: dict[str, str] = getattr(record, "json_rows", {})
    for name, each in declarations(type(record)):
        value = getattr(record, name)
        if each.key is None or (each.optional and unknown(value)):
            continue
        key, along = each.key or name, _along(each, lists)
        for end, one in _parts(value):
            if along is None:
                _put(facts, f"{key}{end}", _plain(one, each))
                continue
            places = _labels(record, along)
            axis = each.dims.index(along)
            every = _rows(facts, lists[along], places, _count(one, axis))
            if one is None:  # not estimated: no number in any row
                shares: list[Any] = [dict.fromkeys(units_of(record_in(type(record), name)), math.nan)] * len(every)
            else:
                across = replace(each, dims=tuple(dim for dim in each.dims if dim != along))
                shares = [_plain(at_place(one, i, axis), across) for i in range(len(every))]
            for row, share in zip(every, shares, strict=True):
                _put(row, f"{key}{end}", share)
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
    """Return what :func:`facts_of` makes of a record of this kind: a :class:`Entry` for each quantity at its place."""
    tree: dict[str, Any] = {}
    lists: dict[str, str] = getattr(kind, "json_rows", {})
    for name, each in declarations(kind):
        if each.key is None:
            continue
        key, written = each.key or name, annotation(kind, name)
        inside = record_in(kind, name) if each.role in ("part", "rows") else None
        leaf: Any = tree_of(inside) if inside else _leaf(each, lists, written)
        along = _along(each, lists)
        if each.role == "part" and "None" in written and along is None and not each.optional:
            leaf = Nullable(leaf)
        if inside and each.unit and isinstance(each.unit, str):
            leaf = _each(leaf, partial(_united, unit=each.unit))
        if inside and each.role == "part" and key != INSIDE and not each.words.startswith("of "):
            leaf = _each(leaf, partial(_explained, words=each.words))
        if inside and each.role == "part" and each.dims and along is None:
            leaf = _each(leaf, lambda entry: replace(entry, ends=entry.ends or ("[i]",)))
        if isinstance(each.unit, dict):
            named_unit = {"unit": Entry("", "SI unit", types=("string",))} if inside else {}
            leaf = leaf if inside else replace(leaf, ends=())
            for row, unit in each.unit.items():
                united = _each(leaf, partial(_united, unit=unit))
                _put(tree, f"{key}.{row}" if inside else row, united | named_unit if inside else united)
            continue
        if each.role == "rows":
            named = "Mapping" in written or (inside and _label(inside))
            leaf = {ANY: leaf} if named else Rows(leaf)
        where = tree
        if along is not None and lists[along]:
            where = tree.setdefault(lists[along], {} if _is_labelled(kind, along) else Rows())
        if along is not None and _is_labelled(kind, along):
            where = where.setdefault(ANY, {})
        _put(where, key, leaf)
        if written == "Complex":
            _put(where, f"{key}_imaginary", leaf)
    return tree


def _leaf(each: Declaration, lists: Mapping[str, str], written: str) -> Entry:
    spread = not (each.key or "").startswith("/")
    dims = [dim for dim in each.dims if dim not in lists or not spread]
    either = written == "Limit" or re.search(r"float \| tuple", written)
    mapped = len(re.findall("dict|Mapping", written))
    ends: tuple[str, ...] = ("[i]",) if dims or ("tuple" in written and not each.dims and not either) else ()
    if mapped:
        ends = (".".join(ANY for _ in range(mapped)),)
    elif dims and dims[-1] in NAMES:
        ends = NAMES[dims[-1]]
    number = re.search("float|Floats|int|Complex|Limit|Any", written)
    kind = "number" if number else "boolean" if re.search("bool|Flags", written) else "string"
    unit = each.unit if isinstance(each.unit, str) else "unit"
    return Entry(unit, each.words, ends, (kind, "array") if either else (kind,))


def _each(tree: Any, change: Callable[[Entry], Entry]) -> Any:
    """A tree whose entries are changed."""
    if isinstance(tree, dict):
        return type(tree)({key: _each(each, change) for key, each in tree.items()})
    return change(tree)


def _united(entry: Entry, unit: str) -> Entry:
    return replace(entry, unit="" if unit == "1" else unit) if entry.unit == "unit" else entry


def _explained(entry: Entry, words: str) -> Entry:
    return replace(entry, words=f"{words}: {entry.words}")


def units_of(kind: type) -> Units:
    """Return the unit of every quantity that :func:`facts_of` makes of a record of this kind, at its place."""

    def units(tree: Any) -> Any:
        return {key: units(each) for key, each in tree.items()} if isinstance(tree, dict) else tree.unit

    return dict(units(tree_of(kind)))


def paths_of(tree: dict[str, Any], before: str = "") -> Iterator[tuple[str, Entry]]:
    """Yield the path of every number in a tree; ``*`` is a name, ``[i]`` a number in a list."""
    for key, each in tree.items():
        path = f"{before}{key}"
        if isinstance(each, dict):
            yield from paths_of(each, f"{path}{'[i]' if isinstance(each, Rows) else ''}.")
        elif "string" not in each.types:
            for end in each.ends or ("",):
                yield f"{path}{'.' if end and end != '[i]' else ''}{end}", each


def schema_of(tree: Any) -> dict[str, Any]:
    """Return the JSON schema of a tree; a number may be null, which is what is not finite."""
    if isinstance(tree, Rows):
        return {"type": "array", "items": schema_of(dict(tree))}
    if isinstance(tree, dict):
        named = {key: schema_of(each) for key, each in tree.items() if key != ANY}
        types = ["object", "null"] if isinstance(tree, Nullable) else "object"
        return {"type": types, "properties": named} | (
            {"additionalProperties": schema_of(tree[ANY])} if ANY in tree else {}
        )
    form: dict[str, Any] = {"type": [*tree.types, "null"]}
    if tree.ends and tree.ends[0] != "[i]":
        form = {"type": ["object", "null"]}
    elif tree.ends:
        form = {"type": ["array", "null"]}
    return form | {"description": tree.words} | ({"unit": tree.unit} if tree.unit not in ("", "unit") else {})


def unit_at(facts: Any, tree: Any, keys: tuple[str | int, ...]) -> str | None:
    """Return the unit of the figure at `keys` of facts of this tree: empty without one, None where none is declared."""
    for word in (key for key in keys if isinstance(key, str)):
        tree = tree.get(word, tree.get(ANY)) if isinstance(tree, dict) else tree
        if tree is None:
            return None
    if not isinstance(tree, Entry):
        return None
    for key in keys[:-1] if tree.unit == "unit" else ():
        facts = facts[key]
    return str(facts["unit"]) if tree.unit == "unit" else tree.unit


def unknown(value: Any) -> bool:
    """Return whether a value says nothing: none, empty, or no number at all."""
    if isinstance(value, (float, np.ndarray)):
        values = np.asarray(value)
        return values.size == 0 or (values.dtype.kind in "fc" and bool(np.isnan(values).all()))
    return value is None or (isinstance(value, (str, tuple, Mapping)) and not value)


def _parts(value: Any) -> list[tuple[str, Any]]:
    """The value, or the real and imaginary part of complex ones, with what their names end in."""
    if np.iscomplexobj(value):
        return [("", value.real), ("_imaginary", value.imag)]
    return [("", value)]


def _plain(value: Any, each: Declaration) -> Any:
    if value is None or each.role == "part":
        return None if value is None else facts_of(value)
    if each.role == "rows" and isinstance(value, Mapping):
        units = {name: {"unit": unit} for name, unit in each.unit.items()} if isinstance(each.unit, dict) else {}
        return {name: facts_of(row) | units.get(name, {}) for name, row in value.items()}
    if each.role == "rows":
        label = _label(type(value[0])) if value else ""
        return {getattr(row, label): facts_of(row) for row in value} if label else [facts_of(row) for row in value]
    if each.dims and each.dims[-1] in NAMES:
        return dict(zip(NAMES[each.dims[-1]], np.asarray(value).T.tolist(), strict=True))
    return _bare(value)


def _bare(value: Any) -> Any:
    """A value as JSON has it: lists for tuples and arrays, at any depth."""
    if isinstance(value, Mapping):
        return {key: _bare(each) for key, each in value.items()}
    if isinstance(value, tuple):
        return [_bare(each) for each in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def _put(facts: dict[str, Any], key: str, value: Any) -> None:
    """Put a value at its key, whose dots lead deeper; the values of a part that stands inside beside the others."""
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
    for key, value in others.items():
        if isinstance(value, list) and isinstance(facts.get(key), list):
            for row, other in zip(facts[key], value, strict=True):
                _merge(row, other)
        elif isinstance(value, dict) and isinstance(facts.get(key), dict):
            _merge(facts[key], value)
        else:
            facts[key] = value


def _along(each: Declaration, lists: Mapping[str, str]) -> str | None:
    """The dimension along which JSON has rows, if any."""
    if each.role == "rows" or (each.key or "").startswith("/"):
        return None
    return next((dim for dim in each.dims if dim in lists), None)


def _labels(record: Any, dim: str) -> tuple[str, ...] | None:
    """Names by which JSON has the places along a dimension; None where it lists them."""
    if dim in NAMES:
        return NAMES[dim]
    name = next((name for name, each in declarations(type(record)) if _names(each, dim)), None)
    return None if name is None else getattr(record, name)


def _label(kind: type) -> str:
    """The field of a row that is its key in JSON; empty where rows are listed."""
    return next((name for name, each in declarations(kind) if each.role == "labels" and each.key is None), "")


def _is_labelled(kind: type, dim: str) -> bool:
    return dim in NAMES or any(_names(each, dim) for _, each in declarations(kind))


def _names(each: Declaration, dim: str) -> bool:
    return each.role == "labels" and each.key is None and each.dims == (dim,)


def _rows(facts: dict[str, Any], key: str, labels: tuple[str, ...] | None, count: int) -> list[dict[str, Any]]:
    """The rows of JSON that stand along a dimension, made where there are none."""
    if labels is not None:
        named = facts.setdefault(key, {}) if key else facts
        return [named.setdefault(label, {}) for label in labels]
    listed: list[dict[str, Any]] = facts.setdefault(key, [])
    listed.extend({} for _ in range(count - len(listed)))
    return listed


def _count(value: Any, axis: int) -> int:
    """Number of places along a dimension of an array or a tuple, or of the arrays of a record; zero of none."""
    if value is None or not dataclasses.is_dataclass(value):
        return 0 if value is None else np.shape(value)[axis]
    return max(_count(each, axis) for _, each in _arrays(value))


def at_place(value: Any, place: int, axis: int = 0) -> Any:
    """Return the share of one place along a dimension of an array or a tuple, or of the arrays of a record."""
    if isinstance(value, tuple):
        return value[place]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{name: at_place(each, place, axis) for name, each in _arrays(value)})
    return np.take(value, place, axis)


def _arrays(record: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a record that are arrays, or records of arrays."""
    for each in dataclasses.fields(record):
        value = getattr(record, each.name)
        if dataclasses.is_dataclass(value) or isinstance(value, np.ndarray):
            yield each.name, value
