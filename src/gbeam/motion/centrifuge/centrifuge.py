"""A three-axis centrifuge that makes a flight's load at one point of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Iterable
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, record, static
from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.bases.base import Base
from gbeam.motion.bases.conditioning import STANDARD_GRAVITY
from gbeam.motion.bases.flight import Flight
from gbeam.motion.centrifuge.course import Course, prepare
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.machine.examples import Machine
from gbeam.motion.centrifuge.machine.kinematics import Axes, control_point_load, forward, moved
from gbeam.motion.centrifuge.machine.limits import Limits, MachineLimits, usage
from gbeam.motion.centrifuge.spin_up import STARTS
from gbeam.motion.centrifuge.target.reachability import shortfalls
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.profiles.profile import sampled
from gbeam.results.machine import LimitUse, Shortfall

MOUNTINGS = {"upright": 1.0, "inverted": -1.0}
_GRID, _MOST = 1e-3, 200_000  # s between the times at which limits are looked at; most of them


@record
class Centrifuge:
    """A beam on a three-axis centrifuge whose axes reproduce a flight's load at the control point.

    The target and the axis motions belong to a span of time: `over` prepares them, as every analysis does for its own
    times; with `span` they are there at once. What the axes do is known only then.

    Parameters
    ----------
    flight : Flight
        Whose load is tracked.
    arm : float
        R, from axis 1 to the control point, m; left out, that of the Machine given as `limits`.
    control_point : float
        x_c, from the root along the beam to the point where axes 2 and 3 meet, m.
    inverse : str
        A key of :data:`gbeam.motion.INVERSES`: ``quasi-static``, ``flat``, ``exact`` or ``planned``.
    limits : MachineLimits, Machine or Limits, optional
        ``planned`` keeps them, the other inverses only report. A Machine, such as one of
        :data:`gbeam.motion.machines`, also gives its idle level where that is left out.
    gravity : bool
        The flight's load is specific force, and gravity is there on the machine.
    idle : float, optional
        Load below which the target is held up to this magnitude, m/s².
    smoothing : float or None
        Width of the kernel that rounds the target's corners, s; None or 0 leaves them.
    mounting : str
        ``upright`` or ``inverted``: which of the two mountings of the specimen in the gimbals.
    start : str
        ``idle``: the arm turns from the first instant. ``rest`` or ``pre-yawed``: it spins up from standstill while the
        target waits, over the time `spin_up`; see :mod:`gbeam.motion.centrifuge.spin_up`.
    spin_up : float, optional
        Time from standstill until the load is followed, s.
    clip : bool
        Whether to carry on with a held target where the gimbals cannot reach; to give `idle` does so too.
    span : tuple of float, optional
        First and last time to prepare for, s.

    Raises
    ------
    InputError
        If a number is impossible or a name unknown; when the target is built, also if the load cannot be followed.
    """

    kind: ClassVar[str] = "centrifuge"
    flight: Flight
    geometry: Geometry
    control_point: Any
    limits: Limits
    method: str = static()
    beginning: str = static()
    idle: Any
    smoothing: Any
    spin_up: Any
    clip: bool = static()
    course: Course | None
    _latest: ClassVar[Any] = None

    def __init__(
        self,
        flight: Flight,
        *,
        arm: Any | None = None,
        control_point: Any,
        inverse: str = "flat",
        limits: MachineLimits | Machine | Limits | None = None,
        gravity: bool = False,
        idle: Any | None = None,
        smoothing: Any | None = 0.06,
        mounting: str = "upright",
        start: str = "idle",
        spin_up: Any | None = None,
        clip: bool = False,
        span: tuple[float, float] | None = None,
    ) -> None:
        if not isinstance(flight, Flight):
            raise InputError("flight", f"is of type {type(flight).__name__}", "give the Flight whose load is tracked")
        for name, value, choices in (
            ("inverse", inverse, INVERSES), ("mounting", mounting, MOUNTINGS), ("start", start, STARTS),
        ):  # fmt: skip
            _choose(name, value, choices)
        if (start == "idle") != (spin_up is None):
            raise InputError("spin_up", f"does not go with start = {start}", "give both start and spin_up, or neither")
        if isinstance(limits, Machine):
            arm, idle = limits.arm if arm is None else arm, limits.idle if idle is None else idle
            limits = limits.limits
        if arm is None:
            raise InputError("arm", "is missing", "give the arm's length, or a machine as limits")
        radius = as_array(positive("arm", arm, "m"))
        assign(
            self,
            flight=flight,
            geometry=Geometry(radius, STANDARD_GRAVITY if gravity else 0.0, np.asarray(MOUNTINGS[mounting])),
            control_point=_position(control_point),
            limits=limits if isinstance(limits, Limits) else Limits(limits),
            method=inverse,
            beginning=start,
            idle=None if idle is None else positive("idle", idle, "m/s²"),
            smoothing=None if smoothing is None else positive("smoothing", smoothing, "s", zero=True),
            spin_up=None if spin_up is None else positive("spin_up", spin_up, "s"),
            clip=bool(clip),
            course=None,
        )
        if span is not None:
            assign(self, course=self._prepared(*span))

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    def over(self, start: float, end: float) -> Self:
        """The machine with its target and axis motions prepared for times from `start` to `end`, s.

        It is itself if it is prepared for these times already; the last one prepared is kept.

        Raises
        ------
        InputError
            If the load cannot be followed there, or the inverse cannot follow its corners.
        """
        slack = 1e-9 * (end - start)
        for known in (self, self._latest):
            if known is None or known.course is None:
                continue
            first, last = known.course.target.span
            exact = abs(start - first) <= slack and abs(end - last) <= slack
            if exact or (known is self and first - slack <= start and end <= last + slack):
                return known
        prepared = self._changed(course=self._prepared(start, end))
        assign(self, _latest=prepared)
        return prepared

    def altered(self, **changes: Any) -> Self:
        """The machine with other arguments, by the constructor's names, prepared for the same times.

        Another control point leaves the axis motions as they are.
        """
        if changes.keys() == {"control_point"}:
            return self._changed(control_point=_position(changes["control_point"]))
        given: dict[str, Any] = {
            "flight": self.flight,
            "arm": self.geometry.arm,
            "control_point": self.control_point,
            "inverse": self.method,
            "limits": self.limits,
            "gravity": self.geometry.gravity > 0,
            "idle": self.idle,
            "smoothing": self.smoothing,
            "mounting": self.mounting,
            "start": self.beginning,
            "spin_up": self.spin_up,
            "clip": self.clip,
            "span": None if self.course is None else self.course.target.span,
        }
        return type(self)(**{**given, **changes})

    def base(self, t: Any) -> Base:
        """Motion of the root at times `t` (s, any shape)."""
        here = forward(self.axes(t), self.geometry.arm, self.geometry.gravity)
        return moved(here, self.control_point * np.array([-1.0, 0.0, 0.0]))

    def axes(self, t: Any) -> Axes:
        """States of the three axes at times `t` (s); :func:`gbeam.motion.axis_history` unwraps the angles."""
        first, second, third = self._ready().derivatives(t, 2)
        return Axes(*first[:2], *second, *third)

    def axes_and_jerks(self, t: Any) -> tuple[Axes, Any]:
        """States of the axes and their jerks (..., 3) rad/s³ at times `t` (s), from the closed forms."""
        first, second, third = self._ready().derivatives(t, 3)
        jerks = first[2], second[3], third[3]
        return Axes(*first[:2], *second[:3], *third[:3]), namespace(*jerks).stack(jerks, axis=-1)

    def reference(self, t: Any) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self._ready().reference(t)

    def actual(self, t: Any) -> Any:
        """Load that the axes make at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual_by(self.axes(t))

    def actual_by(self, axes: Axes) -> Any:
        """Load that given states of the axes make at the control point, base axes, m/s², shape (..., 3)."""
        return control_point_load(axes, self.geometry.arm, self.geometry.gravity)

    def tracking_error(self, t: Any) -> Any:
        """Actual load less the reference at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual(t) - self.reference(t)

    def not_followed(self, t: Any) -> Any:
        """Tell at which times `t` (s) the reference is not the flight's load."""
        return self.target.not_followed(t)

    def episodes(self) -> list[Episode]:
        """Stretches of time in which it is not, with the reason."""
        return self.target.episodes()

    def usage(self) -> tuple[LimitUse, ...]:
        """What the motion uses of the machine's limits, over the target's span."""
        first, last = (float(end) for end in self.target.span)
        time = sampled(first, last, max(_GRID, (last - first) / _MOST))
        axes, jerk = self.axes_and_jerks(time)
        rate = np.stack([axes.rate1, axes.rate2, axes.rate3], axis=1)
        acceleration = np.stack([axes.acceleration1, axes.acceleration2, axes.acceleration3], axis=1)
        return usage(time, rate, acceleration, jerk, self.limits)

    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Where no such machine can make the flight's load, and what would help."""
        return shortfalls(self.target, float(self.geometry.arm))

    @property
    def mounting(self) -> str:
        """Which of the two mountings of the specimen in the gimbals."""
        return next(name for name, sign in MOUNTINGS.items() if sign == self.geometry.sign)

    @property
    def target(self) -> Target:
        """The load to be made, over the span that the machine is prepared for."""
        return self._ready().target

    @property
    def inverse(self) -> Inverse:
        """What makes axis motions of the target, likewise."""
        return self._ready().inverse

    @property
    def breaks(self) -> Any:
        """Times at which an integrator should stop and start afresh, s, shape (b,)."""
        return self.target.load.breaks

    def _ready(self) -> Course:
        if self.course is None:
            raise InputError("span", "is missing: the target belongs to a span of time", "give span, or use over(...)")
        return self.course

    def _prepared(self, start: float, end: float) -> Course:
        return prepare(
            self.flight.acceleration, self.geometry, self.limits, inverse=self.method, start=self.beginning,
            idle=self.idle, smoothing=self.smoothing, spin_up=self.spin_up, clip=self.clip, span=(start, end),
        )  # fmt: skip

    def _changed(self, **fields: Any) -> Self:
        other = copy.copy(self)
        assign(other, _latest=None, **fields)
        return other


def _position(control_point: Any) -> Any:
    return as_array(positive("control_point", control_point, "m", zero=True))


def _choose(where: str, given: str, choices: Iterable[str]) -> None:
    """Raise InputError unless the name is one of the choices."""
    names = tuple(choices)
    if given not in names:
        close = difflib.get_close_matches(str(given), names, n=1)
        guess = f"did you mean {close[0]!r}? " if close else ""
        raise InputError(where, f"is {given!r}", f"{guess}choose one of {', '.join(names)}")
