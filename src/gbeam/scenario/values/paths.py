"""Paths of values in a scenario."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

Path = tuple[str | int, ...]

_STEP = re.compile(r"([^.\[\]=\s]+)((?:\[[0-9]{1,9}\])*)")


@dataclass(frozen=True)
class Span:
    """A stretch of one line: `line` and `column` count from 1, in characters; `end` is past its last."""

    line: int
    column: int
    end: int


@dataclass(frozen=True)
class Place:
    """Place of an entry: its key (an element of a list has its value's place) and its value.

    A table written under a ``[header]`` has the header's name for both.
    """

    key: Span
    value: Span


def path_text(path: Path) -> str:
    """Write a path: ``("beam", "masses", 0, "at")`` is ``beam.masses[0].at``."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    return text.removeprefix(".")


def parse_path(text: str) -> Path | None:
    """Read a path; None if `text` is not one."""
    path: Path = ()
    for part in text.split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            return None
        path += (match[1], *(int(index) for index in re.findall(r"\d+", match[2])))
    return path


def walk(node: Any, closed: Callable[[Any], bool], path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield path and value of all but tables and lists, and of those that are closed."""
    if closed(node) or not isinstance(node, (dict, list)):
        yield path, node
        return
    for step, value in node.items() if isinstance(node, dict) else enumerate(node):
        yield from walk(value, closed, (*path, step))


def written_at(data: Any, path: Path) -> Any:
    """Return what a parsed scenario holds at `path`, None if nothing."""
    for step in path:
        try:
            data = data[step]
        except (LookupError, TypeError):
            return None
    return data
