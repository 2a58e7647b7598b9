"""``--set key=value``: change a scenario without editing its file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.paths import parse_path, path_text
from gbeam.scenario.text.place import Path


@dataclass(frozen=True)
class Override:
    """One ``key=value``: its `text`, the `path` of its key and its `value`."""

    text: str
    path: Path
    value: Any


class _Refused(ValueError):
    """An override that cannot be applied: message and hint."""


def override(data: dict[str, Any], name: str, texts: Iterable[str]) -> tuple[dict[str, Any], tuple[Override, ...]]:
    """Return `data` with the overrides in it, and the overrides as read.

    Parameters
    ----------
    data : dict
        A parsed scenario; not changed.
    name : str
        Name of the scenario's file, for messages.
    texts : iterable of str
        Such as ``beam.masses[0].mass=0.2 kg``. A value that reads as a TOML number, boolean, list or inline
        table is one; anything else is text.

    Raises
    ------
    ScenarioError
        For all overrides that have no place in the scenario. Whether a key exists is for the schema to say.
    """
    changed = deepcopy(data)
    done: list[Override] = []
    refused: list[Diagnostic] = []
    for text in texts:
        try:
            it = _read(text)
            _write(changed, it)
            done.append(it)
        except _Refused as error:
            message, hint = error.args
            refused.append(Diagnostic(name, "", message, hint, override=text))
    if refused:
        raise ScenarioError(refused)
    return changed, tuple(done)


def _read(text: str) -> Override:
    key, equals, value = text.partition("=")
    path = parse_path(key.strip())
    if not equals or path is None:
        raise _Refused("is not key=value", 'write it such as --set "beam.length=250 mm"')
    return Override(text, path, _value(value.strip()))


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    value = parsed.get("value")
    is_one_value = len(parsed) == 1 and isinstance(value, (bool, int, float, str, list, dict))  # not a date
    return value if is_one_value else text


def _write(data: dict[str, Any], it: Override) -> None:
    here: Any = data
    for i, step in enumerate(it.path):
        above = path_text(it.path[:i])
        if isinstance(step, int):
            if not isinstance(here, list):
                raise _Refused(f"{above} is not a list", "leave the index out")
            if step >= len(here):
                count = f"{len(here)} {'entry' if len(here) == 1 else 'entries'}"
                raise _Refused(f"{above} has {count}", "the first is [0]; set the whole list to add to it")
        elif not isinstance(here, dict):
            raise _Refused(f"{above} is {'a list' if isinstance(here, list) else 'not a table'}", "check the key")
        if i == len(it.path) - 1:
            here[step] = it.value
        elif isinstance(step, str):
            # A table that is not there yet: the schema will say if it may not be.
            here = here.setdefault(step, [] if isinstance(it.path[i + 1], int) else {})
        else:
            here = here[step]
