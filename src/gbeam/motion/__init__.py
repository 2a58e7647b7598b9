"""What the base does: profiles, records, flight, hub and centrifuge. Knows nothing of beams.

Every motion has ``base(t)`` (:class:`Base`) and ``breaks``; a free hub has a torque in its place.
"""

from gbeam.motion.bases.base import Base
from gbeam.motion.bases.flight import Flight, stack
from gbeam.motion.bases.former_hubs import HubRate, HubTorque
from gbeam.motion.bases.hub import Hub
from gbeam.motion.bases.mount import Mount
from gbeam.motion.bases.record import STANDARD_GRAVITY, read_record
from gbeam.motion.centrifuge.centrifuge import AxisHistory, Centrifuge, axis_history
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.kinematics import Axes, forward, moved
from gbeam.motion.centrifuge.limits import AxisLimit, Limits, MachineLimits, usage
from gbeam.motion.centrifuge.machines import MACHINES, Machine
from gbeam.motion.centrifuge.target.target import Episode, Target, build_target
from gbeam.motion.profiles.piecewise import PiecewiseLinear, constant, tabulated, trapezoid
from gbeam.motion.profiles.profile import Profile, Stack, Sum, smoothed
from gbeam.motion.profiles.pulse import Sine, SmoothStep
from gbeam.motion.protocol import Motion

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
    "Hub",
    "HubRate",
    "HubTorque",
    "Limits",
    "Machine",
    "MachineLimits",
    "Motion",
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
    "tabulated",
    "trapezoid",
    "usage",
]
