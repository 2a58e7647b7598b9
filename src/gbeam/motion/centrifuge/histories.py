"""Histories of a centrifuge's axes beside the flight that it imitates, with its limits and where it cannot follow."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.kinematics import Axes
from gbeam.motion.centrifuge.limits import Limits
from gbeam.numerics.samples import cumulative
from gbeam.printable import percent
from gbeam.results.accounting import in_g
from gbeam.results.machine import AxesResult, Imitated, used_up


def axis_angles(axes: Axes, times: Any) -> Floats:
    """Angles of the three axes at `times` (n,), (n, 3) rad: that of axis 1 from zero, all without jumps."""
    time = np.asarray(times, dtype=float)
    first = cumulative(time, np.asarray(axes.rate1), np.asarray(axes.acceleration1))
    return np.stack([first, np.unwrap(axes.angle2), np.unwrap(axes.angle3)], axis=1)


_GRID, _FINE, _MANY = 2e-3, 1e-3, 50_000  # s between times: of histories, of loads that are judged; the most of them


def times_between(first: float, last: float, spacing: float = _GRID) -> Floats:
    """Evenly spaced times, s, at which a motion without a response is evaluated."""
    return np.linspace(first, last, min(int(np.ceil((last - first) / spacing)), _MANY) + 1)


def imitated(motion: Centrifuge) -> Imitated:
    """Motions of a centrifuge and its flight from the machine's beginning to its end, at the flight's corners too."""
    (begin, end), span = (float(time) for time in motion.extent), motion.target.span
    corners = motion.flight.corners((span[1] - span[0]) / _MANY)
    time = np.union1d(times_between(begin, end, _FINE), [*span, *corners[(corners > span[0]) & (corners < span[1])]])
    flown = motion.flight.base(np.clip(time, *span))
    axes = _axes_at(motion, time, flown.a_WO_B)
    axes = replace(axes, limits=motion.usage())
    axes = replace(axes, warnings=(*_followed_worse(motion, time, axes), *_short_ramps(motion)))
    return Imitated(time, flown, motion.base(time), axes)


def axes_result(motion: Centrifuge, time: Floats) -> AxesResult:
    """Axes of a centrifuge at given times (s, ascending), with its limits and where it cannot follow, which are those
    of its whole run whatever the times.
    """
    whole = imitated(motion)
    assert whole.axes is not None
    flown = motion.flight.base(np.clip(time, *motion.target.span)).a_WO_B
    axes = _axes_at(motion, time, flown)
    return replace(axes, imitated=whole, limits=whole.axes.limits, warnings=whole.axes.warnings)


def _axes_at(motion: Centrifuge, time: Floats, flown: Floats) -> AxesResult:
    """Axes at given times (t,) s, beside the flight's load (t, 3) m/s² there; without limits and warnings."""
    axes, jerk = motion.axes_and_jerks(time)
    return AxesResult(
        angle=axis_angles(axes, time),
        rate=axes.rates,
        acceleration=axes.accelerations,
        reference=motion.reference(time),
        actual=motion.actual_by(axes),
        not_followed=motion.not_followed(time),
        episodes=tuple((e.start, e.end, e.reason) for e in motion.episodes()),
        shortfalls=motion.shortfalls(),
        arm=float(motion.geometry.arm),
        control_point=float(motion.place[0]),
        place=np.asarray(motion.place) if np.any(motion.place[1:]) else None,
        turn=np.array(motion.turn) if any(motion.turn) else None,
        idle=float(motion.target.idle),
        jerk=jerk,
        span=motion.target.span,
        start=motion.ends.start,
        flight=np.asarray(flown),
    )


_FELT, _MOST = 0.1, 0.5  # of a miss: what less ease takes from it is told from there on, and told first


def _followed_worse(motion: Centrifuge, time: Floats, axes: AxesResult) -> tuple[str, ...]:
    """Warn where the load is followed worst, if worse than the inverse aims at, with what makes the miss there."""
    size = axes.tracking_error
    share = np.where(axes.not_followed, 0.0, size / np.maximum(np.linalg.norm(axes.reference, axis=1), 1e-12))
    missed = share > motion.inverse.within
    if not missed.any():
        return ()
    worst = int(np.argmax(np.where(missed, size, 0.0)))
    causes: list[str] = []
    if (harder := motion.less_eased()) is not None:
        left = float(np.linalg.norm(harder.tracking_error(time[worst])))
        if held := used_up(axes.limit_shares, _around(time, worst, motion.limits)):
            causes.append(f"used up there: {', '.join(held)}")
        if left < (1 - _FELT) * size[worst]:
            eased = f"the plan's ease, for ease = {harder.ease:g} leaves {in_g(left)} on the same knots"
            causes.insert(len(causes) if left > _MOST * size[worst] else 0, eased)
    return (
        f"the machine cannot follow the load at {time[worst]:.3f} s: error {in_g(size[worst])} "
        f"({percent(share[worst])}; the plan aims at {100 * motion.inverse.within:.2g} %); "
        f"{'; '.join(causes) or motion.inverse.unless}",
    )


def _around(time: Floats, at: int, limits: Limits) -> slice:
    """Samples about one of the times (t,), s: as far from it as an axis needs to reverse its acceleration."""
    _, acceleration, jerk = np.asarray(limits.axes)
    known = np.isfinite(acceleration) & np.isfinite(jerk)
    reversal = float(np.max(2 * acceleration[known] / jerk[known], initial=0.0))
    ends = time[at] - reversal, np.nextafter(time[at] + reversal, np.inf)
    return slice(*(int(i) for i in np.searchsorted(time, ends)))


def _short_ramps(motion: Centrifuge) -> tuple[str, ...]:
    """Warn of a spin-up and a spin-down that are too short for the limits, with the time that they need."""
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
