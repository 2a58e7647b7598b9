"""Spin-up of a centrifuge from standstill before the flight, and spin-down to standstill after it.

Before the flight's first time and after its last the target stands still, at a load f₁ with the horizontal part H₁. On
the way the arm turns at ω1 = S(s) Ω, Ω = sqrt(H₁/R), s from 0 at standstill to 1 where the inverse takes over; S is
flat to the fourth order at both ends, so that angles, rates, accelerations and jerks meet the inverse's. The load on
the way has the direction of f₁ (its part along the beam and across it rise together; gravity stays) and the size p H₁:

- ``rest``: p = S². The arm's tangential acceleration R dω1/dt is ignored, as quasi-static does: axis 2 stands still.
- ``pre-yawed``: p = sqrt(S⁴ + (S'/ΩT)²) and axis 2 lags by δ = atan2(dω1/dt, ω1²), so that the load has its direction
  and size all the way. At standstill all of it is tangential: δ is 90°, docs/theory.md, section 8.4.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_traced
from gbeam.arrays.tree import record, static
from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.instant import Geometry, Inverse, Pose, across_beam
from gbeam.motion.centrifuge.kinematics import Axes, control_point_load
from gbeam.motion.centrifuge.limits import Ends, Limits, usage
from gbeam.motion.centrifuge.target.target import Target
from gbeam.numerics.series import Series, arctan2, sqrt, where
from gbeam.results.machine import LimitUse

# rad of ΩT, from which on p never falls: (ΩT)² >= −S''/2S³ everywhere, with S'' = 2520 s³ (1 − s)³ (1 − 2s).
LEAST_TURNED = 2.982
# rad of ΩT where no limit needs more: the arm turns once on the way, and its tangential load, at most
# max(S')/ΩT = 2.461/4π of the horizontal one, stays below a fifth of it.
USUAL_TURNED = 4 * math.pi
_MARGIN = 0.9  # of a limit is used by a length that is found
_SAMPLES = 401  # of a ramp
# Power of 1/T, T the length, with which the use of a limit falls. The arm's rate does not.
_ARM, _GIMBAL = {"acceleration": 1, "power": 1, "jerk": 2}, {"rate": 1, "acceleration": 2, "jerk": 3}


@record
class Ramp:
    """Motion from standstill to a steady state of the machine, or from there to standstill."""

    still: Any  # time of standstill, s
    steady: Any  # time of the steady state, s
    rate: Any  # ω1, rad/s
    yaw: Any  # θ2, rad
    roll: Any  # θ3, rad
    across: Any  # horizontal load across the beam, m/s²
    gravity: float = static()  # γ, m/s²
    yawed: bool = static()  # whether the lag of axis 2 makes up for the tangential acceleration
    outward: float = static()  # way to standstill: −1 of a spin-up, +1 of a spin-down

    def pose(self, t: Any, order: int) -> Pose:
        """Rate of axis 1, rad/s, and angles of axes 2 and 3, rad, at times `t`, s, with derivatives up to `order`.

        S(s) is the rate's share of ω1: a polynomial that is flat at standstill, s = 0, and at the steady state, s = 1.
        """
        s = (Series.variable(t, order) - self.still) / (self.steady - self.still)
        s = where(s.value < 0, 0.0, where(s.value > 1, 1.0, s))
        zeros = 0.0 * s
        turned_angle = self.rate * abs(self.steady - self.still)
        # S over s⁵, where S = s⁵ (126 − 420 s + 540 s² − 315 s³ + 70 s⁴) and S' = 630 s⁴ (1 − s)⁴.
        quotient = 126 - s * (420 - s * (540 - s * (315 - 70 * s)))
        rate_share = s**5 * quotient
        yaw, roll = zeros + self.yaw, zeros + self.roll
        if self.yawed:
            # tan δ = (dω1/dt)/ω1² = S'/(ΩT S²), with the powers of s and 1 − s that both hold taken out.
            lag = math.pi / 2 - arctan2(turned_angle * s**6 * quotient**2, 630 * (1 - s) ** 4)
            yaw = yaw + self.outward * lag
        if self.gravity:
            vertical = zeros + self.gravity
            # The horizontal load's share: S² of the rate alone, sqrt(S⁴ + (S'/ΩT)²) with the tangential acceleration.
            load_share = rate_share**2
            if self.yawed:
                load_share = s**4 * sqrt(s**12 * quotient**4 + (630 * (1 - s) ** 4 / turned_angle) ** 2)
            roll = roll + arctan2(vertical, load_share * self.across) - arctan2(vertical, zeros + self.across)
        return rate_share * self.rate, yaw, roll

    def load(self, t: Any, arm: Any) -> Any:
        """Load that the ramp makes at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        arm_rate, yaw, roll = self.pose(t, 1)
        rate, acceleration = arm_rate.derivatives()
        zeros = 0.0 * rate
        axes = Axes(rate, acceleration, yaw.value, zeros, zeros, roll.value, zeros, zeros)
        return control_point_load(axes, arm, self.gravity)

    @property
    def length(self) -> float:
        """Time from standstill to the steady state or back, s."""
        return abs(float(self.steady) - float(self.still))

    def resize(self, length: Any) -> Ramp:
        """Ramp with another length, s."""
        return replace(self, still=self.steady + self.outward * length)

    def usage(self, limits: Limits) -> tuple[LimitUse, ...]:
        """Use of the machine's limits by the ramp, from times spread evenly over it."""
        first, last = sorted((float(self.still), float(self.steady)))
        time = np.linspace(first, last, _SAMPLES)
        axis1, axis2, axis3 = (series.derivatives() for series in self.pose(time, 3))
        # Axis 1 is described by its rate, axes 2 and 3 by their angles: their rates are first derivatives.
        orders = zip(axis1[:3], axis2[1:], axis3[1:], strict=True)
        rate, acceleration, jerk = (np.stack(values, axis=1) for values in orders)
        return usage(time, rate, acceleration, jerk, limits)

    def lengthened(self, limits: Limits, share: float = 1.0) -> Ramp:
        """Lengthen the ramp until it uses at most `share` of every limit, unless it does already."""
        ramp = self
        for _ in range(50):
            factor = 0.0
            for use in ramp.usage(limits):
                # A quantity falls with a power of the length; the arm's final rate does not depend on it.
                power = (_ARM if use.axis in ("axis 1", "arm") else _GIMBAL).get(use.quantity)
                factor = max(factor, 0.0 if power is None else (use.share / share) ** (1 / power))
            if factor <= 1:
                break
            ramp = ramp.resize(ramp.length * factor * (1 + 1e-4))
        return ramp


def build_ramps(
    target: Target, inverse: Inverse, geometry: Geometry, limits: Limits, ends: Ends
) -> tuple[Ramp, Ramp] | None:
    """Build the spin-up and spin-down around an inverse. None for a machine that begins and ends at idle."""
    if ends.start == "idle":
        return None
    up = _build("spin_up", target, inverse, geometry, limits, ends)
    return up, _build("spin_down", target, inverse, geometry, limits, ends)


def _build(name: str, target: Target, inverse: Inverse, geometry: Geometry, limits: Limits, ends: Ends) -> Ramp:
    """Build the spin-up or spin-down, by name. Its length is that of `ends`, or the shortest that keeps the limits.

    Raises InputError if a given length is so short that the arm's own acceleration exceeds the flight's load.
    """
    outward, edge = (-1.0, target.span[0]) if name == "spin_up" else (1.0, target.span[1])
    # Beyond `steady` the target stands still: a corner at the flight's edge is rounded within half a width of it.
    lead = target.half_width
    steady = as_array(edge + outward * lead)
    rate, yaw, roll = (part.value for part in inverse.pose(target.load, steady, 0))
    ramp = Ramp(
        still=steady + outward * USUAL_TURNED / rate, steady=steady, rate=rate, yaw=yaw, roll=roll,
        across=across_beam(target.load.series(steady, 0), geometry).value, gravity=geometry.gravity,
        yawed=ends.start == "pre-yawed", outward=outward,
    )  # fmt: skip
    length, traced = getattr(ends, name), is_traced(rate, steady)
    if length is None:
        if not traced:
            return ramp.lengthened(limits, _MARGIN)
        if np.isfinite(np.asarray(limits.axes)).any() or np.isfinite(limits.power):
            raise InputError(name, "is found within the limits, and JAX traces the machine", f"give {name}, s")
        return ramp
    if not traced and rate * (length - lead) < LEAST_TURNED:
        enough = np.ceil(100 * (LEAST_TURNED / rate + lead)) / 100
        raise InputError(
            name,
            f"is {length:.3g} s, so short that the arm's own acceleration would load the specimen beyond the flight's "
            f"{'first' if outward < 0 else 'last'} load",
            f'give "{enough:g} s" or more, or leave it out',
        )
    return ramp.resize(length - lead)
