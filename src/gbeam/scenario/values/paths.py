"""Paths of values in a scenario, and suggestions for a misspelt one."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
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


def closest(word: str, choices: Iterable[str]) -> str | None:
    """Return the choice that `word` was probably meant to be, or None; case does not count."""
    from difflib import get_close_matches  # needed only where something is wrong

    lowered: dict[str, str] = {}
    for choice in choices:
        lowered.setdefault(choice.lower(), choice)
    near = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return lowered[near[0]] if near else None


def advise(word: str, choices: Iterable[str], *, listed: str = "choose one of") -> str:
    """Return ``did you mean 'thickness'?``, or the list of choices when none is near."""
    possible = list(choices)
    near = closest(word, possible)
    return f"did you mean {near!r}?" if near else f"{listed} {', '.join(possible)}"
