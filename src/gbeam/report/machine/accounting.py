"""What a machine makes of a flight, and what is accepted of it: as JSON, and as lines below the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from gbeam.report.words import ends
from gbeam.results.imitation.accounting import Accounting, LoadPeak, PeakPair
from gbeam.results.imitation.criteria import Judged
from gbeam.results.imitation.verdict import change, in_g, percent

UNITS = {"largest_load": "m/s^2", "tip": "m", "root_force": "N", "root_moment": "N m", "stress": "Pa"}
_PLACES = ("place_flight", "place_machine")
SHORTEST = 0.005  # s, of a stretch that is listed
_APART = 5e-4  # s: two peaks are at different times
_NONE = 5e-5  # a smaller error is none
SHOWN = 8  # peaks and stretches listed; a rough record has hundreds


def judged_json(judged: Judged) -> dict[str, Any]:
    """What is accepted, the largest sizes and the accounting of an imitation as JSON."""
    return {
        "accepted": judged.accepted,
        "span": ends(judged.accounting.span),
        "whole": ends(judged.whole or judged.accounting.span),
        "criteria": [asdict(each) | {"passed": each.passed} for each in judged.criteria],
        "not_judged": list(judged.not_judged),
        "peaks": peaks_to_json(judged.peaks),
        "accounting": to_json(judged.accounting),
    }


def judged_lines(judged: Judged) -> Iterator[str]:
    """Say what was accepted, then the accounting."""
    if judged.criteria:
        held = "accepted" if judged.accepted else "not accepted"
        part = f" for {judged.part} only" if judged.part else ""
        yield f"{held}{part}: {', '.join(map(str, judged.criteria))}"
    if judged.not_judged:
        yield f"not judged, as it needs the response, which `gbeam run` has: {', '.join(judged.not_judged)}"
    yield from lines(judged.accounting)


def to_json(accounting: Accounting) -> dict[str, Any]:
    """Accounting as JSON: loads m/s², times s, the rest shares; a reason is null where there is none."""
    return {
        "units": {"load": "m/s^2", "time": "s"},
        "tolerance": accounting.tolerance,
        "tolerance_of": accounting.tolerance_of,
        "tolerance_load": accounting.allowed,
        "idle": accounting.idle,
        "followed_share": accounting.followed_share,
        "peaks": [_peak(each) for each in accounting.peaks],
        "not_followed": [
            {"start": each.start, "end": each.end, "reason": each.reason, "flight_peak": each.flight_peak}
            for each in accounting.not_followed
        ],
        "not_followed_share": accounting.shares,
        "preload": [
            {"start": each.start, "end": each.end, "time": each.time, "load": each.load, "flight": each.flight}
            for each in accounting.preloads
        ],
    }


def _peak(peak: LoadPeak) -> dict[str, Any]:
    ends = ("root", "tip")
    return {
        "time": peak.time,
        "load": peak.load,
        "reproduced": peak.reproduced,
        "ratio": peak.ratio,
        "reason": peak.reason or None,
        "time_machine": peak.time_machine,
        "error": peak.error,
        "instant_error": peak.instant_error,
        "spread": dict(zip(ends, peak.spread, strict=True)),
        "spread_flight": dict(zip(ends, peak.spread_flight, strict=True)),
    }


def peaks_to_json(peaks: Mapping[str, PeakPair]) -> dict[str, Any]:
    """Largest sizes over the flight: m/s², m, N, N m, Pa, s; a place where it is one of the specimen."""
    made = {}
    for name, pair in peaks.items():
        values = asdict(pair) | {"ratio": pair.ratio, "unit": UNITS[name]}
        made[name] = {key: value for key, value in values.items() if key not in _PLACES or name == "largest_load"}
    return made


def lines(accounting: Accounting) -> Iterator[str]:
    """Load peaks, those that are not reproduced first; spread of the load; stretches that are not followed."""
    listed = sorted(accounting.peaks, key=lambda peak: (not peak.reason, -peak.load))[:SHOWN]
    for peak in sorted(listed, key=lambda peak: peak.time):
        # Where the size hides a difference of direction, that is said too.
        turned = f", as a vector {percent(peak.error)}" if peak.error > abs(peak.ratio - 1) + 0.01 else ""
        apart = peak.time_machine - peak.time
        later = f", {abs(1e3 * apart):.0f} ms {'later' if apart > 0 else 'earlier'}" if abs(apart) >= _APART else ""
        made = f"{in_g(peak.reproduced)} ({change(peak.ratio)}{turned}{later})"
        if math.isfinite(peak.instant_error):
            made += f", {percent(peak.instant_error if peak.instant_error > _NONE else 0.0)} off at the same instant"
        yield (
            f"load peak {in_g(peak.load)} at {peak.time:.2f} s: "
            f"{f'not reproduced, {made}: {peak.reason}' if peak.reason else made}"
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
