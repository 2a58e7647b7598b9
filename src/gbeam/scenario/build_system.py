"""Systems of bodies of a scenario as objects of the core."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.errors import InputError, placing_within
from gbeam.io.models.arrays import read_state_space
from gbeam.mechanics.tree.control import Feedback, gains, in_series, lead_lag, notch, pid
from gbeam.mechanics.tree.joints import Joint
from gbeam.mechanics.tree.system import PointForce, System
from gbeam.scenario.bodies import OF_TABLE
from gbeam.scenario.build_motion import components, profile_of
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema import system as schema
from gbeam.scenario.schema.fields import fields_of
from gbeam.scenario.schema.profile import Smoothed


def system_of(parts: Collector, scenario: schema.SystemScenario | schema.SpecimenScenario) -> System | None:
    """The system of a scenario; None if it cannot be made, with the reasons in `parts`."""
    if isinstance(scenario, schema.SpecimenScenario):
        name, table = scenario.specimen
        kind = OF_TABLE[type(table)]
        body = (kind.alone or kind.build)(parts, f"bodies.{name}", table)
        return None if body is None else System.of(body, name)
    before = len(parts.errors)
    bodies = {name: OF_TABLE[type(body)].build(parts, f"bodies.{name}", body) for name, body in scenario.bodies.items()}
    joints = {name: _joint(parts, f"joints.{name}", table) for name, table in scenario.joints.items()}
    forces = {name: _force(parts, f"forces.{name}", table) for name, table in scenario.forces.items()}
    controllers = {name: _controller(parts, f"controllers.{name}", law) for name, law in scenario.controllers.items()}
    if len(parts.errors) > before:
        return None
    return parts.attempt("", System, bodies, joints, forces, gravity=scenario.system.gravity, controllers=controllers)


def _joint(parts: Collector, where: str, table: Any) -> Joint | None:
    values = {key: _value(parts, f"{where}.{key}", value) for key, value in table if value is not None}
    return parts.attempt(where, Joint, **values)


def _value(parts: Collector, where: str, value: Any) -> Any:
    """A value of a joint's table as Joint takes it: a dict by coordinate, a profile, or the value itself."""
    if isinstance(value, schema.Coordinates):
        keys = zip(fields_of(type(value)), value, strict=True)
        return {key: _value(parts, f"{where}.{key}", each) for key, (_, each) in keys if each is not None}
    return profile_of(parts, where, value) if isinstance(value, Smoothed) else value


def _force(parts: Collector, where: str, table: schema.PointForce) -> PointForce | None:
    vectors = {key: getattr(table, key) for key in ("force", "moment")}
    built = {key: components(parts, f"{where}.{key}", vector) for key, vector in vectors.items() if vector is not None}
    return parts.attempt(where, PointForce, table.on, follower=table.follower, **built)


def _controller(parts: Collector, where: str, table: schema.Controller) -> Feedback | None:
    """A controller; None if it is refused, with the reason in `parts`. References are zero unless written."""
    reference = [0.0] * len(table.measure) if table.reference is None else list(table.reference)
    limit = None if table.limit is None else list(table.limit)

    def controller() -> Feedback:
        return Feedback(
            _law(table), table.measure, table.drive, table.sample, delay=table.delay, limit=limit, reference=reference
        )

    return parts.attempt(where, controller)


def _law(table: schema.Controller) -> Any:
    """Law of a controller: its laws in series, or the only one, in discrete time; InputError unless they fit."""
    single = schema.PID, schema.LeadLag, schema.Notch
    for k, law in enumerate(table.law):
        if isinstance(law, single) and (len(table.measure) > 1 or len(table.drive) > 1):
            fix = "name one measurement and one effort, or give gains or a state-space"
            raise InputError(f"law[{k}]", f"is a {law.kind}, of one error and one effort", fix)
    laws = [_LAWS[type(each)](k, each) for k, each in enumerate(table.law)]
    for k, law in enumerate(laws):
        if not isinstance(law, tuple):
            if len(laws) > 1:
                fix = "give it alone, or one in continuous time"
                raise InputError(f"law[{k}].file", f"is in discrete time, in steps of {law.dt:g} s", fix)
            return law
    try:
        return in_series(laws)
    except ValueError:
        fix = "give as many columns as the law before gives values, and as many rows as the next one takes"
        raise InputError("law", "has matrices that do not fit one another", fix) from None


def _matrices(k: int, law: schema.Matrices) -> Any:
    """Matrices A, B, C, D of a table or of its file; a file in discrete time as a state-space with its step."""
    if law.file is None:
        return tuple(np.array(getattr(law, name), dtype=float, ndmin=2) for name in "abcd")
    with placing_within(f"law[{k}]"):
        stored = read_state_space(law.file)
    return stored if stored.dt else (stored.a, stored.b, stored.c, stored.d)


_LAWS: dict[type, Any] = {
    schema.Gains: lambda _, law: gains(law.gains),
    schema.PID: lambda _, law: pid(law.kp, law.ki, law.kd, law.smoothing),
    schema.LeadLag: lambda _, law: lead_lag(law.gain, law.zero, law.pole),
    schema.Notch: lambda _, law: notch(law.frequency, law.depth, law.damping),
    schema.Matrices: _matrices,
}
