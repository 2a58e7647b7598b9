"""Tracking of the load of a flight by its centrifuge: the numbers that reports quote."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from gbeam.report.words import number, percent
from gbeam.results.machine import AxesResult, Driven
from gbeam.results.result import Floats

_EXACT = 1e-9  # of the load: a smaller error is rounding


def tracked(driven: Driven) -> str:
    """Tracking of the load, in words."""
    errors = {"tracking_error": driven.tracking_error, "flight_error": driven.flight_error}
    return followed({name: None if each is None else asdict(each) for name, each in errors.items()})


def followed(facts: Mapping[str, Any]) -> str:
    """Both errors in words, from their JSON."""
    error, of_flight = facts["tracking_error"], facts.get("flight_error")
    if error["max"] is None or math.isnan(error["max"]):
        return "the target is held all the time"
    if of_flight is None:
        return f"target followed {_within(error)}"
    if math.isclose(of_flight["max"], error["max"], rel_tol=1e-6, abs_tol=_EXACT):
        return f"flight's own load followed {_within(of_flight)}"  # the target does not round it
    return f"target followed {_within(error)}; the flight's own load, whose corners it rounds, {_within(of_flight)}"


def _within(error: Mapping[str, Any]) -> str:
    if error["fraction"] is not None and error["fraction"] < _EXACT:
        return "exactly"
    share = math.nan if error["fraction"] is None else error["fraction"]
    return f"within {number(error['max'], 3)} m/s² ({percent(share)} of it) at {error['time_of_max']:.3f} s"


def ends_line(time: Floats, axes: AxesResult) -> str:
    """Beginning and end of the machine, in words."""
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
