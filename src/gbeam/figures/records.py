"""Records of flights: channels as their file has them, over what is flown, and a file with the parts that are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain, groupby
from pathlib import Path

import numpy as np

from gbeam.constants import DEGREE, STANDARD_GRAVITY
from gbeam.figures.description import Figure, Line, Panel, Span, of_motion
from gbeam.printable import raised
from gbeam.results.description import Channels, RecordSummary

_SHOWN = {"m/s^2": (1 / STANDARD_GRAVITY, "g"), "rad/s": (1 / DEGREE, "deg/s")}  # of what is flown
_ROW, _ROWS, _LETTER = 0.12, 3, 0.01  # of a panel's height a row of names of parts, and of its width a letter
_BETWEEN = 0.003  # of a panel's width: parts that touch are shaded so far apart
_ALWAYS = (-math.inf, math.inf)


def record(summary: RecordSummary, name: str = "", title: str = "") -> Figure:
    """Describe a record's channels over the part that is flown: in pairs, as the file has them and as flown."""
    assert summary.as_read is not None and summary.as_flown is not None  # it was read from its file
    read = _panels(summary.as_read, "as read", summary.span)
    flown = _panels(summary.as_flown, "flown", summary.span)
    spans = tuple(_clip(_marks(summary), summary.span))
    panels = [replace(panel, spans=spans) for panel in chain(*zip(read, flown, strict=True))]
    section = f", {summary.sections_by} {summary.section}" if summary.section else ""
    subject = of_motion(name, f"{Path(summary.file).name}{section}, as read in its own axes, and as flown in base axes")
    offsets = ("offsets of the sensors subtracted",) if summary.offsets else ()
    return Figure(title, subject, tuple(panels), (*summary.done, *offsets))


def file(records: Mapping[str, RecordSummary], title: str = "") -> Figure:
    """Describe all channels of a whole file, with the parts that flights use, by the flights' names."""
    summary = next(iter(records.values()))
    assert summary.as_read is not None  # it was read from its file
    parts = {name: record.span for name, record in records.items()}
    width = float(np.ptp(summary.as_read.time))
    gap = _BETWEEN * width
    touching = [any(abs(start - end) < gap for start, _ in parts.values()) for _, end in parts.values()]
    ends = [end - gap * touches for (_, end), touches in zip(parts.values(), touching, strict=True)]
    flown = ((start, end, "flown") for (start, _), end in zip(parts.values(), ends, strict=True) if end > start)
    spans = (*flown, *_marks(summary))
    first, *other_panels = (replace(panel, spans=spans) for panel in _panels(summary.as_read, "as read", _ALWAYS))
    values = np.concatenate([line.y for line in first.lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    height = high - low or 1.0
    rows = _rows(parts, width)
    names = tuple((place, high + (row + 0.7) * _ROW * height, name) for name, (place, row) in rows.items())
    top = high + (max(row for _, row in rows.values()) + 1.4) * _ROW * height
    first = replace(first, texts=names, limits=(low - 0.05 * height, top))
    left_out = len(parts) - len(rows)
    notes = (f"{left_out} names of parts are left out for want of room",) if left_out else ()
    subject = f"{Path(summary.file).name}: all that is read of it, and the parts that are flown"
    return Figure(title, subject, (first, *other_panels), notes)


def _rows(parts: Mapping[str, tuple[float, float]], width: float) -> dict[str, tuple[float, int]]:
    """Middle of each part, s, and the row above the lines in which its name fits; without names that fit in none."""
    ends, rows = [-math.inf] * _ROWS, dict[str, tuple[float, int]]()
    for name, (first, last) in sorted(parts.items(), key=lambda part: sum(part[1])):
        middle, half = (first + last) / 2, (len(name) + 1) * _LETTER * width / 2
        row = next((k for k, end in enumerate(ends) if middle - half >= end), None)
        if row is not None:
            ends[row] = middle + half
            rows[name] = middle, row
    return rows


def _panels(channels: Channels, state: str, span: tuple[float, float]) -> list[Panel]:
    """Panels of the channels within a span, one for each unit, with samples in the order of their times."""
    order = np.argsort(channels.time, kind="stable")
    time = channels.time[order]
    order = order[(time >= span[0]) & (time <= span[1])]
    panels = []
    for unit, group in groupby(range(len(channels.names)), key=lambda k: channels.units[k]):
        size, unit_name = _SHOWN.get(unit, (1.0, unit)) if state == "flown" else (1.0, unit)
        lines = tuple(
            Line(channels.time[order], size * channels.values[order, k], channels.names[k], colour=i % 3)
            for i, k in enumerate(group)
        )
        panels.append(Panel(f"{state}, {raised(unit_name)}", lines))
    return panels


def _marks(summary: RecordSummary) -> Iterator[Span]:
    """Yield stretches at rest, that the instrument was levelled by, and samples that were lost."""
    yield from ((stretch.start, stretch.end, "at rest") for stretch in summary.offsets)
    if summary.levelled is not None:
        yield (*summary.levelled, "level")
    yield from ((gap.start, gap.end, "lost samples") for gap in summary.gaps)


def _clip(spans: Iterator[Span], ends: tuple[float, float]) -> Iterator[Span]:
    """Yield what of some stretches lies between the ends of a part, s."""
    for first, last, reason in spans:
        if first < ends[1] and last > ends[0]:
            yield max(first, ends[0]), min(last, ends[1]), reason
