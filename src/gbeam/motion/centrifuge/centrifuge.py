"""A three-axis centrifuge that makes a flight's load at one point of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

import copy
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.arrays.namespace import as_array
from gbeam.arrays.tree import assign, record, static
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, positive
from gbeam.guards.ranges import possible
from gbeam.motion.bases.base import Base
from gbeam.motion.bases.flight import Flight
from gbeam.motion.centrifuge.course import AxisMotion, Course, prepare
from gbeam.motion.centrifuge.ends import Ends
from gbeam.motion.centrifuge.inverses.closed_form import Geometry
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.kinematics import forward, moved
from gbeam.motion.centrifuge.limits import Limits, Machine, MachineLimits

MOUNTINGS = {"upright": 1.0, "inverted": -1.0}


@typed
@record
class Centrifuge(AxisMotion):
    """A beam on a three-axis centrifuge whose axes reproduce a flight's load at the control point.

    The machine spins up from standstill before the flight's first time, follows the flight, and spins down after its
    last; its clock is the flight's. Target and axis motions belong to the flight's times: `over` prepares them, as
    every analysis does for its own times; with `span` they are there at once. What the axes do is known only then.

    Parameters
    ----------
    flight : Flight
        Whose load is tracked.
    arm : float
        R, from axis 1 to the control point, m; left out, that of the Machine given as `limits`.
    control_point : float
        x_c, from the root along the beam to the point where axes 2 and 3 meet, m.
    inverse : str
        ``planned``, ``flat``, ``exact`` or ``quasi-static`` (docs/theory.md, section 8.2).
    limits : MachineLimits, Machine or Limits, optional
        ``planned`` keeps them, the other inverses only report. A Machine, such as one of
        :data:`gbeam.machines`, also gives its idle level where that is left out.
    gravity : bool
        True if the flight's load is specific force, of which gravity is a part on the machine; False if it is
        acceleration.
    idle : float, optional
        Load below which the target is held up to this magnitude, m/s².
    smoothing : float or None
        Width of the kernel that rounds the target's corners, s; None or 0, the default, leaves them sharp.
    mounting : str
        Under a load across the beam its tip points along the arm's motion (``upright``) or against it (``inverted``):
        docs/mounting.svg.
    start : str
        ``rest``: from standstill to standstill, the arm's tangential acceleration on the way ignored; ``pre-yawed``:
        likewise, with axis 2 turned across the arm at standstill so that the load has its direction on the way;
        ``idle``: the motion begins and ends in the state that it has at the flight's first and last time.
    spin_up, spin_down : float, optional
        Time from standstill to the flight's first time, and from its last to standstill, s. Left out, the time in
        which the arm turns once on the way, or as much more as nine tenths of every limit need.
    clip : bool
        Whether to carry on with a held target where the gimbals cannot reach; to give `idle` does so too.
    span : tuple of float, optional
        First and last time of the flight to prepare for, s.

    Raises
    ------
    InputError
        If a number is impossible or a name unknown; when the target is built, also if the load cannot be followed.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> print(f"{machine.axes(3.0).rate1:.3f} rad/s")
    4.579 rad/s
    """

    kind: ClassVar[str] = "centrifuge"
    flight: Flight
    geometry: Geometry
    control_point: Any
    limits: Limits
    method: str = static()
    ends: Ends = static()
    idle: Any
    smoothing: Any
    clip: bool = static()
    course: Course | None

    def __init__(
        self,
        flight: Flight,
        *,
        arm: Any | None = None,
        control_point: Any,
        inverse: str = "planned",
        limits: MachineLimits | Machine | Limits | None = None,
        gravity: bool,
        idle: Any | None = None,
        smoothing: Any | None = 0.0,
        mounting: str = "upright",
        start: str = "rest",
        spin_up: float | None = None,
        spin_down: float | None = None,
        clip: bool = False,
        span: tuple[float, float] | None = None,
    ) -> None:
        if not isinstance(flight, Flight):
            raise InputError("flight", f"is of type {type(flight).__name__}", "give the Flight whose load is tracked")
        choice("inverse", inverse, INVERSES)
        choice("mounting", mounting, MOUNTINGS)
        if isinstance(limits, Machine):
            arm, idle = limits.arm if arm is None else arm, limits.idle if idle is None else idle
            limits = limits.limits
        if arm is None:
            raise InputError("arm", "is missing", "give the arm's length, or a machine as limits")
        radius = as_array(positive("arm", arm, "m"))
        possible("arm", "arm", radius)
        if gravity and flight.record is not None and flight.record.quantity == "acceleration":
            problem = "is true, and the record of its flight holds acceleration, not specific force"
            fix = "write gravity = false, or add gravity to the record: its direction changes as the aircraft turns"
            raise InputError("gravity", problem, fix)
        assign(
            self,
            flight=flight,
            geometry=Geometry(radius, STANDARD_GRAVITY if gravity else 0.0, np.asarray(MOUNTINGS[mounting])),
            control_point=_position(control_point),
            limits=limits if isinstance(limits, Limits) else Limits(limits),
            method=inverse,
            ends=Ends(start, spin_up, spin_down),
            idle=None if idle is None else positive("idle", idle, "m/s²"),
            smoothing=None if smoothing is None else positive("smoothing", smoothing, "s", zero=True),
            clip=bool(clip),
            course=None,
        )
        if span is not None:
            assign(self, course=self._prepared(*span))
            assign(self, course=self._solved)

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    @typed
    def over(self, start: float, end: float, *, ahead: bool = True) -> Self:
        """The machine with its target and axis motions prepared for the flight's times from `start` to `end`, s.

        It is itself if it is prepared for these times already. Unless `ahead`, the plan of ``planned`` is made only
        where the motion is needed.

        Raises
        ------
        InputError
            If the load cannot be followed there, or the inverse cannot follow its corners.
        """
        slack, machine = 1e-9 * (end - start), self
        first, last = (np.inf, -np.inf) if self.course is None else self.course.target.span
        if not (first - slack <= start and end <= last + slack):
            machine = self._changed(course=self._prepared(start, end))
        if ahead and machine.course.solution is None:  # type: ignore[union-attr]
            machine = machine._changed(course=machine._solved)
        return machine

    def altered(self, **changes: Any) -> Self:
        """The machine with other arguments, by the constructor's names, prepared for the same times.

        Another control point leaves the axis motions as they are.
        """
        if changes.keys() == {"control_point"}:
            return self._changed(control_point=_position(changes["control_point"]))
        return type(self)(**{**self.arguments, **changes})

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of the constructor by their names, with which the machine is made again."""
        return {
            "flight": self.flight,
            "arm": self.geometry.arm,
            "control_point": self.control_point,
            "inverse": self.method,
            "limits": self.limits,
            "gravity": self.geometry.gravity > 0,
            "idle": self.idle,
            "smoothing": self.smoothing,
            "mounting": self.mounting,
            **vars(self.ends),
            "clip": self.clip,
            "span": None if self.course is None else self.course.target.span,
        }

    def base(self, t: Any) -> Base:
        """Motion of the root at times `t` (s, any shape)."""
        base = forward(self.axes(t), self.geometry.arm, self.geometry.gravity)
        return moved(base, self.control_point * np.array([-1.0, 0.0, 0.0]))

    @property
    def mounting(self) -> str:
        """Which of the two mountings of the specimen in the gimbals."""
        return next(name for name, sign in MOUNTINGS.items() if sign == self.geometry.sign)

    def _prepared(self, start: float, end: float) -> Course:
        return prepare(
            self.flight.acceleration, self.geometry, self.limits, inverse=self.method, ends=self.ends, idle=self.idle,
            smoothing=self.smoothing, clip=self.clip, span=(start, end),
        )  # fmt: skip

    def _changed(self, **fields: Any) -> Self:
        other = copy.copy(self)
        assign(other, **fields)
        return other


def _position(control_point: Any) -> Any:
    return as_array(positive("control_point", control_point, "m", zero=True))
