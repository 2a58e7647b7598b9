"""A hub that turns as prescribed or freely, and where the root is mounted on it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Self, get_args

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record, static
from gbeam.arrays.types import Floats
from gbeam.constants import Pointing
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import vector
from gbeam.guards.quantities import AccelerationVector, PositionVector, Quantity, RotationVector, Seconds, Times
from gbeam.motion.profiles.combine import as_profile
from gbeam.motion.profiles.profile import Profile
from gbeam.motion.rigid import rotation_of, turn_of
from gbeam.results.parts import Base

POINTINGS = get_args(Pointing)


@record
class Mount:
    """The root in the hub's axes H, turned by a constant rotation, its control point on their x axis: by the arguments
    of a Hub.
    """

    radius: Any  # from the hub's axis to the control point, m; may be zero
    R_HB: Any
    place: Any  # (3,) m, of the root in hub axes
    gravity: Any  # (3,) m/s² in hub axes at hub angle zero, or None

    def __init__(
        self,
        radius: Any,
        pointing: Pointing = "outward",
        setting_angle: Any = 0.0,
        gravity: Any | None = None,
        turn: ArrayLike | None = None,
        control_point: Any | None = None,
    ) -> None:
        """Find where the root is mounted, and how it is turned, from the control point and the pointing or the turn."""
        if pointing not in POINTINGS:
            raise InputError("pointing", f"is {pointing!r}", f"choose one of {', '.join(POINTINGS)}")
        if gravity is not None:
            gravity = as_array(gravity)
            if gravity.shape != (3,):
                fix = "give three finite components, along x, y and z of the hub"
                raise InputError("gravity", f"is {gravity!r}", fix)
        radius = as_array(radius)
        xp = namespace(setting_angle)
        c, s = xp.cos(setting_angle), xp.sin(setting_angle)
        # The specimen is turned by the setting angle about its x axis, and by half a turn about z if it points inward.
        about_x = xp.asarray([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        about_z = np.diag([1.0, 1.0, 1.0] if pointing == "outward" else [-1.0, -1.0, 1.0])
        R_HB = about_z @ about_x if turn is None else rotation_of(turn)
        place = radius * np.array([1.0, 0.0, 0.0])
        assign(
            self,
            radius=radius,
            R_HB=R_HB,
            place=place if control_point is None else place - R_HB @ control_point,
            gravity=gravity,
        )

    def base(self, angle: Any, rate: Any, acceleration: Any) -> Base:
        """Motion of the base, specific force where gravity acts, at angles, rates and accelerations of one shape."""
        xp = namespace(angle, rate, acceleration, self.place, self.R_HB, self.gravity)
        a_WO_H = xp.stack(xp.broadcast_arrays(*self.root_acceleration(angle, rate, acceleration)), axis=-1)
        axis = self.R_HB[2]
        return Base(a_WO_H @ self.R_HB, rate[..., None] * axis, acceleration[..., None] * axis)

    def root_acceleration(self, angle: Any, rate: Any, acceleration: Any) -> tuple[Any, Any, Any]:
        """Acceleration of the root by components along the hub's axes, m/s²; specific force where gravity acts.

        `angle`, rad, `rate` and `acceleration` are the hub's.
        """
        xp = namespace(angle, rate, acceleration, self.place, self.gravity)
        radial, lateral = self.place[0], self.place[1]
        x, y = -radial * rate**2 - lateral * acceleration, radial * acceleration - lateral * rate**2
        z = xp.zeros_like(rate)
        if self.gravity is None:
            return x, y, z
        c, s = xp.cos(angle), xp.sin(angle)
        gx, gy, gz = self.gravity
        return x - (c * gx + s * gy), y - (c * gy - s * gx), z - gz


_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_STRIDE = 0.01  # s, between the times at which the angle is stored, where Gauss's rule cannot be tried
_PIECES, _HALVINGS, _EXACT = 32, 20, 1e-14  # from one break to another at first; error of the whole angle, relative


@typed
@record
class Hub:
    """A hub: its rate is prescribed, or it is free to turn under a torque and its angle is an unknown.

    Without a rate and without an inertia it stands still, and serves where only its radius matters: a Campbell
    diagram, a critical speed.

    Raises
    ------
    InputError
        If a value is impossible, a torque is given beside a rate or without an inertia, a spring or damper beside a
        rate, or a turn beside a setting angle.

    Examples
    --------
    >>> hub = gb.Hub(radius=0.5, rate=gb.SmoothStep(3.0, 2.0))
    >>> hub.base(5.0).a_WO_B
    array([-4.5,  0. ,  0. ])
    """

    kind: ClassVar[str] = "hub"
    mount: Mount
    rate: Profile | None
    inertia: Any | None
    torque: Profile | None
    stiffness: Any
    damping: Any
    free: bool = static()
    setting_angle: Any | None
    turn: tuple[float, float, float] | None = static()
    control_point: Any | None
    standard: str = static()
    times: Any
    angles: Any

    def __init__(
        self,
        *,
        radius: Annotated[
            Any,
            Quantity("length", "zero or more", "radius"),
            "from the hub's axis to the root, or to the control point where one is given; may be zero",
        ],
        rate: Annotated[
            Profile | float | None,
            Quantity("angular rate"),
            "the hub's rate about its axis z, over time, its angle zero at time zero; or inertia and torque",
        ] = None,
        inertia: Annotated[
            Any | None,
            Quantity("moment of inertia", "positive"),
            "moment of inertia of the hub about its axis; beside a rate it gives the torque of the drive",
        ] = None,
        torque: Annotated[
            Profile | float | None, Quantity("torque"), "torque about z on a free hub, over time; needs inertia"
        ] = None,
        pointing: Annotated[Pointing, "from the root away from the hub's axis, or towards it and beyond"] = "outward",
        setting_angle: Annotated[
            Any | None,
            Quantity("angle"),
            "turn of the section about the beam; at 0, or left out, its y axis lies in the plane of rotation. A beam "
            "much stiffer in that plane than out of it is then warned of",
        ] = None,
        turn: Annotated[
            RotationVector | None,
            "rotation vector of the root's axes in the hub's, in place of pointing and setting_angle: any mounting",
        ] = None,
        control_point: Annotated[
            PositionVector | None,
            "point that lies at the radius, from the root in its axes; the root itself where left out. The level there "
            "is part of the results",
        ] = None,
        gravity: Annotated[
            AccelerationVector | None,
            'acceleration of free fall [x, y, z] in hub axes at hub angle zero, such as [0, 0, "-1 g"]: x to the root, '
            "z the hub's axis; it keeps its direction as the hub turns",
        ] = None,
        stiffness: Annotated[
            Any,
            Quantity("rotational stiffness", "zero or more"),
            "torsional spring from a free hub to the ground, at ease at the hub's initial angle",
        ] = 0.0,
        damping: Annotated[
            Any, Quantity("rotational damping", "zero or more"), "torsional damper from a free hub to the ground"
        ] = 0.0,
        standard: Annotated[str, "test of a standard that this is, in words: results have it among their notes"] = "",
    ) -> None:
        if torque is not None and rate is not None:
            raise InputError("torque", "is given beside rate", "keep rate or torque, not both")
        if torque is not None and inertia is None:
            raise InputError("inertia", "is missing", 'a hub under a torque needs it: inertia = "200 kg m^2"')
        stiffness, damping = as_array(stiffness), as_array(damping)
        free = rate is None and inertia is not None
        for name, value in (("stiffness", stiffness), ("damping", damping)):
            if not free and (is_traced(value) or value != 0):
                fix = f"leave out {name}, or give inertia and no rate"
                rate_words = " beside rate" if rate is not None else ""
                raise InputError(name, f"is given{rate_words}, and the hub is not free to turn", fix)
        if turn is not None and (setting_angle is not None or pointing != "outward"):
            rate_words = "setting_angle" if setting_angle is not None else "pointing"
            raise InputError("turn", f"is given beside {rate_words}", "keep one: turn says all of the mounting")
        turned = None if turn is None else turn_of(turn)
        controlled = None if control_point is None else vector("control_point", control_point)
        mount = Mount(radius, pointing, 0.0 if setting_angle is None else setting_angle, gravity, turned, controlled)
        assign(
            self,
            mount=mount,
            rate=None if free else as_profile("rate", 0.0 if rate is None else rate),
            inertia=None if inertia is None else as_array(inertia),
            torque=as_profile("torque", 0.0 if torque is None else torque) if free else None,
            stiffness=stiffness,
            damping=damping,
            free=free,
            setting_angle=None if setting_angle is None else as_array(setting_angle),
            turn=turned,
            control_point=controlled,
            standard=standard,
        )
        # Gravity turns in base axes with the hub: only then does the motion of the base need the angle.
        times, angles = self._angles() if gravity is not None and not free else (np.zeros(1), np.zeros(1))
        assign(self, times=times, angles=angles)

    @property
    def name(self) -> str:
        """Name of what turns: an arm where a control point is given, else a hub."""
        return "hub" if self.control_point is None or self.free else "arm"

    @property
    def radius(self) -> Any:
        """From the axis to the control point, which is the root where none is given, m."""
        return self.mount.radius

    @property
    def pointing(self) -> str:
        """outward or inward."""
        return POINTINGS[0] if self.mount.R_HB[0, 0] > 0 else POINTINGS[1]

    @property
    def gravity(self) -> Any | None:
        """Acceleration of free fall, (3,) m/s², in hub axes at hub angle zero, or None without."""
        return self.mount.gravity

    def base(self, t: Times) -> Base:
        """Motion of the base at times `t` (s, any shape): of a root at the radius (−rΩ², r dΩ/dt, 0), hub axes."""
        rate, acceleration = self._prescribed().derivatives(t)
        return self.mount.base(0.0 if self.mount.gravity is None else self.angle(t), rate, acceleration)

    def angle(self, t: Times) -> Any:
        """Angle of a hub with a prescribed rate at times `t` (s, any shape), rad.

        It is the closed integral of the rate where the profile has one. Otherwise Gauss's rule goes on from the last
        stored angle.
        """
        integral = self._prescribed().integral(t)
        if integral is not None:
            return integral - self._prescribed().integral(0.0)
        times, angles = (self.times, self.angles) if self.mount.gravity is not None else self._angles()
        time = as_array(t)
        xp = namespace(time, times, angles)
        last = xp.maximum(xp.searchsorted(xp.asarray(times), time, side="right") - 1, 0)
        return xp.asarray(angles)[last] + self._turned(xp.asarray(times)[last], time)

    def corners(self, step: Seconds) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        driving = self.torque if self.rate is None else self.rate
        assert driving is not None
        return driving.corners(step)

    @typed
    def over(self, start: Seconds, end: Seconds) -> Self:
        """The hub itself, from `start` to `end` (s): it needs no preparation."""
        return self

    def beyond(self, start: Seconds, end: Seconds) -> tuple[float, float]:
        """Nothing before `start` or after `end` (s): a hub has no spin-up of its own."""
        return 0.0, 0.0

    def _prescribed(self) -> Profile:
        if self.rate is None:
            raise InputError("rate", "is not given: how the hub turns is a result", "give rate, or simulate its motion")
        return self.rate

    def _angles(self) -> tuple[Any, Any]:
        """Times, s, and the hub's angles there, rad, counted from time zero.

        The intervals are halved until one step of Gauss's rule, :meth:`_turned`, is exact over each. Where JAX traces
        the rate this cannot be tried, and the intervals are :data:`_STRIDE`.
        """
        rate = self._prescribed()
        breaks = np.append(np.asarray(rate.breaks), 0.0)
        traced = is_traced(rate(breaks))
        spacing = _STRIDE if traced else max(_STRIDE, np.ptp(breaks) / _PIECES)
        times = np.unique(np.append(rate.knots(spacing), breaks))
        steps = self._turned(times[:-1], times[1:])
        xp = namespace(steps)
        for _ in range(0 if traced else _HALVINGS):
            middle = (times[1:] + times[:-1]) / 2
            error = np.abs(self._turned(times[:-1], middle) + self._turned(middle, times[1:]) - steps)
            coarse = error > _EXACT * np.abs(steps).sum()
            if not coarse.any():
                break
            times = np.sort(np.append(times, middle[coarse]))
            steps = self._turned(times[:-1], times[1:])
        sums = xp.concatenate([xp.zeros(1), xp.cumsum(steps)])
        return times, sums - sums[np.searchsorted(times, 0.0)]

    def _turned(self, start: Any, end: Any) -> Any:
        """Angles, rad, by which the hub turns from times to others, s: Gauss's rule."""
        half = (end - start)[..., None] / 2
        values = self._prescribed()(start[..., None] + half * (1 + _POINTS))
        return (half * _WEIGHTS * values).sum(axis=-1)
