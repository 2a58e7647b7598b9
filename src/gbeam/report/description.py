"""Meaning of a scenario, as `check` prints it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from gbeam.constants import DEGREE, RPM, STANDARD_GRAVITY
from gbeam.printable import level_words
from gbeam.report.words import axis_words, tidy
from gbeam.results.description import BodyDescription, Curves, Description, RecordSummary, Vector
from gbeam.results.machine import ArmLevel
from gbeam.results.result import part_words


def description_text(case: Description) -> str:
    """Description of a scenario for a terminal, on a few lines."""
    lines = [case.title or "(no title)", *_bodies(case)]
    motions = []
    for name, kind in case.motions.items():
        words = kind
        if name in case.tracks:
            words += f" that tracks {case.tracks[name]}"
        if name in case.levels:
            words += f", {_level_words(case.levels[name])}"
        motions.append(level_words(name, case.scales.get(name)) + (f": {words}" if words != name else ""))
    lines += _listed("motions", motions)
    for name, record in case.records.items():
        first, *more_lines = [*_lines(record), *_offsets(name, case.records)]
        lines += [f"  {'record':<9} {name}: {first}", *(f"  {'':<9} {line}" for line in more_lines)]
    for file, records in _by_file(case.records).items():
        lines += _listed("sections", [f"of {Path(file).name}", *_sections(records)])
    if case.integrator is not None:
        spans = case.spans or {"": (case.start or 0.0, (case.start or 0.0) + (case.duration or 0.0))}
        times = ", ".join(f"{name} {first:.4g} to {last:.4g} s".lstrip() for name, (first, last) in spans.items())
        step = "auto" if case.step is None else f"{1e3 * case.step:.4g} ms"
        lines.append(f"  response  {times}, {case.integrator}, step {step}")
    lines += _listed("drawn", [f"{path}: {drawn}; here its centre" for path, drawn in case.distributions.items()])
    lines += [f"  warning: {warning}" for warning in case.warnings]
    lines += [f"  note: {note}" for note in case.notes]
    return "\n".join([*lines, "Scenario valid."])


def _level_words(level: ArmLevel) -> str:
    """Words on what a plain arm holds."""
    return (
        f"{level.level / STANDARD_GRAVITY:.4g} g along {axis_words(level.load)}, {axis_words(level.up)} up: "
        f"{level.rate / RPM:.4g} rpm at {level.radius:.4g} m, {level.reached:.4g} to {level.ends:.4g} s"
    )


def _listed(head: str, lines: Sequence[str]) -> list[str]:
    return [f"  {'' if i else head:<9} {line}" for i, line in enumerate(lines)]


def _bodies(case: Description) -> list[str]:
    """Lines on the bodies, joints, forces, controllers and gravity. A single body on the base is described in full."""
    if len(case.bodies) == 1 and not case.joints:
        ((name, body),) = case.bodies.items()
        return [
            *_listed(name, list(_facts(body))),
            *_listed("modes", _modes(body, "at rest, Hz: ")),
            *_interactions(case),
        ]
    bodies = []
    for name, body in case.bodies.items():
        bodies.append(f"{name}: {'; '.join((*_facts(body), *_modes(body, 'held at rest, Hz: ')))}")
    return [
        *_listed("bodies", [f"{case.mass:.4g} kg, {_centre(case.centre)} at the start", *bodies]),
        *_interactions(case),
    ]


def _facts(body: BodyDescription) -> Iterator[str]:
    """Yield words on a body: its kind, size and mass, its coordinates and points, and the nodes that clamps hold."""
    length = "" if body.length is None else f"{1e3 * body.length:.4g} mm, "
    added = f", {body.mass:.4g} kg with {len(body.masses)} added" if body.masses else ""
    centre = _centre(body.centre) if body.length is None else ""
    yield ", ".join(filter(None, (body.kind, f"{length}{body.bare_mass:.4g} kg{added}", centre)))
    count_words = ", ".join(f"{count} {family}" for family, count in body.counts.items())
    shape_words = f": {count_words}" if count_words else ""
    coordinates = f"{body.coordinates} coordinate{'' if body.coordinates == 1 else 's'}{shape_words}; "
    yield f"{coordinates if body.coordinates else ''}points {', '.join(body.points)}"
    if body.supports:
        yield f"supports {'; '.join(f'at {place} {directions}' for place, directions in body.supports.items())}"
    yield from (f"clamp {name} holds {nodes}" for name, nodes in body.clamps.items())


def _modes(body: BodyDescription, prefix: str) -> list[str]:
    ways = [""] * len(body.frequency) if body.direction is None else [f" ({way})" for way in body.direction]
    frequencies = [f"{frequency:.4g}{way}" for frequency, way in zip(body.frequency, ways, strict=True)]
    return [prefix + ", ".join(frequencies)] if frequencies else []


def _centre(centre: Any) -> str:
    tidied = ", ".join(f"{1e3 * component:.4g}" for component in tidy(centre, max(map(abs, centre)), scale=1.0))
    return f"centre of mass at ({tidied}) mm"


def _interactions(case: Description) -> list[str]:
    """Lines on the joints, forces, controllers and gravity of a case."""
    joints = []
    for name, joint in case.joints.items():
        ways = {"free": joint.free, "driven": joint.driven, "prescribed": joint.prescribed}
        motion_words = "; ".join(f"{way} {', '.join(names)}" for way, names in ways.items() if names) or "nothing moves"
        joints.append(f"{name}: {joint.kind}, {joint.body} on {joint.on}; {motion_words}")
    forces = [
        f"{name}: on {force.on}{', following it' if force.follower else ''}" for name, force in case.forces.items()
    ]
    controllers = [
        f"{name}: {', '.join(loop.drive)} from {', '.join(loop.measure)}, every {1e3 * loop.sample:.4g} ms"
        + (f", {1e3 * loop.delay:.4g} ms late" if loop.delay else "")
        for name, loop in case.controllers.items()
    ]
    gravity = () if case.gravity is None else (", ".join(f"{g:.4g}" for g in case.gravity) + " m/s²",)
    return [
        *_listed("joints", joints), *_listed("loops", [case.loops] if case.loops else []), *_listed("forces", forces),
        *_listed("control", controllers),
        *_listed("gravity", gravity),
    ]  # fmt: skip


_GAPS, _SECTIONS = 20, 40  # in lines


def _by_file(records: Mapping[str, RecordSummary]) -> dict[str, dict[str, RecordSummary]]:
    """Records by name, by the file whose sections they are or have."""
    files: dict[str, dict[str, RecordSummary]] = {}
    for name, record in records.items():
        if record.sections:
            files.setdefault(record.file, {})[name] = record
    return files


def _offsets(name: str, records: Mapping[str, RecordSummary]) -> Iterator[str]:
    """Yield a table of the offsets that are subtracted from a record. For several records of one file
    it is shown once.
    """
    record = records[name]
    if not record.offsets:
        return
    first = next(
        key for key, candidate in records.items()
        if candidate.file == record.file and candidate.offsets_of_columns == record.offsets_of_columns
    )  # fmt: skip
    if first != name:
        yield f"offsets as of {first} are subtracted"
        return
    cells = [["offsets at rest", *(f"{offset.start:.6g} to {offset.end:.6g} s" for offset in record.offsets), ""]]
    cells += [[f"{axis} = {record.channels[axis]}", *values, unit] for axis, unit, values in record.offsets_of_columns]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row in cells:
        yield "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
    yield "subtracted" if len(record.offsets) == 1 else "subtracted, with their drift on straight lines between"


def _sections(records: Mapping[str, RecordSummary]) -> Iterator[str]:
    """Yield a table of the sections of a file, each with the flights whose records lie in it."""
    record = next(iter(records.values()))
    widest = max(len(section.value) for section in record.sections)
    for section in record.sections[:_SECTIONS]:
        names = []
        for name, flown in records.items():
            overlaps = flown.span[0] <= section.end and flown.span[1] >= section.start
            if overlaps and flown.section in ("", section.value):
                names.append(name)
        value = f"{record.sections_by} {section.value:<{widest}}"
        ends = f"{section.start:9.6g} to {f'{section.end:.6g} s':<11}"
        yield f"{value}  {ends}  {', '.join(names) or 'not flown'}"
    if len(record.sections) > _SECTIONS:
        yield f"and {len(record.sections) - _SECTIONS} more, which --json has"


def _lines(record: RecordSummary) -> Iterator[str]:
    """Yield lines on a record: its file and span, ranges as read and, if they differ, as flown, level flight and gaps.

    Its notes are among the warnings.
    """
    span = f"{record.span[0]:.6g} to {record.span[1]:.6g} s"
    part = span if record.span == record.whole else part_words(record.span, record.whole)
    clock = f", 0 s being {record.clock}" if record.clock else ""
    vehicle = {"aircraft": "", "rocket": " of a rocket"}.get(record.vehicle, " of another vehicle")
    section = f", {record.sections_by} {record.section}" if record.section else ""
    yield f"{Path(record.file).name}{section}, {part}{clock}, {record.quantity.replace('-', ' ')}{vehicle}"
    read, flown = _cells(record, record.read), _cells(record, record.flown)
    unchanged = [*read.values()] == [*flown.values()]
    rows = [("", "read and flown" if unchanged else "read", "flown")]
    rows += [(name, cell, flown[name]) for name, cell in read.items()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *cells in rows:
        row_cells = cells[:1] if unchanged else cells
        yield "  ".join(f"{cell:<{width}}" for cell, width in zip((name, *row_cells), widths, strict=False)).rstrip()
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
    """Cells on a record as it is read or flown: its samples, the range of every column, and the largest load."""
    cells = {"samples": f"{curves.samples} at {curves.rate:.4g} Hz"}
    columns = [*zip("xyz", record.columns, curves.smallest, curves.largest, strict=True)]
    scales = [(STANDARD_GRAVITY, "g")] * len(columns)
    if record.rate_columns is not None and curves.rates is not None:
        columns += zip("pqr", record.rate_columns, curves.rates.smallest, curves.rates.largest, strict=True)
        scales += [(DEGREE, "deg/s")] * 3
    for (key, column, smallest, largest), (size, unit) in zip(columns, scales, strict=True):
        low, high = (f"{value / size:.4g}" for value in (smallest, largest))
        cells[f"{key} = {column}"] = f"{low} to {high} {unit}" if column != "0" else ""
    return cells | {"largest load": f"{_load(curves.peak)} at {curves.time_of_peak:.6g} s"}


def _load(load: Vector) -> str:
    """Size and direction of a load."""
    size = math.hypot(*load)
    parts = ", ".join(f"{axis} {value / STANDARD_GRAVITY:.3g}" for axis, value in zip("xyz", load, strict=True))
    return f"{size / STANDARD_GRAVITY:.4g} g ({parts})"
