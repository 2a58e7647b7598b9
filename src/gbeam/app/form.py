"""The form of a scenario: every key of the schema, with its value in the text and its description."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

from gbeam.scenario.reference import tag_of
from gbeam.scenario.schema import kind_of_scenario
from gbeam.scenario.template import json_schema
from gbeam.scenario.text.overrides import value_of
from gbeam.scenario.text.revise import toml
from gbeam.scenario.values import Path, path_text, written_at

Node = dict[str, Any]
LISTED = 40  # tables of a list that the form shows
LONGEST = 1000  # characters of a value that the form shows; longer ones are edited as text


def form(data: Any) -> list[Node]:
    """Return the entries of a parsed scenario: `path`, `key`, `help`, `required`, `written`, and by kind

    - ``value``: its text, `default`, `example`, SI `unit` of a bare number, the `options` that it is one of, and as
      `tables` those of a table that it may be too;
    - ``table``: the entries `inside`, and the `choice` among the `options` where it is one of several tables;
    - ``list`` and ``named`` (tables by names that the user gives): tables `inside`, and the `options` of a new one.
    """
    tables = data if isinstance(data, dict) else {}
    return _entries(_top(tables), tables, ())


def known_at(path: Path, data: Any) -> bool:
    """True if the schema has a key at a path whose value may be something else than tables."""
    schema = _schema_at(path, data)
    tables = _tables(schema)
    plain_alternatives = [alternative for alternative in _alternatives(schema) if alternative not in tables]
    return bool(schema) and not all(map(_names_tables, plain_alternatives))


def value_at(path: Path, data: Any, text: str) -> Any:
    """Read a value typed into a field as `--set` does; as text if the schema allows only text."""
    kinds = {alternative.get("type", "string") for alternative in _alternatives(_schema_at(path, data))}
    return text if kinds == {"string"} else value_of(text)


def new_table(path: Path, data: Any, choice: str) -> dict[str, Any]:
    """Return a table of a kind, with the values of the table at its place whose keys both kinds have."""
    tables = _tables(_schema_at(path, data))
    table = {tag_of(table)[1]: table for table in reversed(tables)}[choice]
    value_before = written_at(data, path)
    values = value_before if isinstance(value_before, dict) else {}
    key = tag_of(table)[0]
    common = {name: value for name, value in values.items() if name in table["properties"] and name != key}
    return {key: choice} | common if key else common


@cache
def file_keys() -> frozenset[str]:
    """Keys of the schema that name files."""
    tables = (definition.get("properties", {}) for definition in _schema()["$defs"].values())
    return frozenset(key for table in tables for key, schema in table.items() if "'file-path'" in repr(schema))


@cache
def _schema() -> Node:
    schema: Node = json.loads(json_schema(distributions=False))
    return schema


def _top(data: dict[str, Any]) -> Node:
    """Schema of the whole scenario, with the keys of its kind: of a beam, a specimen or a system."""
    schema = _schema()
    keys = kind_of_scenario(data).model_fields.keys()
    required = (alternative["required"] for alternative in schema["anyOf"])
    return schema | {
        "properties": {key: entry for key, entry in schema["properties"].items() if key in keys},
        "required": next(names for names in required if keys >= set(names)),
    }


def _entries(table: Node, data: dict[str, Any], path: Path) -> list[Node]:
    """Entries of a table: those of the schema, then keys of the text that it does not have."""
    tag = tag_of(table)[0]
    required = table.get("required", ())
    keys = table["properties"]
    entries = [
        _entry(schema, data, (*path, key), required=key in required) for key, schema in keys.items() if key != tag
    ]
    return entries + [_entry({}, data, (*path, key), required=False) for key in data if key not in keys]


def _entry(schema: Node, parent: Any, path: Path, *, required: bool) -> Node:
    """Entry of the form for a key, or an element of a list, in the data of its parent: see `form`."""
    key = path[-1]
    written = key in parent if isinstance(parent, dict) else True
    raw = parent[key] if written else None
    node: Node = {"path": path_text(path), "key": str(key), "required": required, "written": written}
    node["help"] = schema.get("description", "")
    alternatives = [*_alternatives(schema)]
    listed = [kind["items"] for kind in alternatives if "items" in kind and _tables(kind["items"])]
    by_name = [kind["additionalProperties"] for kind in alternatives if _names_tables(kind)]
    tables = _tables(schema)
    if by_name:  # tables by names that the user gives
        children = raw if isinstance(raw, dict) else {}
        entries = [_entry(by_name[0], children, (*path, name), required=False) for name in children]
        return node | {"kind": "named", "options": _words(by_name[0]), "inside": entries}
    if listed and (raw is None or isinstance(raw, list)):
        count = len(raw or ())
        entries = [_entry(listed[0], raw, (*path, i), required=False) for i in range(min(count, LISTED))]
        return node | {"kind": "list", "options": _words(listed[0]), "inside": entries, "count": count}
    if tables and (isinstance(raw, dict) or len(tables) == len(alternatives)):
        return node | _table(schema, tables, raw, path)
    return node | _value(schema, alternatives, raw) | {"tables": _words(schema)}


def _table(schema: Node, tables: list[Node], raw: Any, path: Path) -> Node:
    table = _table_of(tables, raw)
    entries: list[Node] = []
    choice = description = ""
    if table is not None and isinstance(raw, dict):
        entries, choice = _entries(table, raw, path), tag_of(table)[1]
    if table is not None and len(tables) > 1:
        description = table.get("description", "")
    return {"kind": "table", "options": _words(schema), "choice": choice, "about": description, "inside": entries}


def _value(schema: Node, alternatives: list[Node], raw: Any) -> Node:
    """Fields of an entry that is a value: see `form`. Text is shown as it is, anything else as TOML."""
    text, default = _as_text(raw), schema.get("default")
    literals = [[*_literals(kind)] for kind in alternatives]
    only_literals = bool(literals) and all(literals)
    examples = [example for kind in alternatives for example in kind.get("examples", ())]
    units = [quantity["x-unit"] for quantity in _quantities(schema)]
    return {
        "kind": "value",
        "value": text if len(text) <= LONGEST else "",
        "long": len(text) > LONGEST,
        "default": "" if default in ([], {}) else _as_text(default),
        "example": examples[0] if examples else "",
        "unit": units[0] if units else "",
        "options": [str(word) for words in literals for word in words] if only_literals else [],
    }


def _as_text(value: Any) -> str:
    """A value as the form shows it: text as it is, anything else as TOML, nothing for None."""
    if value is None:
        return ""
    return value if isinstance(value, str) else toml(value)


def _literals(schema: Node) -> Iterator[str]:
    if schema.get("type") == "boolean":
        yield from ("true", "false")
    yield from schema.get("enum", [schema["const"]] if "const" in schema else [])


def _quantities(schema: Node) -> Iterator[Node]:
    if "x-quantity" in schema:
        yield schema
    for alternative in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("prefixItems", ())):
        yield from _quantities(alternative)
    if "items" in schema:
        yield from _quantities(schema["items"])


def _words(schema: Node) -> list[str]:
    """Words of the kinds of table that a schema allows, or "" for tables that only their keys tell apart."""
    return [*dict.fromkeys(tag_of(table)[1] for table in _tables(schema))]


def _tables(schema: Node) -> list[Node]:
    return [alternative for alternative in _alternatives(schema) if "properties" in alternative]


def _table_of(tables: list[Node], raw: Any) -> Node | None:
    """Schema of the table that is written, by the word of its kind and its keys, or None if no kind has that word."""
    keys = raw if isinstance(raw, dict) else {}
    fitting = []
    for table in tables:
        key, word = tag_of(table)
        if len(tables) == 1 or not key or keys.get(key, table["properties"][key].get("default")) == word:
            fitting.append(table)
    return max(fitting, key=lambda table: len(table["properties"].keys() & keys.keys()), default=None)


def _names_tables(schema: Node) -> bool:
    inner = schema.get("additionalProperties")
    return isinstance(inner, dict) and bool(_tables(inner))


def _alternatives(schema: Node) -> Iterator[Node]:
    """Schemas of all alternatives that a schema allows, but null."""
    if "properties" in schema:
        yield schema
    elif "$ref" in schema:
        yield from _alternatives(_schema()["$defs"][schema["$ref"].rpartition("/")[2]])
    elif "anyOf" in schema or "oneOf" in schema:
        for alternative in (*schema.get("anyOf", ()), *schema.get("oneOf", ())):
            yield from _alternatives(alternative)
    elif schema.get("type") != "null":
        yield schema


def _schema_at(path: Path, data: Any) -> Node:
    """Schema at a path, of the tables that are written in `data`, or empty if they have no such key."""
    schema, raw = _schema(), data
    for step in path:
        tables = _tables(schema)
        table = _table_of(tables, raw) if tables else None
        alternatives = [*_alternatives(schema)]
        if isinstance(step, int):
            schema = next((alternative["items"] for alternative in alternatives if "items" in alternative), {})
        elif table is not None:
            schema = table["properties"].get(step, {})
        else:
            mapping = next((alternative for alternative in alternatives if "additionalProperties" in alternative), {})
            inner = mapping.get("additionalProperties")
            schema = inner if isinstance(inner, dict) else {}
        raw = written_at(raw, (step,))
    return schema
