"""The values of a scenario, one by one, with what the schema says of each."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

from gbeam.scenario import json_schema
from gbeam.scenario.values.paths import path_text


def leaves(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Paths and values of what is no table and no list of tables."""
    if isinstance(node, dict):
        for key, each in node.items():
            yield from leaves(each, (*path, key))
    elif isinstance(node, list) and any(isinstance(each, (dict, list)) for each in node):
        for i, each in enumerate(node):
            yield from leaves(each, (*path, i))
    elif path:
        yield path, node


def fields(data: Any) -> Iterator[dict[str, Any]]:
    """Every value of a parsed scenario: its path, its text, and what the schema says of its key."""
    for path, value in leaves(data):
        if isinstance(value, list):
            continue
        shown = value if isinstance(value, str) else json.dumps(value)
        yield {"path": path_text(path), "value": shown, "help": _help(tuple(path))}


@cache
def _schema() -> dict[str, Any]:
    schema: dict[str, Any] = json.loads(json_schema())
    return schema


def _help(path: tuple[Any, ...]) -> str:
    """What the schema says of a key; empty where it says nothing, or not only one thing."""
    nodes = [_schema()]
    words = ""
    for step in path:
        nexts = [each for node in nodes for each in _inside(node, step)]
        words = next((str(each["description"]) for each in nexts if "description" in each), "")
        nodes = nexts
    return words


def _inside(node: dict[str, Any], step: Any) -> Iterator[dict[str, Any]]:
    """The schemas of what is inside, of every alternative."""
    for each in _alternatives(node):
        if isinstance(step, int):
            if isinstance(each.get("items"), dict):
                yield each["items"]
        elif step in each.get("properties", {}):
            yield each["properties"][step]
        elif isinstance(each.get("additionalProperties"), dict):
            yield each["additionalProperties"]


def _alternatives(node: dict[str, Any]) -> Iterator[dict[str, Any]]:
    if "$ref" in node:
        yield from _alternatives(_schema()["$defs"][node["$ref"].rsplit("/", 1)[-1]])
    for each in (*node.get("anyOf", ()), *node.get("oneOf", ()), *node.get("allOf", ())):
        yield from _alternatives(each)
    yield node
