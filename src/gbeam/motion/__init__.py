"""Motions of the base: profiles, records, flight, hub and centrifuge. Knows nothing of beams.

Every motion is a :class:`Motion`: it has a `kind`, ``base(t)`` (a :class:`Base`), ``corners(step)`` and ``over(start,
end)``; a hub that is `free` to turn has a torque in place of a motion.
"""

from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion.bases.base import Base
from gbeam.motion.bases.flight import Flight
from gbeam.motion.bases.hub import Hub, Mount
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.course import INVERSES
from gbeam.motion.centrifuge.kinematics import Axes, axis_angles, forward, moved
from gbeam.motion.centrifuge.limits import AxisLimit, Limits, Machine, MachineLimits, machines, usage
from gbeam.motion.centrifuge.target.build import build_target
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.profiles.combine import Sum, Vector, vector
from gbeam.motion.profiles.piecewise import PiecewiseLinear, constant, tabulated, trapezoid
from gbeam.motion.profiles.profile import Profile, smoothed
from gbeam.motion.profiles.pulse import Sine, SmoothStep
from gbeam.motion.protocol import Motion
from gbeam.motion.records.record import read_record

__all__ = [
    "INVERSES",
    "STANDARD_GRAVITY",
    "Axes",
    "AxisLimit",
    "Base",
    "Centrifuge",
    "Episode",
    "Flight",
    "Hub",
    "Limits",
    "Machine",
    "MachineLimits",
    "Motion",
    "Mount",
    "PiecewiseLinear",
    "Profile",
    "Sine",
    "SmoothStep",
    "Sum",
    "Target",
    "Vector",
    "axis_angles",
    "build_target",
    "constant",
    "forward",
    "machines",
    "moved",
    "read_record",
    "smoothed",
    "tabulated",
    "trapezoid",
    "usage",
    "vector",
]
