"""Motions of the base: profiles, records, flight, hub and centrifuge. Knows nothing of beams.

Every motion is a :class:`Motion`: it has a `kind`, ``base(t)`` (a :class:`Base`), ``corners(step)`` and ``over(start,
end)``; a hub that is `free` to turn has a torque in place of a motion.
"""

from gbeam.motion.arm import plain_arm as plain_arm
from gbeam.motion.centrifuge.centrifuge import Centrifuge as Centrifuge
from gbeam.motion.centrifuge.limits import AxisLimit as AxisLimit
from gbeam.motion.centrifuge.limits import MachineLimits as MachineLimits
from gbeam.motion.centrifuge.limits import machines as machines
from gbeam.motion.flight import Flight as Flight
from gbeam.motion.hub import Hub as Hub
from gbeam.motion.profiles.combine import Sum as Sum
from gbeam.motion.profiles.combine import vector as vector
from gbeam.motion.profiles.piecewise import constant as constant
from gbeam.motion.profiles.piecewise import tabulated as tabulated
from gbeam.motion.profiles.piecewise import trapezoid as trapezoid
from gbeam.motion.profiles.profile import Profile as Profile
from gbeam.motion.profiles.profile import smoothed as smoothed
from gbeam.motion.profiles.pulse import Sine as Sine
from gbeam.motion.profiles.pulse import SmoothStep as SmoothStep
from gbeam.motion.protocol import Motion as Motion
from gbeam.results.parts import Base as Base
