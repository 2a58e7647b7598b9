"""Systems of bodies of a scenario as objects of the core."""

from __future__ import annotations

from gbeam.mechanics.tree.system import System
from gbeam.scenario.bodies import OF_TABLE
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.declared import object_of
from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario


def system_of(parts: Collector, scenario: SystemScenario | SpecimenScenario) -> System | None:
    """The system of a scenario, or None if it cannot be made, with the reasons in `parts`."""
    if isinstance(scenario, SpecimenScenario):
        name, table = scenario.specimen
        kind = OF_TABLE[type(table)]
        body = (kind.alone or kind.build)(parts, f"bodies.{name}", table)
        return None if body is None else System.of(body, name)
    errors_before = len(parts.errors)
    bodies = {name: OF_TABLE[type(body)].build(parts, f"bodies.{name}", body) for name, body in scenario.bodies.items()}
    other_tables = {key: object_of(parts, key, getattr(scenario, key)) for key in ("joints", "forces", "controllers")}
    if len(parts.errors) > errors_before:
        return None
    return parts.attempt("", System, bodies, gravity=scenario.system.gravity, **other_tables)
