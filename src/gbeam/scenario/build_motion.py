"""Profiles and motions of a scenario as objects of gbeam.motion."""

from __future__ import annotations

from typing import Any

from gbeam import motion
from gbeam.analysis.study.case import Motion
from gbeam.motion import Profile
from gbeam.motion.bases.flight import body_rates
from gbeam.motion.bases.record import Conditioning, FlightRecord, Rates, read_flight
from gbeam.scenario import schema
from gbeam.scenario.collect import Collector
from gbeam.scenario.schema.motion import Record


def flights_and_hubs(
    parts: Collector, scenario: schema.Environments
) -> tuple[dict[str, Motion], list[motion.PiecewiseLinear]]:
    """Build the motions that need no other, by name; and the records that were read for them.

    Parameters
    ----------
    parts : Collector
        Takes the errors; a motion that has one is left out.
    scenario : Environments
    """
    built: dict[str, Motion | None] = {}
    records: list[motion.PiecewiseLinear] = []
    for name, it in scenario.motion.items():
        where = f"motion.{name}"
        if isinstance(it, schema.Hub):
            built[name] = _hub(parts, where, it)
        elif isinstance(it, schema.Flight):
            if it.record is not None:
                record = parts.attempt(where, _record, it.record)
                records += [record.acceleration] if record is not None else []
                built[name] = None if record is None else _recorded(record, it.smoothing)
            else:
                acceleration = components(parts, f"{where}.acceleration", it.acceleration)
                built[name] = None if acceleration is None else motion.Flight(_rounded(acceleration, it.smoothing))
    return {name: it for name, it in built.items() if it is not None}, records


def centrifuges(
    parts: Collector, scenario: schema.Environments, others: dict[str, Motion], span: tuple[float, float]
) -> dict[str, Motion]:
    """Build the motions that track a flight, by name.

    Parameters
    ----------
    parts : Collector
        Takes the errors; a motion that has one is left out, and so is one whose flight is missing.
    scenario : Environments
    others : dict of str to motion
        From :func:`flights_and_hubs`.
    span : tuple of float
        First and last time, s.
    """
    built: dict[str, Motion] = {}
    for name, it in scenario.motion.items():
        if not isinstance(it, schema.Centrifuge):
            continue
        flight = others.get(it.tracks)
        if isinstance(flight, motion.Flight):
            centrifuge = parts.attempt(f"motion.{name}", centrifuge_of, it, flight.acceleration, span)
            built |= {} if centrifuge is None else {name: centrifuge}
    return built


def centrifuge_of(it: schema.Centrifuge, load: Profile, span: tuple[float, float]) -> motion.Centrifuge:
    """Build one centrifuge for the load that it tracks, over a span, s; InputError if it cannot."""
    machine = None if it.machine is None else motion.MACHINES[it.machine]
    arm = it.arm if it.arm is not None or machine is None else machine.arm
    assert arm is not None  # the schema sees to it
    target = motion.build_target(
        load, span=span, idle=it.idle, smoothing=it.smoothing, gravity=it.gravity, arm=arm, clip=it.clip,
        spin_up=it.spin_up,
    )  # fmt: skip
    sign = 1 if it.mounting == "upright" else -1
    limits = _limits(it.limits, machine.limits if machine else motion.MachineLimits())
    return motion.Centrifuge(target, arm, it.control_point, it.inverse, it.gravity, sign, limits, it.start)


def _limits(it: schema.Limits, example: motion.MachineLimits) -> motion.MachineLimits:
    """The limits that are given, and the example machine's where none is."""

    def axis(given: schema.AxisLimit, otherwise: motion.AxisLimit) -> motion.AxisLimit:
        return motion.AxisLimit(*(mine if mine is not None else theirs for mine, theirs in (
            (given.rate, otherwise.rate),
            (given.acceleration, otherwise.acceleration),
            (given.jerk, otherwise.jerk),
        )))  # fmt: skip

    return motion.MachineLimits(
        axis(it.axis1, example.axis1),
        axis(it.axis2, example.axis2),
        axis(it.axis3, example.axis3),
        example.inertia if it.inertia is None else it.inertia,
        example.power if it.power is None else it.power,
    )


def _hub(parts: Collector, where: str, table: schema.Hub) -> Motion | None:
    given = {name: getattr(table, name) for name in ("rate", "torque") if getattr(table, name) is not None}
    profiles = {name: _profile(parts, f"{where}.{name}", profile) for name, profile in given.items()}
    if None in profiles.values():
        return None
    return parts.attempt(
        where, motion.Hub, radius=table.radius, inertia=table.inertia, **profiles, pointing=table.pointing,
        setting_angle=table.setting_angle, gravity=table.gravity, stiffness=table.stiffness or 0.0,
        damping=table.damping or 0.0,
    )  # fmt: skip


def components(parts: Collector, where: str, it: Any) -> Profile | None:
    """Build the vector profile of a table with x, y and z, each a profile, a constant quantity or left out.

    Parameters
    ----------
    parts : Collector
        Takes the errors.
    where : str
        Place of the table in the scenario.
    it : table of the schema
    """
    given = {axis: getattr(it, axis) for axis in "xyz" if getattr(it, axis) is not None}
    built = {axis: _profile(parts, f"{where}.{axis}", profile) for axis, profile in given.items()}
    return None if None in built.values() else motion.stack(**built)


def _profile(parts: Collector, where: str, it: Any) -> Profile | None:
    """Build one profile; `it` is any of the schema's, of any quantity."""
    profile: Profile | None
    if isinstance(it, float):
        return parts.attempt(where, motion.constant, it)
    match it:
        case schema.Constant():
            profile = parts.attempt(where, motion.constant, it.level)
        case schema.Trapezoid():
            profile = parts.attempt(where, motion.trapezoid, it.level, it.jerk, it.start, it.hold)
        case schema.SmoothStep():
            profile = parts.attempt(where, motion.SmoothStep, it.level, it.duration, it.start)
        case schema.Sine():
            profile = parts.attempt(where, motion.Sine, it.amplitude, it.duration)
        case schema.Listed():
            profile = parts.attempt(where, motion.tabulated, it.times, it.values)
        case _:
            terms = [_profile(parts, f"{where}.terms[{i}]", term) for i, term in enumerate(it.terms)]
            sound = tuple(term for term in terms if term is not None)
            profile = motion.Sum(sound) if len(sound) == len(terms) else None
    return None if profile is None else _rounded(profile, it.smoothing)


def _record(it: Record) -> FlightRecord:
    rates = None
    if it.p is not None and it.q is not None and it.r is not None and it.rate_unit is not None:
        rates = Rates(it.p, it.q, it.r, it.rate_unit)
    conditioning = Conditioning(it.cutoff, it.resample, it.despike, it.skip_checks)
    return read_flight(it.file, it.time, it.x, it.y, it.z, it.unit, rates=rates, conditioning=conditioning)


def _recorded(record: FlightRecord, smoothing: float) -> motion.Flight:
    rates = None if record.rates is None else body_rates(record.rates, smoothing)
    return motion.Flight(_rounded(record.acceleration, smoothing), rates, record.notes)


def _rounded(profile: Profile, width: float) -> Profile:
    return motion.smoothed(profile, width) if width else profile
