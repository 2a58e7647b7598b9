"""Summary of a record in numbers, and its oddities, which are flown all the same."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion.bases.conditioning import Floats, flat_tops
from gbeam.motion.records.soundness import LEVEL, Samples, rows
from gbeam.numerics.samples import true_runs
from gbeam.results.description import Level, RecordSummary, Vector

_ALONG = 0.7  # of the largest load: within 45° of the beam
_LISTED = 4  # flat tops


def summary(
    record: Samples, file: str, whole: tuple[float, float], clock: str, notes: tuple[str, ...]
) -> RecordSummary:
    """Summarise a record."""
    time, load = record.time, record.load
    top = int(np.linalg.norm(load, axis=1).argmax())
    first, last = float(time[0]), float(time[-1])
    x, y, z = record.names.values()
    return RecordSummary(
        file=file,
        columns=(x, y, z),
        quantity="specific-force" if record.specific else "acceleration",
        samples=len(time),
        rate=(len(time) - 1) / (last - first),
        span=(first, last),
        whole=whole,
        smallest=_vector(load.min(axis=0)),
        largest=_vector(load.max(axis=0)),
        peak=_vector(load[top]),
        time_of_peak=float(time[top]),
        level=_level(record) if record.specific else None,
        clock=clock,
        notes=notes,
    )


def oddities(record: Samples) -> Iterator[str]:
    """Say where a sensor seems to have been at the end of its range, and whether the load is along the beam."""
    for (axis, name), values in zip(record.names.items(), record.load.T, strict=True):
        for extreme, runs in flat_tops(values):
            listed = ", ".join(
                f"{record.time[run.start]:g} to {record.time[run.stop - 1]:g} s "
                f"({rows(record.place(run.start), record.place(run.stop - 1))})"
                for run in runs[:_LISTED]
            )
            more = f" and {len(runs) - _LISTED} times more" if len(runs) > _LISTED else ""
            yield (
                f"{axis}, column {name.lstrip('-')!r}, stands at its extreme, {record.said(extreme)}, from "
                f"{listed}{more}: its sensor seems to be at the end of its range, and what is beyond is lost"
            )
    size = np.linalg.norm(record.load, axis=1)
    top = int(size.argmax())
    along = record.load[top, 0]
    if abs(along) > _ALONG * size[top]:
        yield (
            f"the largest load, {record.said(size[top])} at {record.time[top]:g} s, lies along the beam (x is "
            f"{record.said(along)}), which bends it little; x is {record.names['x']!r}"
        )


def _level(record: Samples) -> Level | None:
    in_g = np.linalg.norm(record.load, axis=1) / STANDARD_GRAVITY
    runs = true_runs((in_g > LEVEL[0]) & (in_g < LEVEL[1]))
    if not runs:
        return None
    longest = max(runs, key=lambda run: run.stop - run.start)
    ends = float(record.time[longest.start]), float(record.time[longest.stop - 1])
    return Level(*ends, _vector(record.load[longest].mean(axis=0)))


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
