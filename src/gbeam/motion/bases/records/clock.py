"""The times of a record: increasing, without gaps, evenly spaced, and at a plausible interval."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.motion.bases.records.units import UNITS

SLOWEST = 5.0  # Hz
_FASTEST, _BRIEF = 1000.0, 10.0  # Hz, s: flight loads need no such rate, and last longer
_USUAL = (1e-3, 0.2)  # s: intervals of flight records
_UNEVEN, _GAP = 0.01, 1.5  # of the median interval


def check_sampling(time: NDArray[np.float64], place: Callable[[int], str]) -> None:
    """Refuse times that stand still, go back, jump or wander.

    Parameters
    ----------
    time : (t,) s
    place : callable
        Where a sample is in its file, in words.

    Raises
    ------
    InputError
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
    uneven = np.flatnonzero(np.abs(steps - median) > _UNEVEN * median)
    if uneven.size:
        i = int(uneven[0])
        raise InputError(
            "record.time",
            f"is sampled unevenly: {at(i)}, is {steps[i]:g} s where the interval is {median:g} s",
            "resample the record at equal intervals",
        )


def check_interval(time: NDArray[np.float64], unit: str) -> None:
    """Refuse an interval that no record of a flight has, and say which unit of time would make it one.

    Parameters
    ----------
    time : (t,) s
    unit : str
        That the times were read in.

    Raises
    ------
    InputError
        If there are fewer than 5 samples a second, or more than 1000 a second for less than 10 s.
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
