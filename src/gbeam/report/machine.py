"""Sentences on a centrifuge: tracking of the load, every part of the flight, the place of the specimen."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from gbeam.report.words import number, percent, sentence, warning_lines
from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Judged
from gbeam.results.imitation.placement import Candidate, Placement, degrees
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


_PLACES = {"current": "now", "best": "placed", "middle": "at mid-span"}
_LISTED = 6  # candidates of either kind
_WIDTH = 110  # columns


def placement(placement: Placement, written: str | None = None) -> str:
    """The best placement and how to apply it, every measure before and after, the simulations, the other candidates."""
    best, before = placement.best, placement.before
    parts = {name: weight for name, weight in placement.weights.items() if weight}
    measure = (
        " + ".join(f"{weight:g} × {name}" for name, weight in parts.items()) if len(parts) > 1 else next(iter(parts))
    )
    measure += f" of {placement.point}" if placement.point and {"tip", "vibration"} & parts.keys() else ""
    share = f", {placement.fraction:.4f} of the length" if placement.straight else ""
    now = place_words(before.place) if before is not None else f"{1e3 * placement.current:.2f} mm"
    nearest = "" if placement.outcome == "done" else " (nearest to the limits, which none keeps)"
    lines = [
        f"{placement.centrifuge}, tracking {placement.flight}: least {measure}{nearest}",
        f"  control point  {place_words(best.place)} from the root{share} (now {now})",
        f"  largest load   {largest(best.largest_load, None if before is None else before.largest_load)}",
        f"  mounting       {best.mounting}{turned(best.turn)}",
        f"  smoothing      {1e3 * best.smoothing:.4g} ms{_range(placement)}",
    ]
    if placement.changes:
        flags = " ".join(f'--set "{each}"' for each in placement.settings)
        lines.append(f"  to apply it    {flags}")
        lines.append(f"                 {f'written to {written}' if written else 'or place again with --write'}")
    lines += warning_lines(placement)
    if placement.message and placement.outcome == "done":
        lines += ["", *textwrap.wrap(sentence(placement.message), _WIDTH)]
    return "\n".join([*lines, *_measures(placement), *_verified(placement), *_candidates(placement, measure)])


def largest(load: PeakPair, before: PeakPair | None) -> str:
    """Largest load anywhere on the specimen as placed, in flight, and as it is mounted now."""
    if not math.isfinite(load.machine):
        return "not known"
    now = "" if before is None else f"; now {_load(before)}"
    return f"anywhere on the specimen {_load(load)}, {in_g(load.flight)} in flight{now}"


def _load(load: PeakPair) -> str:
    place = f" at {load.place_machine}" if load.place_machine else ""
    return f"{in_g(load.machine)}{place} ({change(load.ratio)})"


def _measures(placement: Placement) -> list[str]:
    """Every measure at every place: the mismatch field alone, and with the load's own error at the control point."""
    lines = ["", "Of flight's peak".ljust(19) + "".join(each.ljust(39) for each in ("mismatch field", "with tracking"))]
    lines.append(" " * 19 + 2 * "".join(place.ljust(13) for place in places_of(straight=placement.straight).values()))
    for name in placement.values["best"]:
        rows = (placement.values, placement.totals)
        cells = [of_peak(each[place][name]) if each else "–" for each in rows for place in _PLACES]
        lines.append(f"  {name:<17}" + "".join(cell.ljust(13) for cell in cells))
    return [line.rstrip() for line in lines]


def places_of(*, straight: bool) -> dict[str, str]:
    """Names of the compared places, of a straight specimen or of one in space."""
    return _PLACES if straight else _PLACES | {"middle": "mid-way"}


def of_peak(share: float) -> str:
    """A share of flight's peak, in words."""
    return f"{100 * share:.3g} %" if share > 1e-8 else "0 %"  # below, it is rounding


def place_words(place: Sequence[float]) -> str:
    """A control point (3,) m, along x or anywhere, in words."""
    words = [f"{1e3 * each:.2f}" for each in place]
    return f"({', '.join(words)}) mm" if any(place[1:]) else f"{words[0]} mm"


def turned(turn: Sequence[float]) -> str:
    """A rotation vector (3,) rad in words; empty where there is none."""
    return f", turned by {degrees(turn)}" if any(turn) else ""


def _range(placement: Placement) -> str:
    """Range that was searched, and whether the best lies at its end."""
    low, high = placement.widths
    if low == high:
        return ""
    searched = f", of {1e3 * low:.4g} to {1e3 * high:.4g} ms"
    if placement.best.smoothing > low * (1 + 1e-6):
        return searched + (": the widest tried" if placement.best.smoothing > high * (1 - 1e-6) else "")
    unlimited = "; no limit of the machine forbids less" if placement.best.share < 1 else ""
    return f"{searched}: the least tried{unlimited}"


def _verified(placement: Placement) -> list[str]:
    if not placement.verifications:
        return []
    checks = placement.checks
    lines = [
        "",
        "By simulation, largest difference from flight",
        " " * 19 + f"tip          vibration    root {'shear' if placement.straight else 'force'}   moment",
    ]
    for place, label in places_of(straight=placement.straight).items():
        check = checks[place]
        values = (
            (f"{1e3 * check.tip_difference:.4g}", "mm"),
            (f"{1e3 * check.vibration:.3g}", "mm"),
            (f"{check.force_difference:.3g}", "N"),
            (f"{check.moment_difference:.3g}", "N m"),
        )
        words = ("–" if value == "nan" else f"{value} {unit}" for value, unit in values)
        lines.append(f"  {label:<17}" + "".join(word.ljust(13) for word in words).rstrip())
    gain = placement.vibration_gain
    if math.isnan(gain):
        return lines
    middle = "at mid-span" if placement.straight else "in the middle of the specimen"
    return [*lines, f"  {gain:.3g} times less vibration than with the control point {middle}"]


def _candidates(placement: Placement, measure: str) -> list[str]:
    kept = [candidate for candidate in placement.options if not candidate.exceeded]
    broken = [candidate for candidate in placement.options if candidate.exceeded]
    listed = [*kept[:_LISTED], *broken[:_LISTED]]
    lines = ["", f"Options by {measure} with what smoothing and tracking change of the load, best first"]
    lines += [_candidate(candidate) for candidate in listed]
    more = len(placement.options) - len(listed)
    lines += [f"  and {more} more: see --json"] if more else []
    return [*lines, *(f"  cannot: {reason}" for reason in placement.refused)]


def _candidate(candidate: Candidate) -> str:
    words = f"  {candidate.mounting}{turned(candidate.turn)}, {1e3 * candidate.smoothing:.4g} ms: "
    words += f"{100 * candidate.total_error:.3g} % at {place_words(candidate.place)}; "
    if candidate.exceeded:
        worst, others = max(candidate.exceeded, key=lambda use: use.share), len(candidate.exceeded) - 1
        return words + f"exceeds {worst}" + (f" and {others} more" if others else "")
    if math.isfinite(candidate.largest_load.machine):
        words += f"largest load {_load(candidate.largest_load)}; "
    peaks = ", ".join(f"{acceleration:.3g}" for acceleration in candidate.accelerations)
    share = f", {candidate.share:.0%} of a limit" if candidate.share else ""
    return words + f"axis accelerations {peaks} rad/s²{share}"
