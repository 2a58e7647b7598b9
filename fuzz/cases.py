"""A case: the files and the command line that are tried."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[1]
Random = random.Random


@dataclass(frozen=True)
class Case:
    """One input.

    Parameters
    ----------
    kind : str
        What was made malformed: ``scenario``, ``record``, ``fixes``, ``body``, ``command``, ``result``, ``sweep`` or
        ``app``.
    arguments : list of str
        Of the command line.
    files : dict of str to bytes
        By name, in the folder that the command runs in.
    """

    kind: str
    arguments: list[str]
    files: dict[str, bytes] = field(default_factory=dict)


def make(seed: int, number: int, kinds: dict[str, Callable[[Random], Case]]) -> Case:
    """The case of a number: the same for the same seed, whatever ran before."""
    chosen = random.Random(f"{seed}/{number}")
    return kinds[chosen.choices(list(kinds), [WEIGHTS[kind] for kind in kinds])[0]](chosen)


WEIGHTS = {"scenario": 6, "record": 3, "fixes": 1, "body": 4, "command": 2, "result": 3, "sweep": 2, "app": 2}
