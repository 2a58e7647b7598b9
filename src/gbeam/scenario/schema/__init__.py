"""The scenario's tables, one file each: what may be written, in which units, and what must agree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gbeam.scenario.schema.beam import Beam, General, Line, Load, PointMass
from gbeam.scenario.schema.motion import AxisLimit, Centrifuge, Components, Flight, Hub, Limits, Motion
from gbeam.scenario.schema.profile import Constant, Listed, Sine, SmoothStep, Sum, Trapezoid
from gbeam.scenario.schema.response import Response
from gbeam.scenario.schema.scenario import Environments, Model, Scenario

if TYPE_CHECKING:
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

__all__ = [
    "AxisLimit",
    "Beam",
    "Centrifuge",
    "Components",
    "Constant",
    "Environments",
    "Flight",
    "General",
    "Hub",
    "Limits",
    "Line",
    "Listed",
    "Load",
    "Model",
    "Motion",
    "PointMass",
    "Response",
    "Scenario",
    "Sine",
    "SmoothStep",
    "Sum",
    "Trapezoid",
    "kind_of_scenario",
]


_OF_SYSTEMS = {"joints", "forces", "controllers", "system"}


def kind_of_scenario(data: Mapping[str, Any]) -> type[Scenario | SystemScenario | SpecimenScenario]:
    """Table of a scenario as it is written: of one beam, of one other specimen, or of a system of bodies, whose tables
    are made only then.
    """
    if "bodies" not in data and ("beam" in data or {"joints", "forces", "system"}.isdisjoint(data)):
        return Scenario
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

    bodies = data.get("bodies")
    alone = isinstance(bodies, Mapping) and len(bodies) == 1 and {*_OF_SYSTEMS, "beam", "model"}.isdisjoint(data)
    kinds = [each.get("kind") for each in bodies.values() if isinstance(each, Mapping)] if bodies and alone else []
    of_beam = kinds == ["beam"]
    return SpecimenScenario if alone and not of_beam else SystemScenario
