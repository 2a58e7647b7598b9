"""The quantities that a scenario holds, each with its path, value and kind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from gbeam.scenario.schema.common.fields import fields_of, kind_of
from gbeam.scenario.values.paths import Path, path_text


def quantities(table: BaseModel) -> dict[str, tuple[float, str]]:
    """Value in SI and kind, a key of ``KINDS``, of every quantity of a scenario, by its path."""
    return {path_text(path): (value, kind) for path, value, kind in _of(table, (), "")}


def _of(node: Any, path: Path, kind: str) -> Iterator[tuple[Path, float, str]]:
    if isinstance(node, BaseModel):
        for key, name in zip(fields_of(type(node)), type(node).model_fields, strict=True):
            yield from _of(getattr(node, name), (*path, key), kind_of(node, key))
    elif isinstance(node, Mapping):
        for key, value in node.items():
            yield from _of(value, (*path, key), kind)
    elif isinstance(node, tuple):
        for index, value in enumerate(node):
            yield from _of(value, (*path, index), kind)
    elif kind and isinstance(node, (int, float)) and not isinstance(node, bool):
        yield path, float(node), kind
