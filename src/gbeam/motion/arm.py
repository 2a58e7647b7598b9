"""A plain arm: one axis that turns up to a level, holds it and stops, with a specimen mounted in any direction."""

from __future__ import annotations

from typing import Annotated, Any, get_args

import numpy as np

from gbeam.arrays.types import Floats, Numbers
from gbeam.constants import STANDARD_GRAVITY, Along
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import vector
from gbeam.guards.quantities import Duration, Jerk, Length, PositionVector, Quantity
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.combine import Sum
from gbeam.motion.profiles.pulse import SmoothStep
from gbeam.results.machine import ArmLevel, Imbalance

STEEPEST = 2.521152657241058  # largest derivative of s(x)² on 0 < x < 1, s(x) = x - sin(2πx)/2π: the rate's SmoothStep
PARALLEL = 1e-6  # of a vector: less of it across another is none
ROUNDING = 1e-9  # of the whole load on an arm: less of it is no imbalance
SAMPLES = 2001  # between corners of the rate


@typed
def plain_arm(
    *,
    radius: Annotated[Length, "from the arm's axis to the control point"],
    control_point: Annotated[
        PositionVector, "point of the specimen at which the level holds, from the root: along x, or [x, y, z]"
    ] = (0.0, 0.0, 0.0),
    load: Annotated[
        Along | Numbers,
        "direction of the specimen that points to the arm's axis: the level accelerates it that way, and it "
        'is felt to be pressed against it, such as "+x", or a vector',
    ],
    up: Annotated[
        Along | Numbers,
        'direction of the specimen that is up: "+z", or a vector; what it has along load does not count',
    ],
    level: Annotated[
        Annotated[float, Quantity("acceleration", "positive")],
        "centripetal acceleration at the control point; gravity comes on top, across it",
    ],
    onset: Annotated[Jerk | None, "largest rate at which the level rises; or ramp"] = None,
    ramp: Annotated[Duration | None, "time T from rest to the level, 2.5212 level/onset; or onset"] = None,
    dwell: Annotated[Duration, "time at the level"],
    down: Annotated[Duration | None, "time from the level to rest; as long as that up where it is left out"] = None,
    gravity: Annotated[bool, "false to leave out the weight, which a test on the ground always has"] = True,
    standard: Annotated[str, "test of a standard that this is, in words: results have it among their notes"] = "",
) -> Hub:
    """Hub that turns up from rest to a level, holds it and stops: a centrifuge of one axis, with a fixed mounting.

    The arm's rate is Ω s(t/T) on the way up, Ω = √(level/radius), s(x) = x − sin(2πx)/2π, and the mirror image on the
    way down, so that neither rate nor angular acceleration jumps. Besides level·s² along `load` the control point has
    the tangential acceleration radius·Ω s'/T on the way, at most 2 √(level·radius)/T.

    Raises
    ------
    InputError
        If a value is impossible, `up` lies along `load`, or onset and ramp are both given or both missing.

    Examples
    --------
    >>> arm = gb.plain_arm(radius=3.3, load="+x", up="+z", level="9 g", ramp=20.0, dwell=60.0)
    >>> arm.base(50.0).a_WO_B.round(4)
    array([88.2598,  0.    ,  9.8066])
    >>> arm.rate.extent
    (0.0, 100.0)
    """
    size = float(level)
    fix = 'give one of onset, such as "0.5 g/s", and ramp, such as "20 s"'
    if onset is not None and ramp is not None:
        raise InputError("onset", "is given beside ramp", fix)
    if onset is not None:
        ramp = STEEPEST * size / onset
    if ramp is None:
        raise InputError("onset", "is missing", fix)
    rate = float(np.sqrt(size / radius))
    steps = SmoothStep(rate, ramp), SmoothStep(-rate, ramp if down is None else down, start=ramp + dwell)
    return Hub(
        radius=radius,
        rate=Sum(steps),
        turn=mounted(load, up),
        control_point=control_point,
        gravity=(0.0, 0.0, -STANDARD_GRAVITY if gravity else 0.0),
        standard=standard,
    )


def direction(where: str, value: Any) -> Floats:
    """Unit vector (3,) of a word such as "+x", or of a vector; InputError if it is neither, or zero."""
    if isinstance(value, str):
        if value not in get_args(Along):
            raise InputError(where, f"is {value!r}", f"give one of {', '.join(get_args(Along))}, or a vector")
        return float(f"{value[0]}1") * np.eye(3)["xyz".index(value[1])]
    components = np.asarray(vector(where, value), dtype=float)
    if not np.any(components):
        raise InputError(where, "is zero", "give a direction, such as [0, 0, 1]")
    return np.asarray(components / np.linalg.norm(components))


def has_part_across(load: Floats, up: Floats) -> bool:
    """Tell if a direction has a part across another, both of length one."""
    return bool(np.linalg.norm(up - (up @ load) * load) > PARALLEL)


def mounted(load: Any, up: Any) -> tuple[float, float, float]:
    """Rotation vector, rad, of a specimen's axes in a hub's: `load` points to the hub's axis, `up` along it."""
    from scipy.spatial.transform import Rotation  # 0.2 s to import, which few motions need

    inward, upward = direction("load", load), direction("up", up)
    if not has_part_across(inward, upward):
        raise InputError("up", f"is {up!r}, along load = {load!r}", "give a direction across it")
    upward = upward - (upward @ inward) * inward
    upward /= np.linalg.norm(upward)
    R_HB = np.array([-inward, np.cross(-upward, inward), upward])
    rx, ry, rz = map(float, Rotation.from_matrix(R_HB).as_rotvec())
    return rx, ry, rz


def extent_of(motion: Any) -> tuple[float, float] | None:
    """First and last time of a plain arm's motion, s, or None of other motions, and of hubs without a control point."""
    if motion is None or motion.kind != "hub" or motion.name != "arm":
        return None
    extent: tuple[float, float] | None = motion.rate.extent
    return extent


def level_of(motion: Any) -> ArmLevel | None:
    """Level that a plain arm holds at its control point, with its times and largest onset. None for other motions, and
    for hubs without a control point.
    """
    extent = extent_of(motion)
    if extent is None:
        return None
    breaks = np.asarray(motion.rate.breaks)
    time = np.unique(np.linspace(breaks[:-1], breaks[1:], SAMPLES))
    rate, acceleration = (np.asarray(values) for values in motion.rate.derivatives(time))
    radius = float(motion.radius)
    top_rate = float(np.abs(rate).max())
    level_times = time[np.abs(rate) >= top_rate * (1 - 1e-12)]
    return ArmLevel(
        level=radius * top_rate**2,
        radius=radius,
        control_point=np.asarray(motion.control_point),
        load=0.0 - np.round(motion.mount.R_HB[0], 12),
        up=0.0 + np.round(motion.mount.R_HB[2], 12),
        rate=top_rate,
        onset=float((2 * radius * rate * acceleration).max()),  # d/dt of radius · rate²
        tangential=float(np.abs(radius * acceleration).max()),
        reached=float(level_times[0]),
        ends=float(level_times[-1]),
    )


def imbalance_of(motion: Any, level: ArmLevel | None, time: Floats, force: Floats, moment: Floats) -> Imbalance | None:
    """Static and dynamic imbalance of what loads an arm's root by forces (t, 3), N, and moments (t, 3), N m.

    The loads are averaged over the second half of the time at the level: deformation and swinging have settled by then.
    None without a level, if the times (t,), s, end before it, or if gravity is not along the arm's axis.
    """
    if level is None or (motion.gravity is not None and np.any(np.asarray(motion.gravity)[:2])):
        return None
    settled = (time >= (level.reached + level.ends) / 2) & (time <= level.ends)
    if not settled.any():
        return None
    root_place, R_HB = np.asarray(motion.mount.place), np.asarray(motion.mount.R_HB)
    force_H, moment_root = R_HB @ force[settled].mean(axis=0), R_HB @ moment[settled].mean(axis=0)
    moment_axis = moment_root + np.cross(root_place, force_H)
    # In the arm's axes: F = Ω² Σ m r, and M = z × (Ω² Σ m z r + g Σ m r), r from the axis.
    weight = 0.0 if motion.gravity is None else -float(motion.gravity[2])
    static = force_H * (1, 1, 0) / level.rate**2
    dynamic = (np.cross(moment_axis, (0, 0, 1)) - weight * static) / level.rate**2
    rounding = ROUNDING * float(np.linalg.norm(force_H)) / level.rate**2
    static[np.abs(static) < rounding] = 0.0
    dynamic[np.abs(dynamic) < rounding * level.radius] = 0.0
    return Imbalance(static, dynamic, level.radius)
