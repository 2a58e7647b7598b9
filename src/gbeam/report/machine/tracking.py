"""How well a centrifuge follows the load of its flight: the numbers that reports quote."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.results.machine import AxesResult
from gbeam.results.result import Floats


@dataclass(frozen=True)
class Peak:
    """Largest size of a history, and when."""

    max_abs: float
    time_of_max: float


@dataclass(frozen=True)
class Tracking:
    """Largest tracking error while the target is the flight's load.

    Parameters
    ----------
    max : float
        m/s²; NaN where the load was followed at no time.
    time_of_max : float
        s.
    fraction : float
        Of the reference load at that time.
    """

    max: float
    time_of_max: float
    fraction: float


def peak(time: Floats, values: Floats) -> Peak:
    """Largest size of `values` (t,) over `time` (t,)."""
    i = int(np.argmax(np.abs(values)))
    return Peak(float(abs(values[i])), float(time[i]))


def tracking(time: Floats, axes: AxesResult) -> Tracking:
    """Largest tracking error of a centrifuge, where its target is the flight's load."""
    if axes.not_followed.all():
        return Tracking(np.nan, np.nan, np.nan)
    error = np.where(axes.not_followed, -1.0, axes.tracking_error)
    i = int(np.argmax(error))
    size = float(np.linalg.norm(axes.reference[i]))
    return Tracking(float(error[i]), float(time[i]), float(error[i]) / size if size > 0 else np.nan)


def ends(time: Floats, axes: AxesResult) -> dict[str, float | str]:
    """How the machine begins, and its times to the flight and from its end, s, as `time` has them; zero at idle."""
    up, down = (max(float(each), 0.0) for each in (axes.span[0] - time[0], time[-1] - axes.span[1]))
    return {"start": axes.start, "spin_up": up, "spin_down": down}


def ends_line(time: Floats, axes: AxesResult) -> str:
    """The same in words."""
    how = "turning already" if axes.start == "idle" else "from standstill to standstill"
    return f"{how}, from {time[0]:.3f} to {time[-1]:.3f} s on the flight's clock"


def not_followed_stretches(axes: AxesResult) -> list[tuple[float, float, str]]:
    """Stretches in which the target is not the flight's load, s, those that overlap joined with their reasons."""
    joined: list[tuple[float, float, str]] = []
    for start, end, reason in sorted(axes.episodes):
        if joined and start <= joined[-1][1]:
            first, last, reasons = joined[-1]
            both = reasons if reason in reasons else f"{reasons}, {reason}"
            joined[-1] = first, max(last, end), both
        else:
            joined.append((start, end, reason))
    return joined
