"""The quantities that a scenario holds, each with its path, value and kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from gbeam.scenario.schema.common.fields import kind_of
from gbeam.scenario.values.paths import Path, path_text


def quantities(table: BaseModel) -> dict[str, tuple[float, str]]:
    """Value in SI and kind, a key of ``KINDS``, of every quantity of a scenario, by its path."""
    return {path_text(path): (value, kind) for path, value, kind in _of(table, ())}


def _of(node: Any, path: Path) -> Iterator[tuple[Path, float, str]]:
    if isinstance(node, BaseModel):
        for key in type(node).model_fields:
            value, kind = getattr(node, key), kind_of(node, key)
            yield from _numbers(value, (*path, key), kind) if kind else _of(value, (*path, key))
    elif isinstance(node, Mapping):
        for key, value in node.items():
            yield from _of(value, (*path, key))
    elif isinstance(node, tuple):
        for index, value in enumerate(node):
            yield from _of(value, (*path, index))


def _numbers(value: Any, path: Path, kind: str) -> Iterator[tuple[Path, float, str]]:
    if isinstance(value, tuple):
        for index, each in enumerate(value):
            yield from _numbers(each, (*path, index), kind)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, float(value), kind
