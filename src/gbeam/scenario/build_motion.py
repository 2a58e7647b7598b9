"""Profiles and motions of a scenario as objects of gbeam.motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError
from gbeam.guards.parameters import parameters_of
from gbeam.motion.arm import direction, has_part_across, plain_arm
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.limits import MachineLimits, machines
from gbeam.motion.flight import Flight, body_rates
from gbeam.motion.hub import Hub
from gbeam.motion.protocol import Motion
from gbeam.motion.records.instrument import Instrument
from gbeam.motion.records.parameters import Conditioning, Rates
from gbeam.motion.records.record import FlightRecord, Recording
from gbeam.scenario import schema
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.declared import arguments_of, object_of
from gbeam.scenario.schema.profile import rounded
from gbeam.scenario.schema.record import GROUPS, PART, PartOfRecord, Record

if TYPE_CHECKING:
    from pydantic import BaseModel


def flights_and_hubs(parts: Collector, scenario: schema.Environments) -> dict[str, Motion]:
    """Build the flights and hubs of a scenario by name, without refused ones, whose errors `parts` keeps."""
    built: dict[str, Motion | None] = {}
    recordings, partly = _recordings(parts, scenario), dict[str, None]()
    for name, table in scenario.motion.items():
        where = f"motion.{name}"
        if table.kind == "arm":
            built |= _arms(parts, name, table)
        elif table.kind == "flight" and table.record is not None:
            source = table.record.of if isinstance(table.record, PartOfRecord) else name
            recording, part = recordings.get(source), {key: getattr(table.record, key) for key in PART}
            record = recording and parts.attempt(where, recording.flight, **part)
            built[name] = _flight(record, table) if record else None
            if record and record.summary.is_part:
                partly[source] = None
        elif table.kind != "centrifuge":
            built[name] = object_of(parts, where, table)
    for name in partly:
        parts.attempt(f"motion.{name}", recordings[name].refuse_unlevel)
    return {name: base for name, base in built.items() if base is not None}


def centrifuges(
    parts: Collector,
    scenario: schema.Environments,
    others: dict[str, Motion],
    span_of: Callable[[str], tuple[float, float]],
    *,
    ahead: bool,
) -> dict[str, Motion]:
    """Build the centrifuges, which track one of the flights in `others`, by name, over their spans, s."""
    built: dict[str, Motion] = {}
    for name, table in scenario.motion.items():
        if table.kind != "centrifuge":
            continue
        flight = others.get(table.tracks)
        if isinstance(flight, Flight):
            machine = _centrifuge(parts, f"motion.{name}", table, flight)
            prepared = machine and parts.attempt(f"motion.{name}", machine.over, *span_of(name), ahead=ahead)
            built |= {} if prepared is None else {name: prepared}
    return built


def _centrifuge(parts: Collector, where: str, table: Any, flight: Flight) -> Centrifuge | None:
    """Build one centrifuge for the flight that it tracks, on an example machine if one is named."""
    errors_before = len(parts.errors)
    options = arguments_of(parts, where, table, {"kind", "tracks", "machine", "commands", "accept"})
    if len(parts.errors) > errors_before:
        return None
    if table.machine is not None:
        machine, limits = machines[table.machine], options.get("limits", MachineLimits())
        options["limits"] = replace(machine, limits=limits.completed(machine.limits))
    return parts.attempt(where, Centrifuge, flight, **options)


def values_of(table: BaseModel, *excluded: str) -> dict[str, Any]:
    """Values of a table by their keys, without those that are None and the excluded keys."""
    return {key: value for key, value in table if value is not None and key not in excluded}


def _arms(parts: Collector, name: str, table: schema.Arm) -> dict[str, Motion | None]:
    """Build the arm's motion, or one for each of its directions, by name."""
    built: dict[str, Motion | None] = {}
    for part, keys in table.motions.items():
        where = f"motion.{name}.directions.{part}" if part else f"motion.{name}"
        built["-".join(filter(None, (name, part)))] = parts.attempt(where, _arm, table, **keys)
    return built


def _arm(table: schema.Arm, *, load: Any, up: Any, control_point: Any, **keys: Any) -> Hub:
    """Build the motion of an arm in one direction; of several directions that may be up the first across the load."""
    place = control_point if isinstance(control_point, tuple) else (control_point, 0.0, 0.0)
    several = isinstance(up, tuple) and isinstance(up[0], str)
    upwards = up if several else (up,)
    inward = direction("load", load)
    chosen = next((candidate for candidate in upwards if has_part_across(inward, direction("up", candidate))), None)
    if chosen is None:
        words = " and ".join(map(str, upwards))
        fix = 'give a direction across it, or several, such as up = ["+z", "+x"], of which one always is'
        raise InputError("up", f"is {words}, along load = {load}", fix)
    gravity, standard = table.gravity, table.standard
    return plain_arm(load=load, up=chosen, control_point=place, gravity=gravity, standard=standard, **keys)


def _recordings(parts: Collector, scenario: schema.Environments) -> dict[str, Recording]:
    """Read the files of records, each once, by the name of their flight; without refused ones."""
    tables = {name: motion.record for name, motion in scenario.motion.items() if motion.kind == "flight"}
    recordings = dict[str, Recording]()
    for name, table in tables.items():
        if isinstance(table, Record):
            arguments = arguments_of(parts, f"motion.{name}.record", table, PART)
            recording = parts.attempt(f"motion.{name}", _recording, **arguments)
            recordings |= {} if recording is None else {name: recording}
    return recordings


def _recording(*, time: str | None = None, **columns: Any) -> Recording:
    """Read the columns of a record from its file, by all keys of its table."""
    groups = []
    for group in GROUPS:
        groups.append({key: columns.pop(key) for key in parameters_of(group) if key in columns})
    rates, instrument, conditioning = groups
    return Recording.read(
        time=time,
        **columns,
        rates=Rates.from_columns(**rates),
        instrument=Instrument(**instrument),
        conditioning=Conditioning(**conditioning),
    )


def _flight(record: FlightRecord, table: Any) -> Flight:
    """A flight as it was recorded, its corners rounded."""
    rates = record.rates and body_rates(record.rates, table.smoothing)
    return Flight(acceleration=rounded(record.acceleration, table.smoothing), rates=rates, scale=table.scale)
