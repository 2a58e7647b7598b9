"""Meaning of a scenario, as `check` prints it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from gbeam.constants import STANDARD_GRAVITY
from gbeam.results.description import Description, RecordSummary, Vector
from gbeam.results.result import part_words


def text(case: Description) -> str:
    """Description on a few lines."""
    added = f", {case.total_mass:.4g} kg with {len(case.bodies)} added" if case.bodies else ""
    counts = ", ".join(f"{count} {name}" for name, count in case.counts.items())
    modes = ", ".join(f"{f:.4g} ({d})" for f, d in zip(case.frequency, case.direction, strict=True))
    step = "auto" if case.step is None else f"{1e3 * case.step:.4g} ms"
    lines = [
        case.title or "(no title)",
        f"  beam      {1e3 * case.length:.4g} mm, {case.mass:.4g} kg{added}",
        f"  model     {case.model}, coordinates: {counts}",
        f"  modes     at rest, Hz: {modes}",
    ]
    for i, (name, kind) in enumerate(case.motions.items()):
        what = kind + (f" that tracks {case.tracks[name]}" if name in case.tracks else "")
        lines.append(f"  {'motions' if i == 0 else '':<9} {name}" + (f": {what}" if what != name else ""))
    for name, record in case.records.items():
        first, *others = _lines(record)
        lines += [f"  {'record':<9} {name}: {first}", *(f"  {'':<9} {line}" for line in others)]
    end = case.start + case.duration
    lines.append(f"  response  {case.start:.4g} to {end:.4g} s, {case.integrator}, step {step}")
    for i, (path, drawn) in enumerate(case.distributions.items()):
        lines.append(f"  {'drawn' if i == 0 else '':<9} {path}: {drawn}; here its centre")
    lines += [f"  warning: {each}" for each in case.warnings]
    return "\n".join([*lines, "Scenario valid."])


def _lines(record: RecordSummary) -> Iterator[str]:
    """Summary of a record, loads in g; its notes are among the warnings."""
    span = f"{record.span[0]:.6g} to {record.span[1]:.6g} s"
    part = span if record.span == record.whole else part_words(record.span, record.whole)
    clock = f", 0 s being {record.clock}" if record.clock else ""
    quantity = record.quantity.replace("-", " ")
    yield f"{Path(record.file).name}, {record.samples} samples at {record.rate:.4g} Hz, {part}{clock}, {quantity}"
    ends_of = zip("xyz", record.columns, record.smallest, record.largest, strict=True)
    wide = max(map(len, record.columns))
    for axis, column, smallest, largest in ends_of:
        low, high = (f"{value / STANDARD_GRAVITY:.4g}" for value in (smallest, largest))
        yield f"{axis} = {column:<{wide}}  {low} to {high} g" if column != "0" else f"{axis} = 0"
    yield f"largest load {_load(record.peak)} at {record.time_of_peak:.6g} s"
    if record.level is not None:
        yield f"level from {record.level.start:.6g} to {record.level.end:.6g} s: {_load(record.level.load)} on average"
    elif record.quantity == "specific-force":
        yield "nowhere near 1 g"


def _load(load: Vector) -> str:
    """Size and direction of a load."""
    size = math.hypot(*load)
    parts = ", ".join(f"{axis} {value / STANDARD_GRAVITY:.3g}" for axis, value in zip("xyz", load, strict=True))
    return f"{size / STANDARD_GRAVITY:.4g} g ({parts})"
