"""Motion of a centrifuge's axes at given times, its use of limits, and where it cannot follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gbeam.motion.centrifuge.kinematics import axis_angles
from gbeam.motion.centrifuge.limits import usage
from gbeam.results.machine import AxesResult, LimitUse
from gbeam.results.result import Floats

if TYPE_CHECKING:
    from gbeam.motion.centrifuge.centrifuge import Centrifuge

_USED_UP = 0.99  # share of a limit


def axes_result(motion: Centrifuge, time: Floats) -> AxesResult:
    """Axes of a centrifuge at given times (s, ascending), with its limits and where it cannot follow."""
    axes, jerk = motion.axes_and_jerks(time)
    reference, actual, not_followed = motion.reference(time), motion.actual_by(axes), motion.not_followed(time)
    rate, acceleration = axes.rates, axes.accelerations
    limits = usage(time, rate, acceleration, jerk, motion.limits)
    return AxesResult(
        angle=axis_angles(axes, time),
        rate=rate,
        acceleration=acceleration,
        reference=reference,
        actual=actual,
        not_followed=not_followed,
        episodes=tuple((e.start, e.end, e.reason) for e in motion.episodes()),
        limits=limits,
        shortfalls=motion.shortfalls(),
        control_point=float(motion.place[0]),
        place=np.asarray(motion.place) if np.any(motion.place[1:]) else None,
        turn=np.array(motion.turn) if any(motion.turn) else None,
        warnings=(
            *_broken_promise(motion, time, reference, actual - reference, not_followed, limits),
            *_short_ramps(motion),
        ),
        idle=float(motion.target.idle),
        jerk=jerk,
        span=motion.target.span,
        start=motion.ends.start,
        flight=np.asarray(motion.flight.base(np.clip(time, *motion.target.span)).a_WO_B),
    )


def _broken_promise(
    motion: Centrifuge,
    time: Floats,
    reference: Floats,
    error: Floats,
    not_followed: Floats,
    limits: tuple[LimitUse, ...],
) -> tuple[str, ...]:
    """Say where the load is followed worse than the inverse promises; nothing where it is not."""
    size = np.linalg.norm(error, axis=1)
    share = np.where(not_followed, 0.0, size / np.maximum(np.linalg.norm(reference, axis=1), 1e-12))
    missed = share > motion.inverse.within
    if not missed.any():
        return ()
    worst = int(np.argmax(np.where(missed, size, 0.0)))
    used = ", ".join(f"{use.axis} {use.quantity}" for use in limits if use.share > _USED_UP)
    return (
        f"the target is followed within {share[worst]:.2g} of it only ({size[worst]:.3g} m/s² at {time[worst]:.3f} s), "
        f"where {type(motion.inverse).__name__.lower()} promises {motion.inverse.within:g}: {motion.inverse.unless}"
        + (f" (limits used up: {used})" if used else ""),
    )


def _short_ramps(motion: Centrifuge) -> tuple[str, ...]:
    """Say how long a spin-up and a spin-down the limits need, which were given shorter; nothing where they are not."""
    course = motion.course
    if course is None or course.ramps is None:
        return ()
    words, lead = [], float(course.target.half_width)
    for name, ramp in zip(("spin-up", "spin-down"), course.ramps, strict=True):
        longer = ramp.lengthened(motion.limits)
        if longer.length > ramp.length:
            enough = np.ceil(100 * (longer.length + lead)) / 100
            key = name.replace("-", "_")
            words.append(
                f'the machine exceeds its limits in the {name}: {key} = "{enough:g} s" or more would keep them'
            )
    return tuple(words)
