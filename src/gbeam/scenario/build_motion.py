"""Profiles and motions of a scenario as objects of gbeam.motion."""

from __future__ import annotations

from typing import Any

from gbeam import motion
from gbeam.case import Motion
from gbeam.motion import Profile
from gbeam.scenario import schema
from gbeam.scenario.collect import Collector


def flights_and_hubs(
    parts: Collector, scenario: schema.Scenario
) -> tuple[dict[str, Motion], list[motion.PiecewiseLinear]]:
    """Build the motions that need no other, by name; and the records that were read for them.

    Parameters
    ----------
    parts : Collector
        Takes the errors; a motion that has one is left out.
    scenario : Scenario
    """
    built: dict[str, Motion | None] = {}
    records: list[motion.PiecewiseLinear] = []
    for name, it in scenario.motion.items():
        where = f"motion.{name}"
        if isinstance(it, schema.Hub):
            built[name] = _hub(parts, where, it)
        elif isinstance(it, schema.Flight):
            acceleration: Profile | None
            if it.record is not None:
                r = it.record
                record = parts.attempt(where, motion.read_record, r.file, r.time, r.x, r.y, r.z, r.unit)
                records += [record] if record is not None else []
                acceleration = record
            else:
                acceleration = _components(parts, f"{where}.acceleration", it.acceleration)
            built[name] = None if acceleration is None else motion.Flight(_rounded(acceleration, it.smoothing))
    return {name: it for name, it in built.items() if it is not None}, records


def centrifuges(
    parts: Collector, scenario: schema.Scenario, others: dict[str, Motion], span: tuple[float, float]
) -> dict[str, Motion]:
    """Build the motions that track a flight, by name.

    Parameters
    ----------
    parts : Collector
        Takes the errors; a motion that has one is left out, and so is one whose flight is missing.
    scenario : Scenario
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
            centrifuge = parts.attempt(f"motion.{name}", _centrifuge, it, flight.acceleration, span)
            built |= {} if centrifuge is None else {name: centrifuge}
    return built


def _centrifuge(it: schema.Centrifuge, load: Profile, span: tuple[float, float]) -> motion.Centrifuge:
    target = motion.build_target(load, span=span, idle=it.idle, smoothing=it.smoothing, gravity=it.gravity, arm=it.arm)
    sign = 1 if it.mounting == "upright" else -1
    return motion.Centrifuge(target, it.arm, it.control_point, it.inverse, it.gravity, sign)


def _hub(parts: Collector, where: str, it: schema.Hub) -> Motion | None:
    if it.rate is not None:
        rate = _profile(parts, f"{where}.rate", it.rate)
        return None if rate is None else parts.attempt(where, motion.HubRate, it.radius, rate)
    torque = _profile(parts, f"{where}.torque", it.torque)
    return None if torque is None else parts.attempt(where, motion.HubTorque, it.radius, it.inertia, torque)


def _components(parts: Collector, where: str, it: schema.Components | None) -> Profile | None:
    given = {axis: getattr(it, axis) for axis in "xyz" if getattr(it, axis) is not None}
    built = {axis: _profile(parts, f"{where}.{axis}", profile) for axis, profile in given.items()}
    return None if None in built.values() else motion.stack(**built)


def _profile(parts: Collector, where: str, it: Any) -> Profile | None:
    """Build one profile; `it` is any of the schema's, of any quantity."""
    profile: Profile | None
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
            profile = parts.attempt(where, motion.table, it.times, it.values)
        case _:
            terms = [_profile(parts, f"{where}.terms[{i}]", term) for i, term in enumerate(it.terms)]
            sound = tuple(term for term in terms if term is not None)
            profile = motion.Sum(sound) if len(sound) == len(terms) else None
    return None if profile is None else _rounded(profile, it.smoothing)


def _rounded(profile: Profile, width: float) -> Profile:
    return motion.smoothed(profile, width) if width else profile
