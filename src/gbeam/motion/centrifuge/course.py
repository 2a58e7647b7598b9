"""What a centrifuge does over one span of time."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import as_array, is_traced
from gbeam.arrays.tree import record
from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.motion.centrifuge.machine.limits import Limits
from gbeam.motion.centrifuge.spin_up import Start, build_start
from gbeam.motion.centrifuge.target.build import build_target
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile


@record
class Course:
    """The target over a span, the inverse solved for it, and how the machine gets under way."""

    target: Target
    inverse: Inverse
    start: Start

    def derivatives(self, t: Any, order: int) -> tuple[tuple[Any, ...], ...]:
        """Of the rate of axis 1 and of the angles of axes 2 and 3 at times `t` (s), each up to `order`."""
        pose = self.start.pose(self.inverse, self.target.load, as_array(t), order)
        return tuple(series.derivatives() for series in pose)

    def reference(self, t: Any) -> Any:
        """Load to be made at the control point at times `t` (s), base axes, m/s², shape (..., 3)."""
        return self.start.load(self.target.load, as_array(t))


def prepare(
    load: Profile,
    geometry: Geometry,
    limits: Limits,
    *,
    inverse: str,
    start: str,
    idle: Any | None,
    smoothing: Any | None,
    spin_up: Any | None,
    clip: bool,
    span: tuple[float, float],
) -> Course:
    """Build the target of a load over a span, s, and solve for the axis motions.

    Parameters are those of :class:`gbeam.motion.Centrifuge`.

    Raises
    ------
    InputError
        If the load cannot be followed, or the inverse cannot follow its corners.
    """
    target = build_target(
        load, span=span, idle=idle, smoothing=smoothing, gravity=geometry.gravity > 0, arm=geometry.arm, clip=clip,
        spin_up=spin_up,
    )  # fmt: skip
    method = INVERSES[inverse]
    if not target.rounded and (target.turns or not method.follows_corners):
        raise InputError("smoothing", f"is missing: {inverse} cannot follow this load's corners", 'give "60 ms" or so')
    if method.solved and is_traced(target.load(span[0]), geometry.arm):
        fix = 'choose "flat" or "quasi-static", or prepare the machine of numbers: over(start, end)'
        raise InputError("inverse", f"is {inverse}, solved for numerically, and JAX traces the machine", fix)
    beginning = build_start(start, target, geometry)
    return Course(target, method.build(target, geometry, limits), beginning)
