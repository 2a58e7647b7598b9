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
    from gbeam.scenario.schema.system import SystemScenario

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


def kind_of_scenario(data: Mapping[str, Any]) -> type[Scenario | SystemScenario]:
    """Table of a scenario as it is written: of one beam, or of a system of bodies, whose tables are made only then."""
    if "bodies" in data or ("beam" not in data and not {"joints", "forces", "system"}.isdisjoint(data)):
        from gbeam.scenario.schema.system import SystemScenario

        return SystemScenario
    return Scenario
