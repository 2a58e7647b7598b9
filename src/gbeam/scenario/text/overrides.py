"""``--set key=value``: change a scenario without editing its file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from gbeam.guards.limits import NESTING
from gbeam.scenario.text.bounds import excess
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.values.paths import Path, parse_path, path_text


@dataclass(frozen=True)
class Override:
    """One ``key=value``: its `text`, the `path` of its key and its `value`."""

    text: str
    path: Path
    value: Any


class _Refused(ValueError):
    """An override that cannot be applied: message and hint."""


def override(data: dict[str, Any], name: str, texts: Iterable[str]) -> tuple[dict[str, Any], tuple[Override, ...]]:
    """Return `data` with the overrides in it, and the overrides as read."""
    changed = deepcopy(data)
    done: list[Override] = []
    refused: list[Diagnostic] = []
    for text in texts:
        try:
            change = _read(text)
            _write(changed, change)
            done.append(change)
        except _Refused as error:
            message, hint = error.args
            refused.append(Diagnostic(name, "", message, hint, override=text))
    if refused:
        raise ScenarioError(refused)
    return changed, tuple(done)


def _read(text: str) -> Override:
    key, equals, value = text.partition("=")
    path = parse_path(key.strip())
    if path is not None and len(path) > NESTING:
        raise _Refused(f"has more than {NESTING} tables or lists in one another", "shorten the key")
    if not equals or path is None:
        raise _Refused("is not key=value", 'write it such as --set "beam.length=250 mm"')
    return Override(text, path, value_of(value.strip()))


def value_of(text: str) -> Any:
    """A TOML number, boolean, list or inline table where the text reads as one; else the text itself."""
    beyond = excess(text)
    if beyond is not None:
        _, problem, fix = beyond
        raise _Refused(problem, fix)
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    value = parsed.get("value")
    is_one_value = len(parsed) == 1 and isinstance(value, (bool, int, float, str, list, dict))  # not a date
    return value if is_one_value else text


def _write(data: dict[str, Any], change: Override) -> None:
    node: Any = data
    for i, step in enumerate(change.path):
        above = path_text(change.path[:i])
        if isinstance(step, int):
            if not isinstance(node, list):
                raise _Refused(f"{above} is not a list", "leave the index out")
            if step >= len(node):
                count = f"{len(node)} {'entry' if len(node) == 1 else 'entries'}"
                raise _Refused(f"{above} has {count}", "the first is [0]; set the whole list to add to it")
        elif not isinstance(node, dict):
            raise _Refused(f"{above} is {'a list' if isinstance(node, list) else 'not a table'}", "check the key")
        if i == len(change.path) - 1:
            node[step] = change.value
        elif isinstance(step, str):
            # A table that does not exist yet: the schema will say if it may not be.
            node = node.setdefault(step, [] if isinstance(change.path[i + 1], int) else {})
        else:
            node = node[step]
