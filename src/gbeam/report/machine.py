"""Sentences on a centrifuge: tracking of the load, and every part of the flight."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from gbeam.report.words import number, percent
from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged
from gbeam.results.imitation.verdict import change, in_g
from gbeam.results.imitation.verdict import percent as share_of
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


SHORTEST = 0.005  # s, of a stretch that is listed
_APART = 5e-4  # s: two peaks are at different times
_NONE = 5e-5  # a smaller error is none
SHOWN = 8  # peaks and stretches listed; a rough record has hundreds


def judged_lines(judged: Judged) -> Iterator[str]:
    """Say what was accepted, then the accounting."""
    if judged.criteria:
        held = "accepted" if judged.accepted else "not accepted"
        part = f" for {judged.part} only" if judged.part else ""
        yield f"{held}{part}: {', '.join(map(str, judged.criteria))}"
    if judged.not_judged:
        yield f"not judged, as it needs the response, which `gbeam run` has: {', '.join(judged.not_judged)}"
    yield from accounting_lines(judged.accounting)


def accounting_lines(accounting: Accounting) -> Iterator[str]:
    """Load peaks, those that are not reproduced first; spread of the load; stretches that are not followed."""
    listed = sorted(accounting.peaks, key=lambda peak: (not peak.reason, -peak.load))[:SHOWN]
    for peak in sorted(listed, key=lambda peak: peak.time):
        # Where the size hides a difference of direction, that is said too.
        turned = f", as a vector {share_of(peak.error)}" if peak.error > abs(peak.ratio - 1) + 0.01 else ""
        apart = peak.time_machine - peak.time
        later = f", {abs(1e3 * apart):.0f} ms {'later' if apart > 0 else 'earlier'}" if abs(apart) >= _APART else ""
        size = f"{in_g(peak.reproduced)} ({change(peak.ratio)}{turned}{later})"
        if math.isfinite(peak.instant_error):
            size += f", {share_of(peak.instant_error if peak.instant_error > _NONE else 0.0)} off at the same instant"
        yield (
            f"load peak {in_g(peak.load)} at {peak.time:.2f} s: "
            f"{f'not reproduced, {size}: {peak.reason}' if peak.reason else size}"
        )
    if len(accounting.peaks) > SHOWN:
        yield f"load peaks {len(accounting.peaks) - SHOWN} more: see --json"
    if accounting.peaks:
        root, tip = (max((peak.spread[i] for peak in accounting.peaks), key=abs) for i in range(2))
        if math.isfinite(tip):  # of a specimen whose length is known
            yield f"load at these peaks over the control point's: root {change(1 + root)}, tip {change(1 + tip)}"
    # Those below idle are many, and the machine's own lines have them.
    stretches = [
        each for each in accounting.not_followed if each.reason != "below idle" and each.end - each.start > SHORTEST
    ]
    longest = sorted(stretches, key=lambda each: each.start - each.end)[:SHOWN]
    for each in sorted(longest, key=lambda each: each.start):
        yield (
            f"not followed {each.start:.3f} to {each.end:.3f} s: {each.reason}, flight's load up to "
            f"{in_g(each.flight_peak)}"
        )
    if len(stretches) > SHOWN:
        yield f"not followed {len(stretches) - SHOWN} times more: see --json"


def peak_lines(peaks: Mapping[str, PeakPair]) -> Iterator[str]:
    """Largest root loads and stress over the flight."""
    units = {"root_force": (1.0, "N"), "root_moment": (1.0, "N m"), "stress": (1e-6, "MPa")}
    words = []
    for name, (scale, unit) in units.items():
        pair = peaks.get(name, PeakPair())
        if math.isfinite(pair.ratio):
            values = f"{scale * pair.flight:.4g} {unit} in flight, {scale * pair.machine:.4g} {unit}"
            words.append(f"{name.replace('_', ' ')} {values} ({change(pair.ratio)})")
    if words:
        yield f"{'; '.join(words)} on the centrifuge"
