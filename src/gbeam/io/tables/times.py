"""Times of day as a column of times: 12:34:56.789, with a date or the day of the year, 2024-05-03T12:34:56Z."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

CLOCK = (
    r"(?:(?P<date>\d{4}-\d\d-\d\d)(?:T| +)|(?P<day>\d{1,3}):)?"
    r"(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d):(?P<second>[0-5]\d|60)(?:[.,](?P<fraction>\d{1,9}))?"
    r" ?(?:Z|UTC|(?P<ahead>[+-]\d\d):?(?P<also>\d\d)?)?"
)
_CLOCK = re.compile(CLOCK)
_SECOND, _DAY = 10**9, 86_400 * 10**9  # ns
_Reading = tuple[int | None, int]  # the day, where it is known, and ns from its midnight


@dataclass(frozen=True)
class Clock:
    """A clock of which a record's first time is zero seconds."""

    first: str  # that time, as the file has it

    def seconds(self, text: str) -> float | None:
        """Seconds from the first time to that of a text, the next of its kind where a date is missing; None if none."""
        first, now = _reading(self.first), _reading(text)
        return None if first is None or now is None else _since(first, now) / _SECOND


def is_clock(text: str) -> bool:
    """Whether a text is a time of day."""
    return _CLOCK.fullmatch(text) is not None


def read_clock(cells: Sequence[str]) -> tuple[Clock, NDArray[np.float64]] | None:
    """The clock of a column and its times, s, NaN where a cell is none; None where the first is none."""
    first = _reading(cells[0]) if len(cells) else None
    if first is None:
        return None
    readings = (_reading(cell) for cell in cells)
    since = [np.nan if one is None else _since(first, one) / _SECOND for one in readings]
    return Clock(cells[0]), np.array(since)


def _since(first: _Reading, now: _Reading) -> int:
    passed = now[1] - first[1]
    return passed % _DAY if first[0] is None or now[0] is None else (now[0] - first[0]) * _DAY + passed


def _reading(text: str) -> _Reading | None:
    match = _CLOCK.fullmatch(text)
    if match is None:
        return None
    day = _day(match["date"]) if match["date"] else int(match["day"]) if match["day"] else None
    if match["date"] and day is None:
        return None
    ahead = match["ahead"] or "+0"
    minutes = int(match["minute"]) - (60 * int(ahead) + int(f"{ahead[0]}{match['also'] or 0}"))
    seconds = 3600 * int(match["hour"]) + 60 * minutes + int(match["second"])
    return day, seconds * _SECOND + int((match["fraction"] or "").ljust(9, "0"))


@lru_cache(maxsize=2)  # days of a record
def _day(text: str) -> int | None:
    try:
        return date.fromisoformat(text).toordinal()
    except ValueError:
        return None
