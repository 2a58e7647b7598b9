"""A three-axis centrifuge that makes a flight's load at one point of the specimen (Zhang 2020, corrected)."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Self

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, each_leaf, record, static
from gbeam.arrays.types import Floats
from gbeam.constants import STANDARD_GRAVITY, InverseName, Mounting, Start
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, positive, vector
from gbeam.guards.quantities import Duration, Factor, Quantity, RotationVector, Seconds, Times
from gbeam.motion.centrifuge.course import INVERSES, LESS, Course, Planned, prepare, replan
from gbeam.motion.centrifuge.inverses.instant import Geometry, Inverse
from gbeam.motion.centrifuge.kinematics import Axes, control_point_load, forward_kinematics
from gbeam.motion.centrifuge.limits import Ends, Limits, Machine, MachineLimits, usage
from gbeam.motion.centrifuge.target.reachability import shortfalls
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.flight import Flight
from gbeam.motion.profiles.combine import Turned
from gbeam.motion.profiles.profile import Profile, sampled
from gbeam.motion.rigid import rotation_of, shift_base, turn_of
from gbeam.results.machine import LimitUse, Shortfall
from gbeam.results.parts import Base

_GRID, _MOST = 1e-3, 500_000  # s between the times at which limits are looked at; most of them
MOUNTINGS: dict[Mounting, float] = {"upright": 1.0, "inverted": -1.0}


@typed
@record
class Centrifuge:
    """A beam on a three-axis centrifuge whose axes reproduce a flight's load at the control point.

    The machine spins up from standstill before the flight's first time, follows the flight, and spins down after its
    last. Its clock is the flight's. Target and axis motions belong to the flight's times: `over` prepares them, as
    every analysis does for its own times; with `span` they are there at once. What the axes do is known only then.

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
    turn: tuple[float, float, float] = static()
    limits: Limits
    method: str = static()
    ends: Ends = static()
    idle: Any
    smoothing: Any
    clip: bool = static()
    ease: float = static()
    course: Course | None

    def __init__(
        self,
        flight: Annotated[Flight, "flight whose load is tracked"],
        *,
        arm: Annotated[
            Any | None,
            Quantity("length", "positive", "arm"),
            "radius from the main axis to the control point; or that of the machine given as limits",
        ] = None,
        control_point: Annotated[
            Any,
            Quantity("length"),
            "point of the specimen that feels the flight's load, where axes 2 and 3 meet, from the root: along x, or "
            "[x, y, z]",
        ],
        inverse: Annotated[
            InverseName,
            "how the axis motions are found (docs/theory.md, section 8.2). planned: the least tracking error within "
            "the limits, to 1 % of the load or a warning; the others do not know the limits. quasi-static: the arm's "
            "tangential acceleration is ignored; flat: yaw makes up for it; exact: size and direction of the load both "
            "right, to 1e-7 of it or a warning",
        ] = "planned",
        limits: Annotated[
            MachineLimits | Machine | Limits | None,
            "what the machine can do: { axis1, axis2, axis3, inertia, power }. A Machine, such as one of "
            ":data:`gbeam.machines`, also gives arm and idle where they are left out",
        ] = None,
        gravity: Annotated[
            bool,
            "true if the target is specific force, of which gravity is a part on the machine; false if it is "
            "acceleration",
        ],
        idle: Annotated[
            Any | None,
            Quantity("acceleration", "positive"),
            "load below which the target is held up to this magnitude",
        ] = None,
        smoothing: Annotated[
            Any | None,
            Quantity("time", "zero or more"),
            "width of the kernel that rounds the target's corners; 0 leaves them sharp",
        ] = 0.0,
        mounting: Annotated[
            Mounting,
            "which of the two ways the specimen sits in the gimbals. Under a load across it, its tip points along the "
            "arm's motion (upright) or against it (inverted): docs/mounting.svg",
        ] = "upright",
        turn: Annotated[
            RotationVector,
            "which way round the specimen sits in the gimbals: rotation vector of its axes in those of the module that "
            "axis 3 turns, whose x lies along axis 3",
        ] = (0.0, 0.0, 0.0),
        start: Annotated[
            Start,
            "how the machine's motion begins and ends. rest: it spins up from standstill before the flight and down to "
            "it after the flight, the arm's tangential acceleration ignored; pre-yawed: the same with axis 2 turned "
            "across the arm at standstill, so that the load has its right direction all the way; idle: it begins and "
            "ends in the state that it has at the flight's first and last time, which the commands' header gives",
        ] = "rest",
        spin_up: Annotated[
            Duration | None,
            "time from standstill to the flight's first time, such as 10 s; left out, one within nine tenths of the "
            "limits in which the arm turns once or more",
        ] = None,
        spin_down: Annotated[
            Duration | None, "time from the flight's last time to standstill; left out, likewise"
        ] = None,
        clip: Annotated[
            bool, "true to carry on with a held target where the gimbals cannot reach; idle implies it"
        ] = False,
        ease: Annotated[
            Factor,
            "of planned: weight of gentle motion of the axes beside the tracking error, times the usual one; with "
            "less, quick loads are followed better, and the axes move more",
        ] = 1.0,
        span: Annotated[
            tuple[float, float] | None, Quantity("time"), "first and last time of the flight to prepare for"
        ] = None,
    ) -> None:
        if not isinstance(flight, Flight):
            raise InputError("flight", f"is of type {type(flight).__name__}", "give the Flight whose load is tracked")
        choice("inverse", inverse, INVERSES)
        choice("mounting", mounting, MOUNTINGS)
        if isinstance(limits, Machine):
            arm, idle = limits.arm if arm is None else arm, limits.idle if idle is None else idle
            limits = limits.limits
        if arm is None:
            raise InputError(
                "arm", "is missing", 'give arm = "3.3 m", from the main axis to the control point, or a machine'
            )
        radius = as_array(arm)
        if gravity and flight.record is not None and flight.record.quantity == "acceleration":
            problem = "is true, and the record of its flight holds acceleration, not specific force"
            fix = "write gravity = false, or add gravity to the record: its direction changes as the aircraft turns"
            raise InputError("gravity", problem, fix)
        if ease != 1 and not INVERSES[inverse].plans:
            raise InputError("ease", f"is given beside inverse = {inverse}, which plans nothing", "leave it out")
        assign(
            self,
            flight=flight,
            geometry=Geometry(radius, STANDARD_GRAVITY if gravity else 0.0, np.asarray(MOUNTINGS[mounting])),
            control_point=_position(control_point),
            turn=turn_of(turn),
            limits=limits if isinstance(limits, Limits) else Limits(limits),
            method=inverse,
            ends=Ends(start, spin_up, spin_down),
            idle=None if idle is None else as_array(idle),
            smoothing=None if smoothing is None else as_array(smoothing),
            clip=bool(clip),
            ease=float(ease),
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
    def over(self, start: Seconds, end: Seconds, *, ahead: bool = True) -> Self:
        """The machine with its target and axis motions prepared for the flight's times from `start` to `end`, s.

        It is itself if it is prepared for these times already. Unless `ahead`, the plan of ``planned`` is made only
        where the motion is needed.

        Raises
        ------
        InputError
            If the load cannot be followed there, or the inverse cannot follow its corners.
        """
        machine = self
        slack = 1e-9 * (end - start)  # rounding of the times
        first, last = (np.inf, -np.inf) if self.course is None else self.course.target.span
        is_prepared = first - slack <= start and end <= last + slack
        if not is_prepared:
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
        """Arguments of the constructor, by name, that build this machine again."""
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
            "turn": self.turn,
            **vars(self.ends),
            "clip": self.clip,
            "ease": self.ease,
            "span": None if self.course is None else self.course.target.span,
        }

    def base(self, t: Times) -> Base:
        """Motion of the root at times `t` (s, any shape)."""
        return shift_base(self.at_control_point(t), -self.place)

    def at_control_point(self, t: Times) -> Base:
        """Motion of the control point at times `t` (s, any shape), axes of the specimen."""
        base = forward_kinematics(self.axes(t), self.geometry.arm, self.geometry.gravity)
        return each_leaf(self._felt, base) if any(self.turn) else base

    @property
    def place(self) -> Any:
        """Place of the control point from the root, (3,) m."""
        return self.control_point if np.ndim(self.control_point) else self.control_point * np.array([1.0, 0.0, 0.0])

    def _felt(self, vectors: Any) -> Any:
        """Vectors (..., 3) in axes of the specimen, of such in axes of the module that axis 3 turns."""
        return vectors @ rotation_of(self.turn) if any(self.turn) else vectors

    @property
    def extent(self) -> tuple[Any, Any]:
        """First and last time of the motion on the flight's clock, s: from standstill to standstill, or at idle."""
        return self._solved.extent

    def beyond(self, start: Seconds, end: Seconds) -> tuple[Any, Any]:
        """Return how long the machine moves before `start` and after `end`, s: its spin-up and its spin-down.

        Each is zero if its end lies inside the flight, as in a run of a part of it.
        """
        first, last = self.target.span
        begin, finish = self.extent
        slack = 1e-9 * (last - first)
        time_before = first - begin if start <= first + slack else 0.0
        time_after = finish - last if end >= last - slack else 0.0
        return time_before, time_after

    @property
    def target(self) -> Target:
        """The load to be made, over the span that the machine is prepared for."""
        return self._prepared_for_a_span().target

    @property
    def inverse(self) -> Inverse:
        """Inverse that makes axis motions of the target, likewise."""
        return self._solved.inverse

    def corners(self, step: Seconds) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        return self.target.load.corners(step)

    def _prepared_for_a_span(self) -> Course:
        if self.course is None:
            raise InputError("span", "is missing: the target belongs to a span of time", "give span, or use over(...)")
        return self.course

    @property
    def _solved(self) -> Course:
        """The course with its axis motions."""
        course = self._prepared_for_a_span()
        return course.solved(self.method, self.limits, self.ends, self.ease) if course.solution is None else course

    def less_eased(self) -> Self | None:
        """The machine with a plan of less ease, sought from its own, or None with an inverse that plans nothing."""
        course = self._solved
        if not isinstance(course.inverse, Planned):
            return None
        plan = replan(course.inverse, course.target, self.geometry, self.limits, self.ends, self.ease)
        return self._changed(course=replace(course, solution=plan), ease=LESS * self.ease)

    def axes(self, t: Times) -> Axes:
        """States of the three axes at times `t` (s)."""
        first, second, third = self._solved.derivatives(t, 2)
        return Axes(*first[:2], *second, *third)

    def axes_and_jerks(self, t: Times) -> tuple[Axes, Any]:
        """States of the axes and their jerks (..., 3) rad/s³ at times `t` (s), from the closed forms."""
        first, second, third = self._solved.derivatives(t, 3)
        jerks = first[2], second[3], third[3]
        return Axes(*first[:2], *second[:3], *third[:3]), namespace(*jerks).stack(jerks, axis=-1)

    def reference(self, t: Times) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self._felt(self._solved.reference(t))

    def actual(self, t: Times) -> Any:
        """Load that the axes make at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual_by(self.axes(t))

    def actual_by(self, axes: Axes) -> Any:
        """Load that given states of the `axes` make at the control point, base axes, m/s², shape (..., 3)."""
        return self._felt(control_point_load(axes, self.geometry.arm, self.geometry.gravity))

    def tracking_error(self, t: Times) -> Any:
        """Actual load less the reference at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual(t) - self.reference(t)

    def not_followed(self, t: Times) -> Any:
        """Tell at which times `t` (s) the reference is not the flight's load. Spin-up and spin-down are among them."""
        (first, last), time = self.target.span, as_array(t)
        return self.target.not_followed(time) | (time < first) | (time > last)

    def episodes(self) -> list[Episode]:
        """Stretches of the flight's time in which it is not, with the reason."""
        return self.target.episodes()

    def usage(self) -> tuple[LimitUse, ...]:
        """Use of the machine's limits by the motion, from its beginning to its end."""
        first, last = (float(end) for end in self.extent)
        time = sampled(first, last, max(_GRID, (last - first) / _MOST))
        axes, jerk = self.axes_and_jerks(time)
        return usage(time, axes.rates, axes.accelerations, jerk, self.limits)

    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Stretches in which no such machine can make the flight's load, and what would help."""
        # A plan keeps the limits at corners too, and what it misses there is its tracking error.
        return shortfalls(self.target, float(self.geometry.arm), turns=not INVERSES[self.method].plans)

    @property
    def mounting(self) -> Mounting:
        """Name of the mounting of the specimen in the gimbals, upright or inverted."""
        return next(name for name, sign in MOUNTINGS.items() if sign == self.geometry.sign)

    def _prepared(self, start: float, end: float) -> Course:
        """Build the course for a span of the flight's time, s, with the load in axes of the module on axis 3."""
        load: Profile = self.flight.acceleration
        if any(self.turn):
            load = Turned(load, rotation_of(self.turn))
        try:
            return prepare(
                load, self.geometry, self.limits, inverse=self.method, ends=self.ends, idle=self.idle,
                smoothing=self.smoothing, clip=self.clip, span=(start, end),
            )  # fmt: skip
        except InputError as error:
            if not any(self.turn):
                raise
            fix = f"{error.fix}; of a specimen that is turned, the beam stands for what lies along axis 3"
            raise InputError(error.where, error.problem, fix) from None

    def _changed(self, **fields: Any) -> Self:
        copied = copy.copy(self)
        assign(copied, **fields)
        return copied


def _position(control_point: Any) -> Any:
    if np.ndim(control_point):
        return as_array(vector("control_point", control_point))
    return as_array(positive("control_point", control_point, "m", zero=True))
