"""Sections of a record: stretches of its file that a column numbers or names, such as the manoeuvres of a campaign."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.io.table import Table, as_word
from gbeam.motion.records.conditioning import FEWEST
from gbeam.printable import advise
from gbeam.results.description import Section

_MOST = 500  # sections of a file
_LISTED = 20  # in a message


@dataclass(frozen=True)
class Sections:
    """Column of a record whose value stays the same through each section."""

    column: str
    names: tuple[str, ...]  # of the sections in the order of the samples
    stretches: tuple[slice, ...]  # their samples
    clock: Floats  # (t,) s

    @classmethod
    def read(cls, table: Table, column: str, clock: Floats) -> Sections:
        """Read the sections of a column, which numbers or names them. Samples with an empty cell belong to none."""
        values = table.cells("sections", column)
        if len(values) != len(clock):
            problem = f"column {column!r} has {len(values)} samples, the time {len(clock)}"
            raise InputError("record.sections", problem, "name another")
        edges = np.flatnonzero(np.r_[True, values[1:] != values[:-1], True])
        if len(edges) > _MOST + 1:
            problem = f"names {column!r}, which changes {len(edges) - 2} times and numbers no sections"
            raise InputError("record.sections", problem, "name a column that stays the same through each section")
        runs = [slice(i, j) for i, j in pairwise(edges.tolist())]
        sections = [(str(values[run.start]), run) for run in runs if str(values[run.start]) not in ("", "nan")]
        return cls(column, tuple(name for name, _ in sections), tuple(run for _, run in sections), clock)

    def part(self, section: str, within: slice, counted: Callable[[int], str]) -> tuple[slice, slice]:
        """Return the samples of a section within a part of the record, and all samples of the section.

        InputError if the section is unknown, or lies in several stretches of the part, or in too few samples.
        """
        section = as_word(section)
        if section not in self.names:
            names = list(dict.fromkeys(self.names))
            rest_words = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
            fix = advise(section, names[:_LISTED], listed=f"column {self.column!r} has") + rest_words
            raise InputError("record.section", f"is {section}, which no section is", fix)
        runs = [run for name, run in zip(self.names, self.stretches, strict=True) if name == section]
        parts = [(slice(max(run.start, within.start), min(run.stop, within.stop)), run) for run in runs]
        inside = [(part, run) for part, run in parts if part.stop > part.start]
        if len(inside) > 1:
            listed = [f"{start:.6g} to {end:.6g} s" for start, end in (self.ends(part) for part, _ in inside[:_LISTED])]
            start, end = self.ends(max((part for part, _ in inside), key=lambda part: part.stop - part.start))
            fix = f'add from = "{start:.12g} s", to = "{end:.12g} s", or those of another'
            problem = f"is {section}, which stands in {len(inside)} stretches: {', '.join(listed)}"
            raise InputError("record.section", problem, fix)
        count = inside[0][0].stop - inside[0][0].start if inside else 0
        if count < FEWEST:
            fix = f"name a section of {FEWEST} samples or more" if inside else "give a from and to that it is within"
            raise InputError("record.section", f"is {section}, of which {counted(count)} are flown", fix)
        return inside[0]

    def ends(self, run: slice) -> tuple[float, float]:
        """Return first and last time of some samples, s."""
        return float(self.clock[run].min()), float(self.clock[run].max())

    def listed(self) -> Iterator[Section]:
        """Yield the sections with their times."""
        for name, run in zip(self.names, self.stretches, strict=True):
            yield Section(name, *self.ends(run))
