"""The machine's side alone: a plan over its target's span, and commands at a controller's sample time."""

from __future__ import annotations

import numpy as np

from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.history import axes_result, columns
from gbeam.results.machine import Commands, MachinePlan

_GRID, _MOST = 2e-3, 50_000  # s between the times of the result; most of them
_FINE = 1e-3  # s: the angle of axis 1 is integrated on times no further apart


def plan(name: str, motion: Centrifuge, tracks: str = "") -> MachinePlan:
    """Plan one centrifuge over its target's span.

    Parameters
    ----------
    name : str
        Of the motion.
    motion : Centrifuge
    tracks : str
        Name of the flight.
    """
    first, last = (float(end) for end in motion.target.span)
    count = min(int(np.ceil((last - first) / _GRID)), _MOST)
    time = np.linspace(first, last, count + 1)
    axes = axes_result(motion, time)
    outcome = "done" if axes.within_limits else "limits exceeded"
    return MachinePlan(name, tracks, float(motion.geometry.arm), outcome, axes.exceeding, time, axes)


def commands(motion: Centrifuge, sample: float) -> Commands:
    """Return the axis motions at a controller's sample time, from their closed forms and not by interpolation.

    Parameters
    ----------
    motion : Centrifuge
    sample : float
        s; the last sample is the last that lies within the target's span.
    """
    first, last = (float(end) for end in motion.target.span)
    between = int(np.ceil(sample / _FINE))  # axis 1's angle is an integral: finer than the samples
    count = int(np.floor((last - first) / sample * (1 + 1e-12)))
    time = np.asarray(first + sample / between * np.arange(count * between + 1), dtype=np.float64)
    histories = columns(motion.axes(time), time)
    return Commands(sample, time[::between], *(column[::between] for column in histories))
