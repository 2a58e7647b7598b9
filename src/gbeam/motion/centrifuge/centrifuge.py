"""A three-axis centrifuge that makes a flight's load at one point of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float
from numpy.typing import NDArray

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.bases.base import Base
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.kinematics import Axes, forward, moved
from gbeam.motion.centrifuge.limits import Limits, MachineLimits, usage
from gbeam.motion.centrifuge.spin_up import Start, build_start
from gbeam.motion.centrifuge.target.reachability import shortfalls
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.profiles.profile import sampled
from gbeam.numerics.batching import in_blocks
from gbeam.numerics.time_derivative import with_rate
from gbeam.results.response import LimitUse, Shortfall

_GRID, _MOST = 1e-3, 200_000  # s between the times at which limits are looked at; most of them


class Centrifuge(eqx.Module):
    """A beam on a three-axis centrifuge whose axes reproduce a target at the control point.

    Parameters
    ----------
    target : Target
        From :func:`gbeam.motion.build_target`.
    arm : float
        R, from axis 1 to the control point, m.
    control_point : float
        x_c, from the root along the beam to the point where axes 2 and 3 meet, m.
    inverse : str
        A key of :data:`gbeam.motion.INVERSES`: ``quasi-static``, ``flat``, ``exact`` or ``planned``.
    gravity : bool
        As the target was built.
    sign : int
        +1 or −1: which of the two mountings of the specimen in the gimbals.
    limits : MachineLimits, optional
        Of the machine; ``planned`` keeps them, the others only report.
    start : str
        ``idle``: the arm turns from the first instant. ``rest`` or ``pre-yawed``: it spins up from standstill while the
        target waits, see :mod:`gbeam.motion.centrifuge.spin_up`; the target is then built with a `spin_up`.

    Raises
    ------
    InputError
        If a number is impossible, the inverse unknown, or it cannot follow the target's corners.
    """

    kind: ClassVar[str] = "centrifuge"
    target: Target
    geometry: Geometry
    inverse: Inverse
    limits: Limits
    start: Start
    control_point: Float[Array, ""]

    def __init__(
        self,
        target: Target,
        arm: float,
        control_point: float,
        inverse: str,
        gravity: bool,
        sign: int = 1,
        limits: MachineLimits | None = None,
        start: str = "idle",
    ) -> None:
        if inverse not in INVERSES:
            close = difflib.get_close_matches(str(inverse), INVERSES, n=1)
            guess = f"did you mean {close[0]!r}? " if close else ""
            raise InputError("inverse", f"is {inverse!r}", f"{guess}choose one of {', '.join(INVERSES)}")
        if sign not in (1, -1):
            raise InputError("sign", f"is {sign!r}", "give 1 or -1")
        if gravity != bool(target.gravity > 0):
            raise InputError("gravity", f"is {gravity}, unlike the target's", "build both with the same")
        method = INVERSES[inverse]
        if not target.rounded and (target.turns or not method.follows_corners):
            raise InputError(
                "smoothing", f"is missing: {inverse} cannot follow this load's corners", 'give "60 ms" or so'
            )
        self.target = target
        self.geometry = Geometry(
            jnp.asarray(positive("arm", arm, "m"), dtype=float),
            target.gravity,
            jnp.asarray(sign, dtype=float),
        )
        self.limits = Limits(limits)
        self.start = build_start(start, target, self.geometry)
        self.inverse = method.build(target, self.geometry, self.limits)
        self.control_point = jnp.asarray(positive("control_point", control_point, "m", zero=True), dtype=float)

    def axes(self, t: ArrayLike) -> Axes:
        """States of the three axes at times `t` (s); :func:`axis_history` unwraps the angles."""

        def pose(when: Array) -> tuple[Array, Array, Array]:
            return self.start.pose(self.inverse, self.target.load, when)

        now = jnp.asarray(t, dtype=float)
        (at, rate), (_, acceleration) = with_rate(lambda when: with_rate(pose, when), now)
        return Axes(
            rate1=at[0], acceleration1=rate[0],
            angle2=at[1], rate2=rate[1], acceleration2=acceleration[1],
            angle3=at[2], rate3=rate[2], acceleration3=acceleration[2],
        )  # fmt: skip

    def axes_and_jerks(self, t: ArrayLike) -> tuple[Axes, Float[Array, "*t 3"]]:
        """States of the axes and their jerks (rad/s³) at times `t` (s), from the closed forms."""
        axes, rate = with_rate(self.axes, jnp.asarray(t, dtype=float))
        return axes, jnp.stack([rate.acceleration1, rate.acceleration2, rate.acceleration3], axis=-1)

    def base(self, t: ArrayLike) -> Base:
        """Motion of the root at times `t` (s, any shape)."""
        here = forward(self.axes(t), self.geometry.arm, self.geometry.gravity)
        return moved(here, self.control_point * jnp.array([-1.0, 0.0, 0.0]))

    def reference(self, t: ArrayLike) -> Float[Array, "... 3"]:
        """Load wanted at the control point at times `t` (s), base axes, m/s²."""
        return self.start.load(self.target.load, jnp.asarray(t, dtype=float))

    def actual(self, t: ArrayLike) -> Float[Array, "... 3"]:
        """Load that the axes make at the control point at times `t` (s), base axes, m/s²."""
        return self.actual_by(self.axes(t))

    def actual_by(self, axes: Axes) -> Float[Array, "... 3"]:
        """Load that given states of the axes make at the control point, base axes, m/s²."""
        return forward(axes, self.geometry.arm, self.geometry.gravity).a_WO_B

    def tracking_error(self, t: ArrayLike) -> Float[Array, "... 3"]:
        """Achieved less wanted at times `t` (s), base axes, m/s²."""
        return self.actual(t) - self.reference(t)

    def not_followed(self, t: ArrayLike) -> Bool[Array, "*t"]:
        """Tell at which times `t` (s) what is wanted is not the flight's load."""
        return self.target.not_followed(t)

    def episodes(self) -> list[Episode]:
        """Stretches of time in which it is not, with the reason."""
        return self.target.episodes()

    def usage(self) -> tuple[LimitUse, ...]:
        """What the motion uses of the machine's limits, over the target's span."""
        first, last = (float(end) for end in self.target.span)
        time = sampled(first, last, max(_GRID, (last - first) / _MOST))
        axes, jerk = in_blocks(_states, self, time)
        rate = np.stack([axes.rate1, axes.rate2, axes.rate3], axis=1)
        acceleration = np.stack([axes.acceleration1, axes.acceleration2, axes.acceleration3], axis=1)
        return usage(time, rate, acceleration, jerk, self.limits)

    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Where no such machine can make the flight's load, and what would help."""
        return shortfalls(self.target, float(self.geometry.arm))

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    def over(self, start: float, end: float) -> Self:
        """The centrifuge itself: it is prepared for its target's span."""
        return self

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return self.target.load.breaks


@eqx.filter_jit
def _states(machine: Centrifuge, t: Array) -> tuple[Axes, Array]:
    return machine.axes_and_jerks(t)


@dataclass(frozen=True)
class AxisHistory:
    """Axis motions over a time grid.

    Parameters
    ----------
    time : array, shape (n,)
        s.
    angle1 : array, shape (n,)
        Angle of axis 1, rad, from zero at the first time.
    axes : Axes
        The other states, arrays of shape (n,), angles without jumps.
    """

    time: NDArray[np.float64]
    angle1: NDArray[np.float64]
    axes: Axes


def axis_history(axes: Axes, times: ArrayLike) -> AxisHistory:
    """Unwrap the angles of axes 2 and 3 and integrate that of axis 1.

    Parameters
    ----------
    axes : Axes
        At `times`.
    times : array_like, shape (n,)
        s, ascending, fine enough that no axis turns by half a revolution between two.
    """
    time = np.asarray(times, dtype=float)
    step, rate, acceleration = np.diff(time), np.asarray(axes.rate1), np.asarray(axes.acceleration1)
    # The trapezium rule with its end correction: of fourth order, since the slopes are known.
    turned = step * (rate[1:] + rate[:-1]) / 2 - step**2 * np.diff(acceleration) / 12
    return AxisHistory(
        time=time,
        angle1=np.append(0.0, np.cumsum(turned)),
        axes=replace(axes, angle2=jnp.asarray(np.unwrap(axes.angle2)), angle3=jnp.asarray(np.unwrap(axes.angle3))),
    )
