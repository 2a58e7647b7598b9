"""What a machine makes of every part of a flight: as JSON, and as lines below the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from gbeam.results.imitation.accounting import Accounting, LoadPeak, PeakPair
from gbeam.results.imitation.verdict import change, in_g, percent

UNITS = {"tip": "m", "root_force": "N", "root_moment": "N m", "stress": "Pa"}
SHORTEST = 0.005  # s, of a stretch that is listed
SHOWN = 8  # peaks and stretches listed; a rough record has hundreds


def to_json(accounting: Accounting) -> dict[str, Any]:
    """Accounting as JSON: loads m/s², times s, the rest shares; a reason is null where there is none."""
    return {
        "units": {"load": "m/s^2", "time": "s"},
        "tolerance": accounting.tolerance,
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
        "spread": dict(zip(ends, peak.spread, strict=True)),
        "spread_flight": dict(zip(ends, peak.spread_flight, strict=True)),
    }


def peaks_to_json(peaks: Mapping[str, PeakPair]) -> dict[str, Any]:
    """Largest sizes over the flight: m, N, N m, Pa, s."""
    return {
        name: {
            "flight": pair.flight,
            "machine": pair.machine,
            "ratio": pair.ratio,
            "time_flight": pair.time_flight,
            "time_machine": pair.time_machine,
            "unit": UNITS[name],
        }
        for name, pair in peaks.items()
    }


def lines(accounting: Accounting) -> Iterator[str]:
    """Load peaks, those that are not reproduced first; spread of the load; stretches that are not followed."""
    listed = sorted(accounting.peaks, key=lambda peak: (not peak.reason, -peak.load))[:SHOWN]
    for peak in sorted(listed, key=lambda peak: peak.time):
        # Where the size hides a difference of direction, that is said too.
        turned = f", as a vector {percent(peak.error)}" if peak.error > abs(peak.ratio - 1) + 0.01 else ""
        made = f"{in_g(peak.reproduced)} ({change(peak.ratio)}{turned})"
        yield (
            f"load peak {in_g(peak.load)} at {peak.time:.2f} s: "
            f"{f'not reproduced, {made}: {peak.reason}' if peak.reason else made}"
        )
    if len(accounting.peaks) > SHOWN:
        yield f"load peaks {len(accounting.peaks) - SHOWN} more: see --json"
    if accounting.peaks:
        root, tip = (max((peak.spread[i] for peak in accounting.peaks), key=abs) for i in range(2))
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
