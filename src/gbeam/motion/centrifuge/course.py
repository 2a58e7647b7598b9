"""Course of a centrifuge from standstill to standstill, and its axis motions."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, is_jax, is_traced, namespace
from gbeam.arrays.tree import record, static
from gbeam.errors import InputError
from gbeam.motion.centrifuge.ends import Ends
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse, Pose
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.inverses.spin_up import Ramp, build_ramps
from gbeam.motion.centrifuge.kinematics import Axes, control_point_load
from gbeam.motion.centrifuge.limits import Limits, usage
from gbeam.motion.centrifuge.target.build import build_target
from gbeam.motion.centrifuge.target.reachability import shortfalls
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.profiles.profile import Profile, sampled
from gbeam.numerics.series import where
from gbeam.results.machine import LimitUse, Shortfall

_GRID, _MOST = 1e-3, 500_000  # s between the times at which limits are looked at; most of them


class AxisMotion:
    """The motion of the three axes of a machine that is prepared for a flight's times."""

    geometry: Geometry
    limits: Limits
    method: str
    ends: Ends
    course: Course | None

    @property
    def extent(self) -> tuple[Any, Any]:
        """First and last time of the motion on the flight's clock, s: from standstill to standstill, or at idle."""
        return self._solved.extent

    def beyond(self, start: float, end: float) -> tuple[Any, Any]:
        """Return the times that the motion goes on before `start` and after `end`, s.

        Nothing where these lie within the times that it is prepared for: a run of a part of a flight is no more.
        """
        (first, last), (begin, finish) = self.target.span, self.extent
        slack = 1e-9 * (last - first)
        return first - begin if start <= first + slack else 0.0, finish - last if end >= last - slack else 0.0

    @property
    def target(self) -> Target:
        """The load to be made, over the span that the machine is prepared for."""
        return self._prepared_for_a_span().target

    @property
    def inverse(self) -> Inverse:
        """Inverse that makes axis motions of the target, likewise."""
        return self._solved.inverse

    def corners(self, step: float) -> NDArray[np.float64]:
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
        return course.solved(self.method, self.limits, self.ends) if course.solution is None else course

    def axes(self, t: Any) -> Axes:
        """States of the three axes at times `t` (s)."""
        first, second, third = self._solved.derivatives(t, 2)
        return Axes(*first[:2], *second, *third)

    def axes_and_jerks(self, t: Any) -> tuple[Axes, Any]:
        """States of the axes and their jerks (..., 3) rad/s³ at times `t` (s), from the closed forms."""
        first, second, third = self._solved.derivatives(t, 3)
        jerks = first[2], second[3], third[3]
        return Axes(*first[:2], *second[:3], *third[:3]), namespace(*jerks).stack(jerks, axis=-1)

    def reference(self, t: Any) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self._solved.reference(t)

    def actual(self, t: Any) -> Any:
        """Load that the axes make at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual_by(self.axes(t))

    def actual_by(self, axes: Axes) -> Any:
        """Load that given states of the `axes` make at the control point, base axes, m/s², shape (..., 3)."""
        return control_point_load(axes, self.geometry.arm, self.geometry.gravity)

    def tracking_error(self, t: Any) -> Any:
        """Actual load less the reference at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.actual(t) - self.reference(t)

    def not_followed(self, t: Any) -> Any:
        """Tell at which times `t` (s) the reference is not the flight's load; spin-up and spin-down are among them."""
        (first, last), now = self.target.span, as_array(t)
        return self.target.not_followed(now) | (now < first) | (now > last)

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


@record
class Course:
    """The target over a span, the inverse solved for it, and how the machine gets there from standstill and back.

    Without a `solution` it is to be :meth:`solved` first.
    """

    target: Target
    geometry: Geometry
    start: str = static()
    solution: Inverse | None = None
    ramps: tuple[Ramp, Ramp] | None = None

    @property
    def inverse(self) -> Inverse:
        """The inverse solved for the target."""
        assert self.solution is not None
        return self.solution

    def solved(self, inverse: str, limits: Limits, ends: Ends) -> Course:
        """Course with the axis motions, and how they begin and end."""
        solution = INVERSES[inverse].build(self.target, self.geometry, limits, ends)
        plans_ends = solution.extent is not None
        ramps = None if plans_ends else build_ramps(self.target, solution, self.geometry, limits, ends)
        return replace(self, solution=solution, ramps=ramps)

    @property
    def extent(self) -> tuple[Any, Any]:
        """First and last time of the motion, s: of standstill, or of the flight where the machine begins at idle."""
        if self.ramps is None:
            return self.target.span if self.inverse.extent is None else self.inverse.extent
        ends = tuple(ramp.still for ramp in self.ramps)
        begin, end = ends if is_traced(*ends) else map(float, ends)
        return begin, end

    def derivatives(self, t: Any, order: int) -> tuple[tuple[Any, ...], ...]:
        """Series of the rate of axis 1 and of the angles of axes 2 and 3 at times `t` (s), each up to `order`."""
        return tuple(series.derivatives() for series in self._pose(as_array(t), order))

    def _pose(self, t: Any, order: int) -> Pose:
        inverse, load = self.inverse, self.target.load
        if self.ramps is None:
            return inverse.pose(load, t if inverse.extent is None else namespace(t).clip(t, *inverse.extent), order)
        first, last = (ramp.steady for ramp in self.ramps)
        ways = list(zip(self.ramps, (t < first, t > last), strict=True))
        for ramp, on_way in ways:
            if not is_jax(on_way) and np.all(on_way):  # what the target costs is spared
                return ramp.pose(t, order)
        pose = inverse.pose(load, namespace(t, first, last).clip(t, first, last), order)
        for ramp, on_way in ways:
            if is_jax(on_way) or np.any(on_way):
                rate, yaw, roll = (where(on_way, a, b) for a, b in zip(ramp.pose(t, order), pose, strict=True))
                pose = rate, yaw, roll
        return pose

    def reference(self, t: Any) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3).

        Before the flight and after it, that of the flight's edge with its horizontal part reduced to what the arm's
        rate makes of it.
        """
        now = as_array(t)
        load = self.target.load(now)
        first, last = self.target.span if self.ramps is None else (ramp.steady for ramp in self.ramps)
        outside = (now < first) | (now > last)
        if self.start == "idle" or not (is_jax(outside) or np.any(outside)):
            return load
        (rate, acceleration), *_ = self.derivatives(now, 1)
        return namespace(load, rate).where(outside[..., None], self._partly(load, rate, acceleration), load)

    def _partly(self, load: Any, rate: Any, acceleration: Any) -> Any:
        """A load with only the part p of what is horizontal; what is across the beam keeps its direction."""
        xp = namespace(load, rate)
        gravity, across = self.geometry.gravity, xp.sum(load[..., 1:] ** 2, axis=-1)
        horizontal = self.geometry.arm * xp.hypot(rate**2, acceleration if self.start == "pre-yawed" else 0.0)
        p = horizontal / xp.sqrt(across + load[..., 0] ** 2 - gravity**2)
        bent = across > 0
        size = xp.sqrt(xp.maximum(across - gravity**2, 0.0) * p**2 + gravity**2)
        factor = xp.where(bent, size / xp.sqrt(xp.where(bent, across, 1.0)), 0.0)
        return load * xp.stack([p, factor, factor], axis=-1)


def prepare(
    load: Profile,
    geometry: Geometry,
    limits: Limits,
    *,
    inverse: str,
    ends: Ends,
    idle: Any | None,
    smoothing: Any | None,
    clip: bool,
    span: tuple[float, float],
) -> Course:
    """Build the target of a load over a span, s, and, unless they are planned, the axis motions.

    Parameters are those of :class:`gbeam.motion.Centrifuge`.
    """
    build = partial(
        build_target, load, span=span, idle=idle, smoothing=smoothing, gravity=geometry.gravity > 0, arm=geometry.arm,
        clip=clip,
    )  # fmt: skip
    target = build()
    method = INVERSES[inverse]
    if not target.rounded and not method.plans and (target.turns or not method.follows_corners):
        raise InputError("smoothing", f"is missing: {inverse} cannot follow this load's corners", 'give "60 ms" or so')
    if method.solved and is_traced(target.load(span[0]), geometry.arm):
        fix = 'choose "flat" or "quasi-static", or prepare the machine of numbers: over(start, end)'
        raise InputError("inverse", f"is {inverse}, solved for numerically, and JAX traces the machine", fix)
    left: list[tuple[float, float]] = []
    while method.leaves_out is not None and (more := method.leaves_out(target, geometry)):
        left += more
        target = build(leave_out=left)
    course = Course(target, geometry, ends.start)
    return course if method.plans else course.solved(inverse, limits, ends)
