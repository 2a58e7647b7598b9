"""The machine's side alone: a plan from standstill to standstill, and commands at a controller's sample time."""

from __future__ import annotations

import numpy as np

from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.history import axes_result, columns
from gbeam.motion.plausibility import implausible_motion
from gbeam.results.machine import Commands, MachinePlan

_GRID, _MOST = 2e-3, 50_000  # s between the times of the result; most of them
_FINE = 1e-3  # s: the angle of axis 1 is integrated on times no further apart


def plan(name: str, motion: Centrifuge, tracks: str = "") -> MachinePlan:
    """Plan one centrifuge over its whole motion.

    Parameters
    ----------
    name : str
        Of the motion.
    motion : Centrifuge
        With the span of the flight that it tracks.
    tracks : str
        Name of the flight.

    Raises
    ------
    InputError
        If the motion has no span, or the load cannot be followed.
    """
    first, last = (float(end) for end in motion.extent)
    count = min(int(np.ceil((last - first) / _GRID)), _MOST)
    time = np.linspace(first, last, count + 1)
    axes = axes_result(motion, time)
    outcome = "done" if axes.within_limits else "limits exceeded"
    where, span = f"motion.{name}" if name else "motion", motion.target.span
    warnings = implausible_motion(motion, where, span)
    warnings += implausible_motion(motion.flight, f"motion.{tracks}" if tracks else "flight", span)
    arm = float(motion.geometry.arm)
    return MachinePlan(name, tracks, arm, outcome, axes.exceeding, time, axes, warnings=(*warnings, *axes.warnings))


def commands(motion: Centrifuge, sample: float) -> Commands:
    """Return the axis motions at a controller's sample time, from their closed forms and not by interpolation.

    Parameters
    ----------
    motion : Centrifuge
    sample : float
        s; one sample is at the flight's first time. The first and the last are those at standstill, or the last that
        lies within the flight where the machine begins and ends at idle.

    Raises
    ------
    InputError
        If there are too many.
    """
    (first, _), (begin, end) = motion.target.span, motion.extent
    still = motion.ends.start != "idle"
    before, after = (float(time) / sample for time in (first - begin, end - first))
    before, after = np.ceil(before - 1e-9), (np.ceil(after - 1e-9) if still else np.floor(after * (1 + 1e-12)))
    refuse_more("sample", "samples", before + after, SAMPLES, 300.0, f"give {(end - begin) / SAMPLES:.2g} s or more")
    between = int(np.ceil(sample / _FINE))  # axis 1's angle is an integral: finer than the samples
    steps = np.arange(-int(before) * between, int(after) * between + 1)
    time = np.asarray(first + sample / between * steps, dtype=np.float64)
    histories = columns(motion.axes(time), time)
    return Commands(sample, time[::between], *(column[::between] for column in histories))
