"""Course of a centrifuge from standstill to standstill: its target, and the inverse, by name, solved for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import as_array, is_jax, is_traced, namespace
from gbeam.arrays.tree import record, static
from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.instant import Flat, Geometry, Inverse, Pose, QuasiStatic, exact, unfollowable
from gbeam.motion.centrifuge.inverses.planned import planned
from gbeam.motion.centrifuge.inverses.spin_up import Ramp, build_ramps
from gbeam.motion.centrifuge.limits import Ends, Limits
from gbeam.motion.centrifuge.target.build import build_target
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.series import where


class Method(NamedTuple):
    """Method by which an inverse is built."""

    # an inverse that plans its own ends says so by its extent
    build: Callable[[Target, Geometry, Limits, Ends], Inverse]
    follows_corners: bool  # of a load that does not turn
    solved: bool  # numerically, and so it needs numbers
    # stretches, s, that it cannot follow
    leaves_out: Callable[[Target, Geometry], list[tuple[float, float]]] | None = None
    plans: bool = False  # for any load within the limits, which takes a second: it is done where the motion is needed


INVERSES: dict[str, Method] = {
    "quasi-static": Method(lambda target, geometry, limits, ends: QuasiStatic(geometry), True, False),
    "flat": Method(lambda target, geometry, limits, ends: Flat(geometry), False, False),
    "exact": Method(lambda target, geometry, limits, ends: exact(target, geometry), False, True, unfollowable),
    "planned": Method(planned, True, True, plans=True),
}


@record
class Course:
    """The target over a span, the inverse solved for it, or yet to be :meth:`solved`, and the way there and back."""

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
    """Build the target of a load over a span, s, and, unless they are planned, the axis motions."""
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
