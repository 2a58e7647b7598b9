"""What the axes of a centrifuge do over time, the load that they make, and what that uses of the machine's limits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.errors import InputError
from gbeam.motion.centrifuge.course import Course
from gbeam.motion.centrifuge.ends import Ends
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.machine.kinematics import Axes, control_point_load
from gbeam.motion.centrifuge.machine.limits import Limits, usage
from gbeam.motion.centrifuge.target.reachability import shortfalls
from gbeam.motion.centrifuge.target.target import Episode, Target
from gbeam.motion.profiles.profile import sampled
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
        """How long the motion goes on before `start` and after `end`, s.

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
        """What makes axis motions of the target, likewise."""
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
        """What the motion uses of the machine's limits, from its beginning to its end."""
        first, last = (float(end) for end in self.extent)
        time = sampled(first, last, max(_GRID, (last - first) / _MOST))
        axes, jerk = self.axes_and_jerks(time)
        return usage(time, axes.rates, axes.accelerations, jerk, self.limits)

    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Where no such machine can make the flight's load, and what would help."""
        # A plan keeps the limits at corners too, and what it misses there is its tracking error.
        return shortfalls(self.target, float(self.geometry.arm), turns=not INVERSES[self.method].plans)
