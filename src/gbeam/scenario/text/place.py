"""Positions in a text."""

from __future__ import annotations

from dataclasses import dataclass

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Span:
    """A stretch of one line: `line` and `column` count from 1, in characters; `end` is past its last."""

    line: int
    column: int
    end: int


@dataclass(frozen=True)
class Place:
    """Where an entry stands: its key (an element of a list has its value's place) and its value.

    A table written under a ``[header]`` has the header's name for both.
    """

    key: Span
    value: Span
