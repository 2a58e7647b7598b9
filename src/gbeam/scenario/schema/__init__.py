"""The scenario's tables, one file each: what may be written, in which units, and what must agree."""

from gbeam.scenario.schema.beam import Beam, General, PointMass
from gbeam.scenario.schema.model import Model
from gbeam.scenario.schema.motion import Centrifuge, Components, Flight, Hub, Motion
from gbeam.scenario.schema.profile import Constant, Listed, Sine, SmoothStep, Sum, Trapezoid
from gbeam.scenario.schema.response import Response
from gbeam.scenario.schema.scenario import Scenario

__all__ = [
    "Beam",
    "Centrifuge",
    "Components",
    "Constant",
    "Flight",
    "General",
    "Hub",
    "Listed",
    "Model",
    "Motion",
    "PointMass",
    "Response",
    "Scenario",
    "Sine",
    "SmoothStep",
    "Sum",
    "Trapezoid",
]
