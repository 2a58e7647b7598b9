"""Errors of pydantic in words for users, with their place in the text and advice."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin

from pydantic import Discriminator, Tag

from gbeam.guards.kinds import KINDS
from gbeam.guards.quantities import Quantity
from gbeam.guards.units import spoken
from gbeam.printable import advise
from gbeam.scenario.schema import kind_of_scenario
from gbeam.scenario.schema.fields import TAGS, Table, annotation_parts, fields_of, parts_of
from gbeam.scenario.text.diagnostics import Diagnostic
from gbeam.scenario.text.source import Mark, Source
from gbeam.scenario.values import Path

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo
    from pydantic_core import ErrorDetails

# Names, not any words in braces: a message may quote a user's text with braces in it.
_PLACEHOLDER = re.compile(r"\{(value|beam\.length|response\.duration)\}")
_NOT_A = {
    "int_type": ("a whole number", "write it such as 3"),
    "bool_type": ("true or false", "write true or false, without quotes"),
    "string_type": ("text", "write it in quotes"),
    "tuple_type": ("a list", "write it such as [ ..., ... ]"),
}


def explain(source: Source, error: ErrorDetails) -> Diagnostic:
    """Translate one error of pydantic."""
    path = _path(error["loc"], source)
    message, hint, mark, path = _words(source, error, path)
    return source.diagnostic(path, _filled(source, path, message), _filled(source, path, hint), mark)


def _words(source: Source, error: ErrorDetails, path: Path) -> tuple[str, str, Mark, Path]:
    """Message, hint, mark (whether the caret stands under the key or the value), and path of the error."""
    problem_kind, context = error["type"], error.get("ctx", {})
    field = _field(source, path)
    value = source.raw(path)
    if problem_kind == "value_error":  # of a quantity
        return context["error"].problem, context["error"].hint, "value", path
    if problem_kind == "scenario":
        return context["message"], context["hint"], context["mark"], path
    if problem_kind == "missing" and isinstance(path[-1], int):  # a tuple of fixed length
        parts = annotation_parts(field.annotation if field else None)
        count = next((len(get_args(part)) for part in parts if get_origin(part) is tuple), 3)
        return (
            f"has {path[-1]} entries",
            "give three: x, y and z" if count == 3 else f"give {count}",
            "value",
            path[:-1],
        )
    if problem_kind == "missing":
        return f"{path[-1]} is missing", _add(str(path[-1]), field), "key", path[:-1]
    if problem_kind == "extra_forbidden":
        table = _table(source, path[:-1])
        names = fields_of(table) if table else {}
        return "unknown key", advise(str(path[-1]), names, listed="the keys here are"), "key", path
    if problem_kind in ("union_tag_invalid", "union_tag_not_found") and isinstance(value, dict):
        tag, choices = _choices(field)
        if problem_kind == "union_tag_not_found":
            return f"{tag} is missing", f"choose one of {', '.join(choices)}", "key", path
        return "unknown choice {value}", advise(context["tag"], choices), "value", (*path, tag)
    if problem_kind == "literal_error":
        choices = [str(choice) for choice in _literals(field.annotation if field else None)]
        return "unknown choice {value}", advise(str(value), choices), "value", path
    if problem_kind in ("too_short", "too_long"):
        limit = context.get("min_length", context.get("max_length"))
        count = context["actual_length"]
        bound = "at least" if problem_kind == "too_short" else "at most"
        return f"has {count} {'entry' if count == 1 else 'entries'}", f"give {bound} {limit}", "value", path
    if problem_kind == "greater_than_equal":
        size = f"below {context['ge']}" if context["ge"] else "negative"
        return f"{{value}} is {size}", f"give {context['ge']} or more", "value", path
    if problem_kind == "less_than_equal":
        return "{value} is more than is computed", f"give {context['le']} or less", "value", path
    if problem_kind in _NOT_A:
        return f"{spoken(value)} is not {_NOT_A[problem_kind][0]}", _NOT_A[problem_kind][1], "value", path
    # All other errors are of a value where a table belongs.
    description = field.description if field else ""
    return f"{spoken(value)} is not a table", f"give a table: {description}", "value", path


def _path(loc: tuple[int | str, ...], source: Source) -> Path:
    """Path in the file of a place that pydantic gives, without the tags of unions that it contains."""
    path: Path = ()
    node: Any = source.data
    untagged = True  # no tag of a union has come since the last step of the path
    for step in loc:
        if step == "[key]":
            continue
        if isinstance(node, dict):
            if untagged and step == _tag(_field(source, path), node):
                untagged = False
                continue
        elif step in ("one", "list"):
            continue
        path += (step,)
        node = source.raw(path)
        untagged = True
    return path


def _tag(field: FieldInfo | None, node: dict[str, Any]) -> object:
    """Return the tag by which pydantic tells a table `node` of a union, which stands in places below it; else None."""
    marks = (part.discriminator for part in parts_of(field) if isinstance(part, Discriminator))
    key = next(marks, "profile")
    return key(node) if callable(key) else node.get(key)


def _field(source: Source, path: Path) -> FieldInfo | None:
    """Return the declaration of the field that holds `path`; that of the list for an entry of a list."""
    while path and isinstance(path[-1], int):
        path = path[:-1]
    if not path:
        return None
    if _is_named(source, path):
        return _field(source, path[:-1])
    table = _table(source, path[:-1])
    return fields_of(table).get(str(path[-1])) if table else None


def _is_named(source: Source, path: Path) -> bool:
    """True if the last step of a path is a name that the user gave, such as a motion's."""
    if len(path) < 2 or isinstance(path[-1], int):
        return False
    field = _field(source, path[:-1])
    return field is not None and get_origin(field.annotation) is dict and not _is_named(source, path[:-1])


def _table(source: Source, path: Path) -> type[Table] | None:
    """Return the class of the table at `path`, as chosen by the kind, profile or shape written there."""
    if not path:
        return kind_of_scenario(source.data)
    field = _field(source, path)
    raw = source.raw(path)
    keys = raw if isinstance(raw, dict) else {}
    tables = list(_tables(field.annotation if field else None))
    tag_of = {tag: table for tag, table in _tagged(field.annotation if field else None)}
    chosen = tag_of.get(str(_tag(field, keys)))
    if chosen is not None:
        return chosen
    for table in tables:
        for tag in TAGS:
            if tag in table.model_fields:
                names = list(_literals(table.model_fields[tag].annotation))
                if keys.get(tag, table.model_fields[tag].default) in names:
                    return table
    return tables[0] if len(tables) == 1 else None


def _tables(annotation: Any) -> Iterator[type[Table]]:
    for part in annotation_parts(annotation):
        if isinstance(part, type) and issubclass(part, Table):
            yield part


def _tagged(annotation: Any) -> Iterator[tuple[str, type[Table]]]:
    """Tables of a union by their tags."""
    for part in annotation_parts(annotation):
        if get_origin(part) is Annotated:
            table, *marks = get_args(part)
            if isinstance(table, type) and issubclass(table, Table):
                yield from ((mark.tag, table) for mark in marks if isinstance(mark, Tag))


def _literals(annotation: Any) -> Iterator[Any]:
    for part in annotation_parts(annotation):
        if get_origin(part) is Literal:
            yield from get_args(part)


def _choices(field: FieldInfo | None) -> tuple[str, list[str]]:
    """Name of the key that picks among the tables of a union, and its possible values."""
    tables = list(_tables(field.annotation if field else None))
    tag = next(tag for tag in TAGS if tag in tables[0].model_fields)
    names: list[str] = []
    for table in tables:
        names += _literals(table.model_fields[tag].annotation)
    return tag, names


def _quantity(field: FieldInfo | None) -> Quantity | None:
    return next((part for part in parts_of(field) if isinstance(part, Quantity)), None)


def _add(key: str, field: FieldInfo | None) -> str:
    description = field.description if field else ""
    quantity = _quantity(field) if field and get_origin(field.annotation) is not tuple else None
    if quantity is None:
        return f"add {key}: {description}"
    return f'add {key} = "{KINDS[quantity.kind].example}": {description}'


def _filled(source: Source, path: Path, text: str) -> str:
    """Replace ``{value}``, ``{beam.length}`` and the like by what is written in the file."""

    def replacement(match: re.Match[str]) -> str:
        place = path if match[1] == "value" else tuple(match[1].split("."))
        raw = source.raw(place)
        quantity = _quantity(_field(source, place))
        if quantity is None or raw is None:
            return spoken(raw)
        return raw if isinstance(raw, str) else f"{raw:g} {KINDS[quantity.kind].unit}".rstrip()

    return _PLACEHOLDER.sub(replacement, text)
