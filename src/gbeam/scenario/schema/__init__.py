"""The scenario's tables, one file each: what may be written, in which units, and what must agree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gbeam.scenario.schema.profile import Smoothed as Smoothed  # before tables whose values change over time

# isort: split
from gbeam.scenario.schema.arm import Arm as Arm
from gbeam.scenario.schema.beam import Beam as Beam
from gbeam.scenario.schema.beam import Model as Model
from gbeam.scenario.schema.motion import AxisLimit as AxisLimit
from gbeam.scenario.schema.motion import Centrifuge as Centrifuge
from gbeam.scenario.schema.motion import Flight as Flight
from gbeam.scenario.schema.motion import Hub as Hub
from gbeam.scenario.schema.motion import Limits as Limits
from gbeam.scenario.schema.motion import Sensor as Sensor
from gbeam.scenario.schema.response import Response as Response
from gbeam.scenario.schema.scenario import Environments as Environments
from gbeam.scenario.schema.scenario import Scenario as Scenario

if TYPE_CHECKING:
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

_OF_SYSTEMS = {"joints", "forces", "controllers", "system"}


def kind_of_scenario(data: Mapping[str, Any]) -> type[Scenario | SystemScenario | SpecimenScenario]:
    """Class of a scenario by its keys: of one beam, another specimen, or a system, imported only when needed."""
    if "bodies" not in data and ("beam" in data or {"joints", "forces", "system"}.isdisjoint(data)):
        return Scenario
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

    bodies = data.get("bodies")
    is_specimen = isinstance(bodies, Mapping) and len(bodies) == 1 and {*_OF_SYSTEMS, "beam", "model"}.isdisjoint(data)
    return SpecimenScenario if is_specimen else SystemScenario
