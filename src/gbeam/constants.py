"""Constants of nature and of the models, and the names that Python and scenarios choose among."""

import math
from typing import Literal

STANDARD_GRAVITY = 9.80665  # m/s²
DEGREE = math.pi / 180  # rad
RPM = math.pi / 30  # a turn in a minute, rad/s
BY_STRAINS = frozenset({"exact", "fourth-order"})  # models whose coordinates are strains, without a unit

ModelKind = Literal["TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact"]
Shapes = Literal["clamped-free", "adapted"]
Pointing = Literal["outward", "inward"]
InverseName = Literal["quasi-static", "flat", "exact", "planned"]
Mounting = Literal["upright", "inverted"]
Start = Literal["rest", "pre-yawed", "idle"]
Integrator = Literal["newmark", "hht", "generalized-alpha", "gauss"]
ToleranceOf = Literal["peak", "instant"]
Sampler = Literal["sobol", "latin", "random", "saltelli"]
State = Literal["equilibrium", "undeformed", "relief"]
Parameter = Literal["beta", "gamma", "alpha", "rho_inf"]  # of integrators
SectionShape = Literal["rectangle", "circle", "tube", "general", "matrices"]
JointKind = Literal["fixed", "revolute", "prismatic", "cylindrical", "universal", "spherical", "free"]
Measure = Literal["root-shear", "root-moment", "vibration", "tip", "load"]  # of a place for a specimen
MachineName = Literal["human-7.6m", "specimen-3.3m", "large-15m"]
PresetName = Literal[  # of tests by standards, on a plain arm
    "mil-std-810h-513-structural",
    "mil-std-810h-513-operational",
    "mil-std-810h-513-crash",
    "aectp-400-404",
    "ecss-e-st-10-03c-acceleration",
    "iec-60068-2-7-ga",
]
RecordQuantity = Literal["specific-force", "acceleration"]
# Of records, in whose place a text may give the size of a count, such as "1 g / 2048".
AccelerationUnit = Literal["g", "m/s^2", "ft/s^2", "mg", "mm/s^2", "cm/s^2", "in/s^2"]
RateUnit = Literal["rad/s", "deg/s", "rpm"]
Vehicle = Literal["aircraft", "rocket", "other"]  # that a record is of
TimeUnit = Literal["s", "ms", "us", "ns", "min", "h", "day"]
Check = Literal["sampling", "spikes", "unit", "sign", "dropouts", "columns", "rest"]  # of a record
Coordinate = Literal["x", "y", "z", "rx", "ry", "rz", "angle", "displacement", "angle_1", "angle_2"]  # of joints
Rate = Literal[Coordinate, "wx", "wy", "wz"]
Verb = Literal["run", "static", "modes", "critical-speed", "path", "plan", "place", "campbell"]  # of questions
Across = Literal["y", "z"]  # the beam
Axis = Literal["x", "y", "z"]
Along = Literal["+x", "-x", "+y", "-y", "+z", "-z"]  # directions along axes
Direction = Literal["x", "y", "z", "rx", "ry", "rz"]  # the last three components of a rotation vector
