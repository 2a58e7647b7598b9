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
    """Motions of a centrifuge and its flight over the machine's whole run, at the flight's corners, too."""
    (begin, end), span = (float(time) for time in motion.extent), motion.target.span
    corners = motion.flight.corners((span[1] - span[0]) / _MANY)
    corners = corners[(corners > span[0]) & (corners < span[1])]
    time = np.union1d(times_between(begin, end, _FINE), [*span, *corners])
    flight_base = motion.flight.base(np.clip(time, *span))
    axes = _axes_result(motion, time, flight_base.a_WO_B)
    axes = replace(axes, limits=motion.usage())
    axes = replace(axes, warnings=(*_tracking_warnings(motion, time, axes), *_short_ramps(motion)))
    return Imitated(time, flight_base, motion.base(time), axes)


def axes_result(motion: Centrifuge, time: Floats) -> AxesResult:
    """Axes of a centrifuge at ascending times, s. Use of limits and warnings are those of its whole run."""
    whole_run = imitated(motion)
    assert whole_run.axes is not None
    flight_load = motion.flight.base(np.clip(time, *motion.target.span)).a_WO_B
    axes = _axes_result(motion, time, flight_load)
    return replace(axes, imitated=whole_run, limits=whole_run.axes.limits, warnings=whole_run.axes.warnings)


def _axes_result(motion: Centrifuge, time: Floats, flight_load: Floats) -> AxesResult:
    """Axes at the times (t,), s, beside the flight's load (t, 3), m/s². The limits and warnings are left empty."""
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
        flight=np.asarray(flight_load),
    )


# Shares of a tracking error: the plan's ease is told as a cause if less ease saves the first, and told first if it
# saves the second.
_FELT, _MOST = 0.1, 0.5


def _tracking_warnings(motion: Centrifuge, time: Floats, axes: AxesResult) -> tuple[str, ...]:
    """Warn where the load is followed worst, if that is worse than the inverse aims at, and name the causes.

    The causes are limits used up there and the ease of the plan, which is tried by planning again with less of it.
    """
    error = axes.tracking_error
    share = np.where(axes.not_followed, 0.0, error / np.maximum(np.linalg.norm(axes.reference, axis=1), 1e-12))
    too_large = share > motion.inverse.within
    if not too_large.any():
        return ()
    index = int(np.argmax(np.where(too_large, error, 0.0)))
    causes: list[str] = []
    harder = motion.less_eased()
    if harder is not None:
        remaining = float(np.linalg.norm(harder.tracking_error(time[index])))
        limits = used_up(axes.limit_shares, _reversal_samples(time, index, motion.limits))
        if limits:
            causes.append(f"used up there: {', '.join(limits)}")
        if remaining < (1 - _FELT) * error[index]:
            ease = f"the plan's ease, for ease = {harder.ease:g} leaves {in_g(remaining)} on the same knots"
            causes.insert(len(causes) if remaining > _MOST * error[index] else 0, ease)
    return (
        f"the machine cannot follow the load at {time[index]:.3f} s: error {in_g(error[index])} "
        f"({percent(share[index])}; the plan aims at {100 * motion.inverse.within:.2g} %); "
        f"{'; '.join(causes) or motion.inverse.unless}",
    )


def _reversal_samples(time: Floats, sample: int, limits: Limits) -> slice:
    """Samples near one of the times (t,), s: within the time that an axis needs to reverse its acceleration."""
    _, acceleration, jerk = np.asarray(limits.axes)
    has_limits = np.isfinite(acceleration) & np.isfinite(jerk)
    reversal = float(np.max(2 * acceleration[has_limits] / jerk[has_limits], initial=0.0))
    ends = time[sample] - reversal, np.nextafter(time[sample] + reversal, np.inf)
    return slice(*(int(i) for i in np.searchsorted(time, ends)))


def _short_ramps(motion: Centrifuge) -> tuple[str, ...]:
    """Warn of a spin-up and a spin-down that are too short for the limits, with the time that they need."""
    course = motion.course
    if course is None or course.ramps is None:
        return ()
    warnings = []
    half_width = float(course.target.half_width)  # the target rests only that long before and after the flight
    for name, ramp in zip(("spin-up", "spin-down"), course.ramps, strict=True):
        longer = ramp.lengthened(motion.limits)
        if longer.length > ramp.length:
            enough = np.ceil(100 * (longer.length + half_width)) / 100
            key = name.replace("-", "_")
            warnings.append(
                f'the machine exceeds its limits in the {name}: {key} = "{enough:g} s" or more would keep them'
            )
    return tuple(warnings)
