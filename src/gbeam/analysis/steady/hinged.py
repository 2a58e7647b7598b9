"""Steady turning of a system on a hinge that an effort has turned freely since time zero."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.rest import steady_state, undeformed
from gbeam.errors import ComputationError
from gbeam.mechanics.tree.system import System

CLOSE, MOST = 1e-12, 60  # corrections of rate and acceleration: of their sizes, and their number


def turned_by_effort(system: System, joint: str, time: float) -> Drive:
    """Drives of a system that turns steadily at a time, s, about the first hinge on the ground, which nothing else
    holds.

    Its rate has the angular momentum of effort and damper since time zero, its acceleration is that by the effort of
    the time. ComputationError where no such state is found.
    """
    ((angle, effort),) = system.joints[joint].efforts.items()
    drive = Drive(None, time, f"{joint}.{angle}", rate=0.0)
    k = system.tree.unknowns.tolist().index(system.coordinates.index(drive.coordinate))
    momentum = _momentum(system, joint, inertia_along(undeformed(system).point, k), time)
    for _ in range(MOST):
        point, rate = steady_state(system, drive).point, drive.rate or 0.0
        residual, inertia = point.tree(point.y, point.yd, point.ydd, point.inputs)[k], inertia_along(point, k)
        step = momentum / inertia - rate, -float(residual) / inertia
        drive = replace(drive, rate=rate + step[0], faster=drive.faster + step[1])
        # The bodies' own inertia hardly depends on their shape: the step of a rigid system converges fast.
        if abs(step[0]) <= CLOSE * (1 + abs(rate)) and abs(step[1]) <= CLOSE * (1 + abs(drive.faster)):
            return drive
    problem = f"no steady turning of the hub under {float(effort(time)):.4g} N m at t = {time:.4g} s was found"
    raise ComputationError("not converged", problem)


def inertia_along(point: Point, k: int) -> float:
    """Inertia, kg m² or kg, that a unit acceleration of the k-th free coordinate of a state moves."""
    faster = point.ydd + np.equal(np.arange(len(point.y)), k)
    by_faster = point.tree(point.y, point.yd, faster, point.inputs)
    return float((by_faster - point.tree(point.y, point.yd, point.ydd, point.inputs))[k])


def _momentum(system: System, joint: str, inertia: float, time: float) -> float:
    """Angular momentum, N m s, at a time: what the effort has given since time zero, minus what the damper has taken.

    It is ∫ effort(t) exp(−(d/I) (time − t)) dt.
    """
    if time <= 0:
        return 0.0
    import scipy.integrate  # only a free hinge under an effort needs it

    (effort,), decay = system.joints[joint].efforts.values(), float(system.joints[joint].holder.damping[0]) / inertia
    breaks = [float(b) for b in np.asarray(effort.breaks) if 0 < b < time]
    momentum, _ = scipy.integrate.quad(
        lambda t: float(effort(t)) * math.exp(-decay * (time - t)), 0, time, points=breaks or None, limit=200
    )
    return float(momentum)
