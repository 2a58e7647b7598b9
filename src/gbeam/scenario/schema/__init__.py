"""The scenario's tables, one file each: what may be written, in which units, and what must agree."""

from gbeam.scenario.schema.beam import Beam, General, Line, Load, PointMass
from gbeam.scenario.schema.motion import AxisLimit, Centrifuge, Components, Flight, Hub, Limits, Motion
from gbeam.scenario.schema.profile import Constant, Listed, Sine, SmoothStep, Sum, Trapezoid
from gbeam.scenario.schema.response import Response
from gbeam.scenario.schema.scenario import Environments, Model, Scenario

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
]
