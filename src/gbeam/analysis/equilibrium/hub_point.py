"""Operating points on a free hub: the torque that a state needs, and the state that a torque leaves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gbeam.analysis.equilibrium.point import OperatingPoint, beam_acceleration, evaluated_at, placed
from gbeam.errors import ComputationError
from gbeam.mechanics.equations.residuals import OnHub
from gbeam.mechanics.structure import Structure

Array = Any


def _about_rest(point: OperatingPoint) -> tuple[OnHub, Array]:
    """A linear residual about a point, and its y there; where nothing moves the hub's row is the complete one's."""
    residual, y = point.residual, point.y
    assert isinstance(residual, OnHub)
    if point.structure.linear:
        return residual, y
    return OnHub(residual.equations.about(point.about), residual.mount), np.append(y[0], np.zeros(len(y) - 1))


def needed_torque(point: OperatingPoint) -> float:
    """Torque on a free hub that its state needs, the beam at rest relative to the hub, N m."""
    residual, y = _about_rest(point)
    return float(residual(y, point.yd, point.ydd, (0.0, residual.unpack(point.u)[1]))[0])


def angular_momentum(point: OperatingPoint) -> float:
    """Angular momentum that hub and beam have, the beam at rest relative to the hub, N m s."""
    residual, y = _about_rest(point)
    return float(residual.equations.momentum(y, point.yd))


def on_hub(
    structure: Structure,
    hub: Any,
    rate: float,
    acceleration: float = 0.0,
    q: Array | None = None,
    angle: float = 0.0,
    qd: Array | None = None,
) -> OperatingPoint:
    """Operating point on a free hub at a rate, rad/s, and acceleration, rad/s², with the torque that they need."""
    base = hub.mount.base(*(np.asarray(float(x)) for x in (angle, rate, acceleration)))
    at, moving, found, rests = placed(structure, base, q, qd)
    residual = OnHub(structure.on_free_hub(hub), hub.mount)
    y, yd, ydd = (np.append(x, beam) for x, beam in ((angle, at), (rate, moving), (acceleration, 0 * at)))
    u = residual.pack(0.0, structure.load_values)
    if rests:
        u[0] = needed_torque(OperatingPoint(structure, residual, y, yd, ydd, u, base, found))
    else:
        ydd[1:] = beam_acceleration(structure, residual, y, yd, ydd, u)
        u[0] = evaluated_at(structure, residual, y, yd, ydd, u)[0][0]
    return OperatingPoint(structure, residual, y, yd, ydd, u, base, found)


def settled_hub(structure: Structure, hub: Any, time: float, q: Array | None, qd: Array | None) -> OperatingPoint:
    """The point at which a free hub turns steadily at a time, s; see :func:`operating_point`."""
    torque, spring = float(hub.torque(time)), float(hub.stiffness)
    momentum = _momentum_of_the_torque(structure, hub, time, q)
    rate = acceleration = angle = 0.0
    for _ in range(60):
        point = on_hub(structure, hub, rate, acceleration, q, angle)
        needed, has = needed_torque(point), angular_momentum(point)
        if spring > 0:
            turn = (torque - needed) / spring
            if abs(turn) <= 1e-12 * (1 + abs(angle)):
                return on_hub(structure, hub, rate, acceleration, q, angle, qd)
            angle += turn
            continue
        # The beam's own inertia hardly depends on its shape: the rigid hub's step converges fast.
        inertia = angular_momentum(on_hub(structure, hub, 1.0, 0.0, point.q))
        step = (momentum - has) / inertia, (torque - needed) / inertia
        rate, acceleration = rate + step[0], acceleration + step[1]
        if abs(step[0]) <= 1e-12 * (1 + abs(rate)) and abs(step[1]) <= 1e-12 * (1 + abs(acceleration)):
            return on_hub(structure, hub, rate, acceleration, q, qd=qd)
    raise ComputationError(
        "not converged", f"no steady turning of the hub under {torque:.4g} N m at t = {time:.4g} s was found"
    )


def _momentum_of_the_torque(structure: Structure, hub: Any, time: float, q: Array | None) -> float:
    """Angular momentum that torque and damper have left since time zero, N m s."""
    if time <= 0:
        return 0.0
    unit = on_hub(structure, hub, 1.0, q=np.zeros(structure.size) if q is None else q)
    decay = float(hub.damping) / angular_momentum(unit)
    breaks = [float(b) for b in np.asarray(hub.torque.breaks) if 0 < b < time]
    import scipy.integrate  # only a free hub under a torque needs it

    momentum, _ = scipy.integrate.quad(
        lambda t: float(hub.torque(t)) * math.exp(-decay * (time - t)), 0, time, points=breaks or None, limit=200
    )
    return float(momentum)
