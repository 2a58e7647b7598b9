"""Fields of results declared once: unit, words and dimensions, from which files, JSON, units and docstrings follow.

A result says of each field, where it stands, all that its outputs need to know::

    speed: Floats = quantity("rad/s", "hub rate", "speed", role="coordinate")

:func:`gbeam.io.layout.declared.group_of` makes of it a variable of a file, :func:`facts_of` the JSON, :func:`units_of`
the units of the figures in that JSON, and :func:`parameters` the docstring.
"""

from __future__ import annotations

import dataclasses
import math
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np

Role = Literal["variable", "coordinate", "fact", "part", "rows"]
Units = dict[str, Any]
_METADATA = "declared"
_METHOD = TypeVar("_METHOD", bound=Callable[[Any], Any])


@dataclass(frozen=True)
class Declaration:
    """What is to be known of a field of a result, or of a property.

    Parameters
    ----------
    words : str
        The quantity, as files describe it.
    unit : str or callable
        SI, such as m/s^2; empty of what has none; of the record where the unit depends on it.
    dims : tuple of str
        Dimensions of the array; of a part those that come before its own.
    role : str
        variable or coordinate of a file; fact, one of its attributes; part, another record; rows, a tuple of records.
    name : str or None
        In files, of a part the prefix of its names; None where files do not hold it.
    key : str or None
        In JSON, with dots where it stands deeper; None where JSON does not have it.
    note : str
        More for the docstring.
    """

    words: str
    unit: str | Callable[[Any], str]
    dims: tuple[str, ...]
    role: Role
    name: str | None
    key: str | None
    note: str = ""


def quantity(
    unit: str | Callable[[Any], str],
    words: str,
    *dims: str,
    role: Role = "variable",
    name: str | None = "",
    key: str | None = "",
    note: str = "",
    **default: Any,
) -> Any:
    """Declare a field of a result; see :class:`Declaration`, where an empty name or key is the field's own."""
    declaration = Declaration(words, unit, dims, role, name, key, note)
    return dataclasses.field(metadata={_METADATA: declaration}, **default)


def fact(words: str, unit: str = "", **more: Any) -> Any:
    """Declare a field that is one word, number or truth: an attribute of a file."""
    return quantity(unit, words, role="fact", **more)


def part(words: str, *dims: str, **more: Any) -> Any:
    """Declare a field that is another record."""
    return quantity("", words, *dims, role="part", **more)


def rows(words: str, dim: str, **more: Any) -> Any:
    """Declare a field that is a tuple of records, one for each place along a dimension of its own."""
    return quantity("", words, dim, role="rows", **more)


def declared(
    unit: str, words: str, *dims: str, role: Role = "variable", name: str | None = "", key: str | None = ""
) -> Callable[[_METHOD], _METHOD]:
    """Declare what a property, whose getter this decorates, gives."""

    def declare(method: _METHOD) -> _METHOD:
        setattr(method, _METADATA, Declaration(words, unit, dims, role, name, key))
        return method

    return declare


def declarations(kind: type) -> Iterator[tuple[str, Declaration]]:
    """Fields of a record, then its properties, that are declared, each with its declaration."""
    for each in dataclasses.fields(kind):
        if _METADATA in each.metadata:
            yield each.name, each.metadata[_METADATA]
    for base in reversed(kind.__mro__):
        for name, value in vars(base).items():
            declaration = getattr(getattr(value, "fget", None), _METADATA, None)
            if declaration is not None:
                yield name, declaration


def json_of(result: Any) -> dict[str, Any]:
    """Return a whole result as JSON: how it ended, its figures, and its warnings."""
    return {"outcome": getattr(result, "outcome", "done"), **facts_of(result), "warnings": list(result.warnings)}


def facts_of(record: Any) -> dict[str, Any]:
    """Return a record as JSON: vectors by their axes; a dimension of its `json_rows` becomes a list of rows."""
    facts: dict[str, Any] = {}
    lists: dict[str, str] = getattr(record, "json_rows", {})
    for name, each in declarations(type(record)):
        value = getattr(record, name)
        if each.key is None:
            continue
        key = each.key or name
        along = next((dim for dim in each.dims if dim in lists), None)
        for end, one in _parts(value):
            if along is None or each.role in ("coordinate", "rows"):
                _put(facts, f"{key}{end}", _plain(one, each))
            else:
                every = facts.setdefault(lists[along], [])
                if one is None:  # not estimated: no number in any row
                    share = dict.fromkeys(units_of(_record_in(type(record), name)), math.nan)
                    shares = [share] * len(every)
                else:
                    shares = _shares(one, each, along, len(every))
                every.extend({} for _ in range(len(shares) - len(every)))
                for row, share in zip(every, shares, strict=True):
                    _put(row, f"{key}{end}", share)
    return facts


def units_of(kind: type) -> Units:
    """Return the unit of every number that :func:`facts_of` makes of a record of this kind, at its place."""
    units: Units = {}
    lists: dict[str, str] = getattr(kind, "json_rows", {})
    for name, each in declarations(kind):
        if each.key is None:
            continue
        inside = _record_in(kind, name) if each.role in ("part", "rows") else None
        unit = units_of(inside) if inside else each.unit if isinstance(each.unit, str) else ""
        along = next((dim for dim in each.dims if dim in lists), None)
        beneath = along is not None and each.role not in ("coordinate", "rows")
        where = units.setdefault(lists[along], {}) if beneath and along else units
        _put(where, each.key or name, unit)
        if _annotation(kind, name) == "Complex":
            _put(where, f"{each.key or name}_imaginary", unit)
    return units


def parameters(kind: type) -> str:
    """Return the section `Parameters` of a docstring, of all fields that are declared."""
    lines = ["Parameters", "----------"]
    for name, annotation in vars(kind).get("__annotations__", {}).items():
        each = getattr(vars(kind).get(name), "metadata", {}).get(_METADATA)
        if each is not None:
            lines += [f"{name} : {_type_words(annotation, each)}", f"    {_sentence(each)}"]
    return "\n".join(lines)


def document(kind: type) -> None:
    """Add the section `Parameters` to a docstring that has none, where fields are declared."""
    text = kind.__doc__ or ""
    section = parameters(kind)
    if "Parameters\n" not in text and section.count("\n") > 1:
        kind.__doc__ = f"{text.rstrip()}\n\n{_indented(section)}\n"


def _indented(section: str) -> str:
    return "\n".join(f"    {line}" for line in section.splitlines())


def _sentence(each: Declaration) -> str:
    words = each.words[:1].upper() + each.words[1:]
    return f"{words}; {each.note}." if each.note else f"{words}."


def _type_words(annotation: str, each: Declaration) -> str:
    kinds = {"Floats": "", "Complex": "complex", "Flags": "bool"}
    base, _, none = annotation.partition(" | None")
    words = kinds.get(base, re.sub(r"tuple\[(\w+), \.\.\.\]", r"tuple of \1", base)) + (" or None" if none or _ else "")
    shape = f"({', '.join(each.dims)}{',' if len(each.dims) == 1 else ''})" if each.dims else ""
    unit = each.unit if isinstance(each.unit, str) else ""
    return ", ".join(filter(None, (" ".join(filter(None, (shape if base in kinds else "", words.strip()))), unit)))


def _annotation(kind: type, name: str) -> str:
    """Return a field's annotation, as it is written; empty of a property."""
    everything = (vars(base).get("__annotations__", {}) for base in kind.__mro__)
    return next((each[name] for each in everything if name in each), "")


def _record_in(kind: type, name: str) -> Any:
    """Return the record that a field's annotation names, such as that of ``tuple[Crossing, ...]``, if any."""
    module = vars(sys.modules[kind.__module__])
    named = (module.get(word) for word in re.findall(r"\w+", _annotation(kind, name)))
    return next((each for each in named if isinstance(each, type) and dataclasses.is_dataclass(each)), None)


def _parts(value: Any) -> list[tuple[str, Any]]:
    """The value, or the real and imaginary part of complex ones, with what their names end in."""
    if np.iscomplexobj(value):
        return [("", value.real), ("_imaginary", value.imag)]
    return [("", value)]


def _plain(value: Any, each: Declaration) -> Any:
    if value is None or each.role == "part":
        return None if value is None else facts_of(value)
    if each.role == "rows":
        return [facts_of(row) for row in value]
    if isinstance(value, tuple):
        return list(value)
    if isinstance(value, np.ndarray):
        if each.dims[-1:] == ("axis",):
            return dict(zip("xyz", value.T.tolist(), strict=True))
        return value.tolist()
    return value.item() if isinstance(value, np.generic) else value


def _put(facts: dict[str, Any], key: str, value: Any) -> None:
    *outer, last = key.split(".")
    for word in outer:
        facts = facts.setdefault(word, {})
    facts[last] = value


def _shares(value: Any, each: Declaration, along: str, count: int) -> list[Any]:
    """Return the share of each row of what stands along a dimension."""
    if each.role == "part":
        facts = facts_of(value)
        return [{name: column[i] for name, column in facts.items()} for i in range(count)]
    at = each.dims.index(along)
    across = dataclasses.replace(each, dims=each.dims[:at] + each.dims[at + 1 :])
    moved = np.moveaxis(value, at, 0) if isinstance(value, np.ndarray) else value
    return [_plain(one, across) for one in moved]
