"""The times of a record: increasing, without gaps, evenly spaced, at a plausible interval; the part that is flown."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.io.tables.times import Clock
from gbeam.motion.bases.conditioning import FEWEST, UNEVEN
from gbeam.motion.bases.records.units import UNITS

Span = tuple[float | str | None, float | str | None]

SLOWEST = 5.0  # Hz
_FASTEST, _BRIEF = 1000.0, 10.0  # Hz, s: flight loads need no such rate, and last longer
_USUAL = (1e-3, 0.2)  # s: intervals of flight records
_GAP = 1.9  # of the median interval: a sample is missing, and no clock that jitters is as late


def check_sampling(time: NDArray[np.float64], place: Callable[[int], str], *, jitter: bool) -> float:
    """Refuse times that stand still, go back, jump or wander; return how far they are off even ones, s.

    `time` (t,) s.
    """
    steps = np.diff(time)

    def at(i: int) -> str:
        return f"{time[i + 1]:g} s at {place(i + 1)}, after {time[i]:g} s"

    back = np.flatnonzero(steps <= 0)
    if back.size:
        verb = "repeats" if steps[back[0]] == 0 else "goes back to"
        raise InputError("record.time", f"{verb} {at(int(back[0]))}", "sort the rows and delete repeated ones")
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * median)
    if gaps.size:
        i = int(gaps[0])
        raise InputError(
            "record.time",
            f"has a gap of {steps[i]:g} s from {time[i]:g} s to {time[i + 1]:g} s ({place(i + 1)}); "
            f"the interval is {median:g} s",
            "fill in the missing samples or cut the record there",
        )
    off = np.abs(steps - median)
    uneven = np.flatnonzero(off > UNEVEN * median)
    if uneven.size and not jitter:
        i = int(uneven[0])
        rate = float(f"{(len(time) - 1) / (time[-1] - time[0]):.3g}")
        raise InputError(
            "record.time",
            f"is sampled unevenly: {at(i)}, is {steps[i]:g} s where the interval is {median:g} s",
            f'add resample = "{rate:g} Hz": at equal intervals, by a spline through the samples',
        )
    samples = np.arange(len(time))
    even = np.polynomial.Polynomial.fit(samples, time, 1)(samples)
    return float(np.abs(time - even).max()) if uneven.size else 0.0


def check_interval(time: NDArray[np.float64], unit: str) -> None:
    """Refuse an interval that no record of a flight has, and say which unit of time would make it one.

    `time` (t,) s.
    """
    step, length = float(np.median(np.diff(time))), float(time[-1] - time[0])
    trust = 'if it is right as it is, add skip_checks = ["sampling"]'
    sizes = UNITS["time"]
    number = step / sizes[unit]
    likely = [
        other for other, size in sizes.items() if other != unit and _USUAL[0] <= number * size * (1 + 1e-9) <= _USUAL[1]
    ]
    hint = f'is the time in {likely[0]}? then write time_unit = "{likely[0]}"; ' if likely else ""
    if step > 1 / SLOWEST:
        raise InputError(
            "record.time",
            f"has a sample every {step:g} s ({1 / step:g} Hz), too coarse for the corners of a manoeuvre",
            f"{hint}export the record at 20 Hz or more; {trust}",
        )
    if step < 1 / _FASTEST and length < _BRIEF:
        raise InputError(
            "record.time",
            f"lasts {length:.3g} s with a sample every {step:.3g} s ({1 / step:.4g} Hz), which no flight load needs",
            f"{hint}{trust}",
        )


def part_within(clock: NDArray[np.float64], of_day: Clock | None, span: Span, counted: Callable[[int], str]) -> slice:
    """Return the samples within a span of a record's times.

    `clock` (t,) s.
    """
    if span == (None, None):
        return slice(0, len(clock))
    first, last = float(clock[0]), float(clock[-1])
    interval = float(np.median(np.diff(clock)))
    shown = f"{first:g} to {last:g} s" if of_day is None else f"0 to {last:g} s, 0 s being {of_day.first}"

    def read(key: str, given: float | str | None, otherwise: float) -> float:
        if given is None:
            return otherwise
        number = of_day.seconds(given) if isinstance(given, str) and of_day is not None else given
        if number is None or isinstance(number, str):
            raise InputError(f"record.{key}", f"is {given!r}", f"give a time of the record's own clock, {shown}")
        if not first - interval <= number <= last + interval:
            what = given if isinstance(given, str) else f"{given:g} s"
            raise InputError(f"record.{key}", f"is {what}, and the record lasts {shown}", "give a time of it")
        return float(number)

    begin, end = read("from", span[0], first), read("to", span[1], last)
    slack = 1e-6 * interval
    inside = np.flatnonzero((clock >= begin - slack) & (clock <= end + slack))
    if inside.size < FEWEST:
        problem = f"leaves {counted(inside.size)} from {begin:g} to {end:g} s"
        fix = f"give more of {shown}: {FEWEST} samples at least"
        raise InputError(f"record.{'from' if span[1] is None else 'to'}", problem, fix)
    return slice(int(inside[0]), int(inside[-1]) + 1)
