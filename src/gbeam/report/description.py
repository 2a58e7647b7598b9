"""Meaning of a scenario, as `check` prints it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from gbeam.constants import STANDARD_GRAVITY
from gbeam.printable import level_words
from gbeam.report.words import tidy
from gbeam.results.description import (
    Curves,
    Described,
    Description,
    RecordSummary,
    SpecimenDescription,
    SystemDescription,
    Vector,
)
from gbeam.results.result import part_words


def text(case: Described) -> str:
    """Description on a few lines."""
    lines = [case.title or "(no title)", *_structure(case)]
    motions = []
    for name, kind in case.motions.items():
        described = kind + (f" that tracks {case.tracks[name]}" if name in case.tracks else "")
        motions.append(level_words(name, case.scales.get(name)) + (f": {described}" if described != name else ""))
    lines += _listed("motions", motions)
    for name, record in case.records.items():
        first, *more_lines = _lines(record)
        lines += [f"  {'record':<9} {name}: {first}", *(f"  {'':<9} {line}" for line in more_lines)]
    if case.start is not None and case.duration is not None:
        end = case.start + case.duration
        step = "auto" if case.step is None else f"{1e3 * case.step:.4g} ms"
        lines.append(f"  response  {case.start:.4g} to {end:.4g} s, {case.integrator}, step {step}")
    lines += _listed("drawn", [f"{path}: {drawn}; here its centre" for path, drawn in case.distributions.items()])
    lines += [f"  warning: {each}" for each in case.warnings]
    lines += [f"  note: {each}" for each in case.notes]
    return "\n".join([*lines, "Scenario valid."])


def _structure(case: Described) -> list[str]:
    if isinstance(case, SystemDescription):
        return _system(case)
    if isinstance(case, SpecimenDescription):
        return _specimen(case)
    assert isinstance(case, Description)
    return _beam(case)


def _listed(head: str, lines: Sequence[str]) -> list[str]:
    return [f"  {'' if i else head:<9} {line}" for i, line in enumerate(lines)]


def _beam(case: Description) -> list[str]:
    added = f", {case.total_mass:.4g} kg with {len(case.bodies)} added" if case.bodies else ""
    counts = ", ".join(f"{count} {name}" for name, count in case.counts.items())
    modes = ", ".join(f"{f:.4g} ({d})" for f, d in zip(case.frequency, case.direction, strict=True))
    return [
        f"  beam      {1e3 * case.length:.4g} mm, {case.mass:.4g} kg{added}",
        f"  model     {case.model}, coordinates: {counts}",
        f"  modes     at rest, Hz: {modes}",
    ]


def _specimen(case: SpecimenDescription) -> list[str]:
    centre = ", ".join(f"{1e3 * each:.4g}" for each in tidy(case.centre, max(map(abs, case.centre))))
    lines = [f"  {case.name:<9} {case.kind}, {case.mass:.4g} kg, centre of mass at ({centre}) mm"]
    if case.coordinates:
        modes = ", ".join(f"{each:.4g}" for each in case.frequency)
        lines.append(f"  {'':<9} {case.coordinates} coordinates; points {', '.join(case.points)}")
        lines += [f"  {'':<9} {words}" for words in _clamped(case.clamps)]
        lines.append(f"  modes     at rest, Hz: {modes}")
    return lines


def _clamped(clamps: Mapping[str, str]) -> list[str]:
    return [f"clamp {name} holds {nodes}" for name, nodes in clamps.items()]


def _system(case: SystemDescription) -> list[str]:
    """Lines on the bodies, joints, forces, controllers and gravity of a system."""
    bodies = []
    for name, body in case.bodies.items():
        counted = f", {body.coordinates} coordinate{'' if body.coordinates == 1 else 's'}" if body.coordinates else ""
        words = f"{body.kind}, {body.mass:.4g} kg{counted}; points {', '.join(body.points)}"
        bodies.append("; ".join([f"{name}: {words}", *_clamped(body.clamps)]))
    joints = []
    for name, joint in case.joints.items():
        ways = {"free": joint.free, "driven": joint.driven, "prescribed": joint.prescribed}
        moving = "; ".join(f"{way} {', '.join(names)}" for way, names in ways.items() if names) or "nothing moves"
        joints.append(f"{name}: {joint.kind}, {joint.body} on {joint.on}; {moving}")
    forces = [f"{name}: on {each.on}{', following it' if each.follower else ''}" for name, each in case.forces.items()]
    controllers = [
        f"{name}: {', '.join(each.drive)} from {', '.join(each.measure)}, every {1e3 * each.sample:.4g} ms"
        + (f", {1e3 * each.delay:.4g} ms late" if each.delay else "")
        for name, each in case.controllers.items()
    ]
    gravity = () if case.gravity is None else (", ".join(f"{each:.4g}" for each in case.gravity) + " m/s²",)
    parts = {"bodies": bodies, "joints": joints, "forces": forces, "control": controllers, "gravity": gravity}
    return [line for head, lines in parts.items() for line in _listed(head, lines)]


_GAPS = 20  # in lines


def _lines(record: RecordSummary) -> Iterator[str]:
    """Yield lines on a record, what is read beside what is flown if they differ; its notes are among the warnings."""
    span = f"{record.span[0]:.6g} to {record.span[1]:.6g} s"
    part = span if record.span == record.whole else part_words(record.span, record.whole)
    clock = f", 0 s being {record.clock}" if record.clock else ""
    of = (
        "" if record.vehicle == "aircraft" else f" of {'a rocket' if record.vehicle == 'rocket' else 'another vehicle'}"
    )
    yield f"{Path(record.file).name}, {part}{clock}, {record.quantity.replace('-', ' ')}{of}"
    read, flown = (_cells(record, each) for each in (record.read, record.flown))
    same = [*read.values()] == [*flown.values()]
    rows = [("", "read and flown" if same else "read", "flown")]
    rows += [(name, cell, flown[name]) for name, cell in read.items()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *cells in rows:
        shown = cells[:1] if same else cells
        yield "  ".join(f"{cell:<{width}}" for cell, width in zip((name, *shown), widths, strict=False)).rstrip()
    if record.level is not None:
        yield f"level from {record.level.start:.6g} to {record.level.end:.6g} s: {_load(record.level.load)} on average"
    elif record.quantity == "specific-force" and record.vehicle == "aircraft":
        yield "nowhere level, near 1 g, for a second"
    yield from record.done
    if record.gaps:
        yield "gaps on straight lines, from s   to s         lost  after"
    for gap in record.gaps[:_GAPS]:
        yield f"{'':23}{gap.start:>9.6g}  {gap.end:<9.6g}  {gap.lost:>4}  {gap.after}"
    if len(record.gaps) > _GAPS:
        yield f"and {len(record.gaps) - _GAPS} more, which --json has"


def _cells(record: RecordSummary, curves: Curves) -> dict[str, str]:
    """Samples, ranges of all columns, and the largest load, of a record as it is read or flown."""
    cells = {"samples": f"{curves.samples} at {curves.rate:.4g} Hz"}
    columns = [*zip("xyz", record.columns, curves.smallest, curves.largest, strict=True)]
    scales = [(STANDARD_GRAVITY, "g")] * len(columns)
    if record.rate_columns is not None and curves.rates is not None:
        columns += zip("pqr", record.rate_columns, curves.rates.smallest, curves.rates.largest, strict=True)
        scales += [(math.pi / 180, "deg/s")] * 3
    for (key, column, smallest, largest), (size, unit) in zip(columns, scales, strict=True):
        low, high = (f"{value / size:.4g}" for value in (smallest, largest))
        cells[f"{key} = {column}"] = f"{low} to {high} {unit}" if column != "0" else ""
    return cells | {"largest load": f"{_load(curves.peak)} at {curves.time_of_peak:.6g} s"}


def _load(load: Vector) -> str:
    """Size and direction of a load."""
    size = math.hypot(*load)
    parts = ", ".join(f"{axis} {value / STANDARD_GRAVITY:.3g}" for axis, value in zip("xyz", load, strict=True))
    return f"{size / STANDARD_GRAVITY:.4g} g ({parts})"
