"""Meaning of a scenario, as `check` prints it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.words import tidy
from gbeam.results.description import (
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
        motions.append(name + (f": {described}" if described != name else ""))
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
        lines.append(f"  modes     at rest, Hz: {modes}")
    return lines


def _system(case: SystemDescription) -> list[str]:
    """Lines on the bodies, joints, forces, controllers and gravity of a system."""
    bodies = []
    for name, body in case.bodies.items():
        counted = f", {body.coordinates} coordinate{'' if body.coordinates == 1 else 's'}" if body.coordinates else ""
        bodies.append(f"{name}: {body.kind}, {body.mass:.4g} kg{counted}; points {', '.join(body.points)}")
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


def _lines(record: RecordSummary) -> Iterator[str]:
    """Yield lines on a record, loads in g; its notes are among the warnings."""
    span = f"{record.span[0]:.6g} to {record.span[1]:.6g} s"
    part = span if record.span == record.whole else part_words(record.span, record.whole)
    clock = f", 0 s being {record.clock}" if record.clock else ""
    quantity = record.quantity.replace("-", " ")
    yield f"{Path(record.file).name}, {record.samples} samples at {record.rate:.4g} Hz, {part}{clock}, {quantity}"
    loads = zip("xyz", record.columns, record.smallest, record.largest, strict=True)
    yield from _ranges(loads, STANDARD_GRAVITY, "g", max(map(len, record.columns)))
    if record.rates is not None:
        turns = record.rates
        rates = zip("pqr", turns.columns, turns.smallest, turns.largest, strict=True)
        yield from _ranges(rates, math.pi / 180, "deg/s", max(map(len, turns.columns)))
    yield f"largest load {_load(record.peak)} at {record.time_of_peak:.6g} s"
    if record.level is not None:
        yield f"level from {record.level.start:.6g} to {record.level.end:.6g} s: {_load(record.level.load)} on average"
    elif record.quantity == "specific-force":
        yield "nowhere near 1 g"


def _ranges(columns: Iterable[tuple[str, str, float, float]], size: float, unit: str, width: int) -> Iterator[str]:
    """Yield component, column and range of columns in a unit of a size in SI."""
    for key, column, smallest, largest in columns:
        low, high = (f"{value / size:.4g}" for value in (smallest, largest))
        yield f"{key} = {column:<{width}}  {low} to {high} {unit}" if column != "0" else f"{key} = 0"


def _load(load: Vector) -> str:
    """Size and direction of a load."""
    size = math.hypot(*load)
    parts = ", ".join(f"{axis} {value / STANDARD_GRAVITY:.3g}" for axis, value in zip("xyz", load, strict=True))
    return f"{size / STANDARD_GRAVITY:.4g} g ({parts})"
