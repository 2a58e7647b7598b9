"""Profiles and motions of a scenario as objects of gbeam.motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gbeam import motion
from gbeam.errors import InputError
from gbeam.motion import Profile
from gbeam.motion.arm import across, direction
from gbeam.motion.flight import body_rates
from gbeam.motion.records.instrument import Instrument
from gbeam.motion.records.record import Conditioning, FlightRecord, Rates, Recording
from gbeam.motion.records.rest import Rest
from gbeam.scenario import schema
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.profile import PartOfRecord, Record

if TYPE_CHECKING:
    from pydantic import BaseModel


def flights_and_hubs(parts: Collector, scenario: schema.Environments) -> dict[str, motion.Motion]:
    """Build the flights and hubs of a scenario by name, without refused ones, whose errors `parts` keeps."""
    built: dict[str, motion.Motion | None] = {}
    recordings, partly = _recordings(parts, scenario), dict[str, None]()
    for name, table in scenario.motion.items():
        where = f"motion.{name}"
        if isinstance(table, schema.Hub):
            built[name] = _hub(parts, where, table)
        elif isinstance(table, schema.Arm):
            built |= _arms(parts, name, table)
        elif isinstance(table, schema.Flight):
            if table.record is not None:
                source = table.record.of if isinstance(table.record, PartOfRecord) else name
                recording, span = recordings.get(source), (table.record.begin, table.record.to)
                flight = recording and parts.attempt(where, recording.flight, span, table.record.section)
                built[name] = _recorded(flight, table) if flight else None
                if flight and flight.summary.is_part:
                    partly[source] = None
            else:
                load = components(parts, f"{where}.acceleration", table.acceleration)
                built[name] = None if load is None else _flight(load, None, table)
    for name in partly:
        parts.attempt(f"motion.{name}", recordings[name].refuse_unlevel)
    return {name: base for name, base in built.items() if base is not None}


def centrifuges(
    parts: Collector,
    scenario: schema.Environments,
    others: dict[str, motion.Motion],
    span_of: Callable[[str], tuple[float, float]],
    *,
    ahead: bool,
) -> dict[str, motion.Motion]:
    """Build the centrifuges, which track one of the flights in `others`, by name, over their spans, s."""
    built: dict[str, motion.Motion] = {}
    for name, table in scenario.motion.items():
        if not isinstance(table, schema.Centrifuge):
            continue
        flight = others.get(table.tracks)
        if isinstance(flight, motion.Flight):
            centrifuge = parts.attempt(f"motion.{name}", centrifuge_of, table, flight, span_of(name), ahead)
            built |= {} if centrifuge is None else {name: centrifuge}
    return built


def centrifuge_of(
    table: schema.Centrifuge, flight: motion.Flight, span: tuple[float, float], ahead: bool = True
) -> motion.Centrifuge:
    """Build one centrifuge for the flight that it tracks, over a span, s; InputError if it cannot."""
    arm, idle, example = table.arm, table.idle, motion.MachineLimits()
    if table.machine is not None:
        machine = motion.machines[table.machine]
        arm, idle = machine.arm if arm is None else arm, machine.idle if idle is None else idle
        example = machine.limits
    options = values_of(table, "kind", "tracks", "machine", "arm", "idle", "limits", "commands", "accept")
    limits = _limits(table.limits, example)
    return motion.Centrifuge(flight, arm=arm, idle=idle, limits=limits, **options).over(*span, ahead=ahead)


def _limits(table: schema.Limits, example: motion.MachineLimits) -> motion.MachineLimits:
    """Limits of the table; those that it leaves out are the example machine's."""
    pairs = {name: (getattr(table, name), getattr(example, name)) for name in ("axis1", "axis2", "axis3")}
    axes = {name: replace(default, **values_of(axis)) for name, (axis, default) in pairs.items()}
    return replace(example, **values_of(table, *axes), **axes)


def values_of(table: BaseModel, *excluded: str) -> dict[str, Any]:
    """Values of a table by their keys, without those that are None and the excluded keys."""
    return {key: value for key, value in table if value is not None and key not in excluded}


def _hub(parts: Collector, where: str, table: schema.Hub) -> motion.Motion | None:
    driving = {name: getattr(table, name) for name in ("rate", "torque") if getattr(table, name) is not None}
    driven = {name: profile_of(parts, f"{where}.{name}", profile) for name, profile in driving.items()}
    if None in driven.values():
        return None
    return parts.attempt(where, motion.Hub, **driven, **values_of(table, "kind", "rate", "torque"))


def _arms(parts: Collector, name: str, table: schema.Arm) -> dict[str, motion.Motion | None]:
    """Build the arm's motion, or one for each of its directions, by name."""
    built: dict[str, motion.Motion | None] = {}
    for part, keys in table.motions.items():
        where = f"motion.{name}.directions.{part}" if part else f"motion.{name}"
        built["-".join(filter(None, (name, part)))] = parts.attempt(where, _arm, table, **keys)
    return built


def _arm(table: schema.Arm, *, load: Any, up: Any, control_point: Any, **keys: Any) -> motion.Hub:
    """Build the motion of an arm in one direction; of several directions that may be up the first across the load."""
    place = control_point if isinstance(control_point, tuple) else (control_point, 0.0, 0.0)
    several = isinstance(up, tuple) and isinstance(up[0], str)
    upwards = up if several else (up,)
    inward = direction("load", load)
    chosen = next((each for each in upwards if across(inward, direction("up", each))), None)
    if chosen is None:
        words = " and ".join(map(str, upwards))
        fix = 'give a direction across it, or several, such as up = ["+z", "+x"], of which one always is'
        raise InputError("up", f"is {words}, along load = {load}", fix)
    gravity, standard = table.gravity, table.standard
    return motion.plain_arm(load=load, up=chosen, control_point=place, gravity=gravity, standard=standard, **keys)


def components(parts: Collector, where: str, table: Any) -> Profile | None:
    """Build the vector profile of a table with x, y and z, each a profile, a constant quantity or left out."""
    tables = {axis: getattr(table, axis) for axis in "xyz" if getattr(table, axis) is not None}
    built = {axis: profile_of(parts, f"{where}.{axis}", profile) for axis, profile in tables.items()}
    return None if None in built.values() else motion.vector(**built)


def profile_of(parts: Collector, where: str, table: Any) -> Profile | None:
    """Build a profile from a table of the schema, or a constant from a number; None if it is refused."""
    profile: Profile | None
    if isinstance(table, float):
        return parts.attempt(where, motion.constant, table)
    match table:
        case schema.Constant():
            profile = parts.attempt(where, motion.constant, table.level)
        case schema.Trapezoid():
            profile = parts.attempt(
                where, motion.trapezoid, table.level, jerk=table.jerk, start=table.start, hold=table.hold
            )
        case schema.SmoothStep():
            profile = parts.attempt(where, motion.SmoothStep, table.level, table.duration, table.start)
        case schema.Sine():
            profile = parts.attempt(where, motion.Sine, table.amplitude, table.duration)
        case schema.Listed():
            profile = parts.attempt(where, motion.tabulated, table.times, table.values)
        case _:
            terms = [profile_of(parts, f"{where}.terms[{i}]", term) for i, term in enumerate(table.terms)]
            built = tuple(term for term in terms if term is not None)
            profile = motion.Sum(built) if len(built) == len(terms) else None
    return None if profile is None else _rounded(profile, table.smoothing)


def _recordings(parts: Collector, scenario: schema.Environments) -> dict[str, Recording]:
    """Read the files of records, each once, by the name of their flight; without refused ones."""
    tables = {name: each.record for name, each in scenario.motion.items() if isinstance(each, schema.Flight)}
    read = {
        name: parts.attempt(f"motion.{name}", _recording, table)
        for name, table in tables.items()
        if isinstance(table, Record)
    }
    return {name: each for name, each in read.items() if each is not None}


def _recording(table: Record) -> Recording:
    """Read the columns of a record from its file."""
    rates = None
    if table.p is not None and table.q is not None and table.r is not None and table.rate_unit is not None:
        rates = Rates(table.p, table.q, table.r, table.rate_unit)
    conditions = {key: getattr(table, key) for key in ("cutoff", "resample", "despike", "bridge", "skip_checks")}
    mounting = "turn", "level", "arm", "rest"
    columns = values_of(table, *conditions, *mounting, "file", "time", "p", "q", "r", "rate_unit", "begin", "to",
                        "section")  # fmt: skip
    rests = tuple(Rest((each.begin, each.to), each.load, each.rates) for each in table.rest)
    return Recording.read(
        table.file,
        table.time,
        **columns,
        rates=rates,
        conditioning=Conditioning(**conditions),
        instrument=Instrument(table.turn, table.level, table.arm, rests),
    )


def _recorded(record: FlightRecord, table: schema.Flight) -> motion.Flight:
    return _flight(record.acceleration, record.rates and body_rates(record.rates, table.smoothing), table)


def _flight(load: Profile, rates: Profile | None, table: schema.Flight) -> motion.Flight:
    return motion.Flight(acceleration=_rounded(load, table.smoothing), rates=rates, scale=table.scale)


def _rounded(profile: Profile, width: float) -> Profile:
    return motion.smoothed(profile, width) if width else profile
