"""How well a centrifuge follows the load of its flight: the numbers that reports quote."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from gbeam.report.words import number, percent
from gbeam.results.machine import AxesResult
from gbeam.results.result import Floats

_EXACT = 1e-9  # of the load: a smaller error is rounding


@dataclass(frozen=True)
class Peak:
    """Largest size of a history, and when."""

    max_abs: float
    time_of_max: float


@dataclass(frozen=True)
class Tracking:
    """Largest error of the load while the target is the flight's.

    Parameters
    ----------
    max : float
        m/s²; NaN where the load was followed at no time.
    time_of_max : float
        s.
    fraction : float
        Of the load that it is an error of, at that time.
    """

    max: float
    time_of_max: float
    fraction: float


def peak(time: Floats, values: Floats) -> Peak:
    """Largest size of `values` (t,) over `time` (t,)."""
    i = int(np.argmax(np.abs(values)))
    return Peak(float(abs(values[i])), float(time[i]))


def tracking(time: Floats, axes: AxesResult, load: Floats | None = None) -> Tracking:
    """Largest error of a centrifuge's load against the target, or against another load (t, 3)."""
    aim = axes.reference if load is None else load
    if axes.not_followed.all():
        return Tracking(np.nan, np.nan, np.nan)
    error = np.where(axes.not_followed, -1.0, np.linalg.norm(axes.actual - aim, axis=1))
    i = int(np.argmax(error))
    size = float(np.linalg.norm(aim[i]))
    return Tracking(float(error[i]), float(time[i]), float(error[i]) / size if size > 0 else np.nan)


def tracking_json(time: Floats, axes: AxesResult) -> dict[str, Any]:
    """Largest errors against the target, whose corners are rounded, and against the flight's own load, as JSON."""
    own = None if axes.flight is None else asdict(tracking(time, axes, axes.flight))
    return {"tracking_error": asdict(tracking(time, axes)), "flight_error": own}


def followed(facts: Mapping[str, Any]) -> str:
    """Both errors in words, from their JSON."""
    error, own = facts["tracking_error"], facts.get("flight_error")
    if error["max"] is None or math.isnan(error["max"]):
        return "the target is held all the time"
    if own is None:
        return f"target followed {_within(error)}"
    if math.isclose(own["max"], error["max"], rel_tol=1e-6, abs_tol=_EXACT):
        return f"flight's own load followed {_within(own)}"  # the target does not round it
    return f"target followed {_within(error)}; the flight's own load, whose corners it rounds, {_within(own)}"


def _within(error: Mapping[str, Any]) -> str:
    if error["fraction"] is not None and error["fraction"] < _EXACT:
        return "exactly"
    share = math.nan if error["fraction"] is None else error["fraction"]
    return f"within {number(error['max'], 3)} m/s² ({percent(share)} of it) at {error['time_of_max']:.3f} s"


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
