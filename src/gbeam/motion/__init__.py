"""What the base does: profiles, records, flight, hub and centrifuge. Knows nothing of beams.

Every motion has ``base(t)`` (:class:`Base`) and ``breaks``; a free hub has a torque in its place.
"""

from gbeam.motion.base import Base
from gbeam.motion.centrifuge import AxisHistory, Centrifuge, axis_history
from gbeam.motion.flight import Flight, stack
from gbeam.motion.hub import HubRate, HubTorque
from gbeam.motion.kinematics import Axes, forward, moved
from gbeam.motion.limits import AxisLimit, Limits, MachineLimits, usage
from gbeam.motion.machines import MACHINES, Machine
from gbeam.motion.methods import INVERSES
from gbeam.motion.mount import Mount
from gbeam.motion.piecewise import PiecewiseLinear, constant, table, trapezoid
from gbeam.motion.profile import Profile, Stack, Sum, smoothed
from gbeam.motion.pulse import Sine, SmoothStep
from gbeam.motion.record import STANDARD_GRAVITY, read_record
from gbeam.motion.target import Episode, Target, build_target

__all__ = [
    "INVERSES",
    "MACHINES",
    "STANDARD_GRAVITY",
    "Axes",
    "AxisHistory",
    "AxisLimit",
    "Base",
    "Centrifuge",
    "Episode",
    "Flight",
    "HubRate",
    "HubTorque",
    "Limits",
    "Machine",
    "MachineLimits",
    "Mount",
    "PiecewiseLinear",
    "Profile",
    "Sine",
    "SmoothStep",
    "Stack",
    "Sum",
    "Target",
    "axis_history",
    "build_target",
    "constant",
    "forward",
    "moved",
    "read_record",
    "smoothed",
    "stack",
    "table",
    "trapezoid",
    "usage",
]
