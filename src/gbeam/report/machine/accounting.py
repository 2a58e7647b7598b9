"""Accounting of an imitation and its acceptance, as lines below the verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged
from gbeam.results.imitation.verdict import change, in_g, percent

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
    yield from lines(judged.accounting)


def lines(accounting: Accounting) -> Iterator[str]:
    """Load peaks, those that are not reproduced first; spread of the load; stretches that are not followed."""
    listed = sorted(accounting.peaks, key=lambda peak: (not peak.reason, -peak.load))[:SHOWN]
    for peak in sorted(listed, key=lambda peak: peak.time):
        # Where the size hides a difference of direction, that is said too.
        turned = f", as a vector {percent(peak.error)}" if peak.error > abs(peak.ratio - 1) + 0.01 else ""
        apart = peak.time_machine - peak.time
        later = f", {abs(1e3 * apart):.0f} ms {'later' if apart > 0 else 'earlier'}" if abs(apart) >= _APART else ""
        size = f"{in_g(peak.reproduced)} ({change(peak.ratio)}{turned}{later})"
        if math.isfinite(peak.instant_error):
            size += f", {percent(peak.instant_error if peak.instant_error > _NONE else 0.0)} off at the same instant"
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
