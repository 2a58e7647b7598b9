"""Reports of a centrifuge: its axes and their limits, tracking of the load, and how well it imitates a flight."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from gbeam.printable import level_words, raised
from gbeam.report.blocks import (
    FIGURES,
    Block,
    Blocks,
    Cell,
    Column,
    Columns,
    Facts,
    Items,
    Section,
    Sentence,
    Value,
    factor,
    name_rows,
    table,
)
from gbeam.report.words import float_of, percent, sentence
from gbeam.results.accounting import QUANTITIES, Accounting, PeakPair, change, in_g, tolerance_words
from gbeam.results.accounting import percent as share_of
from gbeam.results.criteria import GOOD, RULES, STRESS_AT, Judged
from gbeam.results.machine import AxesResult, Driven, Shortfall
from gbeam.results.result import Floats

_EXACT = 1e-9  # of the load: a smaller error is rounding


def tracking_words(driven: Driven) -> str:
    """Words for how well a machine follows the load."""
    errors = {"tracking_error": driven.tracking_error, "flight_error": driven.flight_error}
    return error_words({name: None if error is None else asdict(error) for name, error in errors.items()})


def error_words(facts: Mapping[str, Any]) -> str:
    """Words for the largest error of the load, beside the flight and beside the smoothed target, from
    the JSON of both.
    """
    error, of_flight = facts["tracking_error"], facts.get("flight_error")
    if error["max"] is None or math.isnan(error["max"]):
        return "the target is the flight's load at no time"
    words = f"largest error of the load while it is followed: {_size(of_flight or error)}"
    if of_flight is None or math.isclose(of_flight["max"], error["max"], rel_tol=1e-6, abs_tol=_EXACT):
        return words  # the target does not round it
    return f"{words}; beside the target, which rounds corners: {_size(error)}"


def _size(error: Mapping[str, Any]) -> str:
    """Words for an error of the load, in g and as a share, and its time."""
    if error["fraction"] is not None and error["fraction"] < _EXACT:
        return "none"
    share = math.nan if error["fraction"] is None else error["fraction"]
    return f"{in_g(error['max'])} ({percent(share)}) at {error['time_of_max']:.3f} s"


def ends_line(time: Floats, axes: AxesResult) -> str:
    """Beginning and end of the machine, in words."""
    manner = "turning already" if axes.start == "idle" else "from standstill to standstill"
    return f"{manner}, from {time[0]:.3f} to {time[-1]:.3f} s on the flight's clock"


def not_followed_stretches(axes: AxesResult) -> list[tuple[float, float, str]]:
    """Stretches in which the target is not the flight's load: start, end, s, and reason; overlapping ones joined."""
    joined: list[tuple[float, float, str]] = []
    for start, end, reason in sorted(axes.episodes):
        if joined and start <= joined[-1][1]:
            first, last, reasons = joined[-1]
            all_reasons = reasons if reason in reasons else f"{reasons}, {reason}"
            joined[-1] = first, max(last, end), all_reasons
        else:
            joined.append((start, end, reason))
    return joined


SHORTEST = 0.005  # s, of a stretch that is listed
_APART = 5e-4  # s: two peaks are at different times
_NONE = 5e-5  # a smaller error is none
_MANY = 12  # stretches that a page folds
SHOWN = 8  # peaks and stretches listed; a rough record has hundreds


def judged_lines(judged: Judged) -> Iterator[str]:
    """Yield the limits that are missed, not known and kept, those that are not judged, and then the accounting."""
    part = f" for {judged.part} only" if judged.part else ""
    for heading, passed in (("limits missed", False), ("limits not known", None), ("limits kept", True)):
        criteria = ", ".join(str(criterion) for criterion in judged.criteria if criterion.passed is passed)
        if criteria:
            yield f"{heading}{part}: {criteria}"
    if judged.not_judged:
        yield f"limits that need the response, which `gbeam run` has: {', '.join(judged.not_judged)}"
    yield from accounting_lines(judged.accounting)


def accounting_lines(accounting: Accounting) -> Iterator[str]:
    """Yield lines on load peaks, on the load over the specimen, and on the longest stretches that are not followed.

    There are up to :data:`SHOWN` peaks, in order of time. Those not reproduced are chosen first, then the largest.
    There are as many stretches at most.
    """
    yield f"followed means within {tolerance_words(accounting)}"
    listed = sorted(accounting.peaks, key=lambda peak: (not peak.reason, -peak.load))[:SHOWN]
    for peak in sorted(listed, key=lambda peak: peak.time):
        # Where the size hides a difference of direction, that is said too.
        direction = f", as a vector {share_of(peak.error)}" if peak.error > abs(peak.ratio - 1) + 0.01 else ""
        delay, timing = peak.time_machine - peak.time, ""
        if abs(delay) >= _APART:
            timing = f", {abs(1e3 * delay):.0f} ms {'later' if delay > 0 else 'earlier'}"
        size = f"{in_g(peak.reproduced)} ({change(peak.ratio)}{direction}{timing})"
        if math.isfinite(peak.instant_error):
            size += f", {share_of(peak.instant_error if peak.instant_error > _NONE else 0.0)} off at the same instant"
        words = f"not reproduced, {size}: {peak.reason}" if peak.reason else size
        yield f"load peak {in_g(peak.load)} at {peak.time:.2f} s: {words}"
    if len(accounting.peaks) > SHOWN:
        yield f"load peaks {len(accounting.peaks) - SHOWN} more: see --json"
    if accounting.peaks:
        root, tip = (max((peak.spread[i] for peak in accounting.peaks), key=abs) for i in range(2))
        if math.isfinite(tip):  # of a specimen whose length is known
            yield f"load at these peaks over the control point's: root {change(1 + root)}, tip {change(1 + tip)}"
    # Those below idle are many, and the machine's own lines have them.
    stretches = [
        stretch
        for stretch in accounting.not_followed
        if stretch.reason != "below idle" and stretch.end - stretch.start > SHORTEST
    ]
    longest = sorted(stretches, key=lambda stretch: stretch.start - stretch.end)[:SHOWN]
    for stretch in sorted(longest, key=lambda stretch: stretch.start):
        yield (
            f"not followed {stretch.start:.3f} to {stretch.end:.3f} s: {stretch.reason}, flight's load up to "
            f"{in_g(stretch.flight_peak)}"
        )
    if len(stretches) > SHOWN:
        yield f"not followed {len(stretches) - SHOWN} times more: see --json"
    if accounting.overloads:
        largest = max(accounting.overloads, key=lambda overload: overload.load - max(overload.flight, accounting.idle))
        idle = f", idle {in_g(accounting.idle)}" if accounting.idle else ""
        yield (
            f"the machine loads the specimen more than the flight: {in_g(largest.load)} at {largest.time:.2f} s "
            f"(flight {in_g(largest.flight)}{idle})"
        )


def peak_lines(peaks: Mapping[str, PeakPair]) -> Iterator[str]:
    """Yield a line on the largest root loads and stress over the flight, if any ratio of machine and
    flight is known.
    """
    words = []
    for name in ("root_force", "root_moment", "stress", STRESS_AT):
        pair, (quantity, _, unit) = peaks.get(name, PeakPair()), QUANTITIES[name]
        if math.isfinite(pair.ratio):
            flight, machine = (f"{factor(unit) * value:.4g} {unit}" for value in (pair.flight, pair.machine))
            quantity = quantity.replace("the point", pair.place_flight)
            words.append(f"{quantity} {flight} in flight, {machine} ({change(pair.ratio)})")
    if words:
        yield f"{'; '.join(words)} on the centrifuge"


def machine_plan(facts: Facts) -> Blocks:
    """Plan of every machine: its limits, tracking, stretches that it cannot follow, and the verdict."""
    for name, plan in facts["motions"].items():
        tracks = f", tracks {plan['tracks']}" if plan["tracks"] else ""
        title = f"{name} ({plan['arm']:g} m{tracks}): {plan['state']}"
        tone = "good" if plan["state"] in GOOD else "bad"
        message = (Sentence(plan["message"], "bad"),) if plan["message"] else ()
        yield Section(title, message or (Sentence(""),), titled=True, tone=tone)
        yield Section("Machine", tuple(_plan_blocks(plan)), verbose=True)
        yield from verdict(plan, (level_words(plan["tracks"] or "flight", plan.get("scale")), name))
        yield from verdict_sections(plan)
    yield Section("Histories", (FIGURES,))


def _plan_blocks(plan: Facts) -> Blocks:
    """Limits, tracking, stretches in which the target is not the flight's load, and loads out of reach, of one plan."""
    yield limits(plan)
    yield Sentence(error_words(plan))
    yield departures_table(plan)
    shortfalls = tuple(str(Shortfall(**row)) for row in plan["shortfalls"])
    yield Items(shortfalls[:SHOWN], "warning")
    if len(shortfalls) > SHOWN:
        yield Sentence(f"and {len(shortfalls) - SHOWN} more: see --json")


def limits(machine: Facts) -> Block:
    """Table of the largest use of each limit: its time, and its share of the limit."""

    def share_cell(use: Facts) -> Value:
        if use["allowed"] is None or not math.isfinite(use["allowed"]):
            return "no limit"
        return Cell(f"{use['share']:.0%}".replace("%", " %"), "bad" if use["exceeded"] else "", use["share"])

    cells: Columns = {
        "machine": lambda use: f"{use['axis']} {use['quantity']}",
        "used": "used",
        "allowed": "allowed",
        "share": share_cell,
        "at, s": lambda use: f"{use['time']:.3f}" if use["used"] else "–",
        "unit": lambda use: raised(use["unit"]),
    }
    return table(machine["limits"], cells, "Limits used")


def departures_table(machine: Facts) -> Block:
    """Table of the stretches in which the target is not the flight's load, and why."""
    cells = {"from, s": "start:.3f", "to, s": "end:.3f", "why": "reason"}
    return table(
        machine["not_followed"], cells, "The target is not the flight's load", most=SHOWN, detail="lines" not in machine
    )


def comparison(facts: Facts) -> Blocks:
    """Verdict on the imitation of a flight, the sentences that it rests on, and the figures."""
    yield from verdict(facts, (level_words(facts["flight"], facts.get("scale")), facts["centrifuge"]))
    yield from verdict_sections(facts)
    yield Section("Histories", (FIGURES,))


def verdict(judged: Facts, names: tuple[str, str], title: str = "Verdict") -> Blocks:
    """Section for a page, of the verdict on an imitation and its tables. `names` are those of flight and machine."""
    tables = _criteria(judged), _peaks(judged, names), _load_peaks(judged), _missed_stretches(judged)
    yield Section(
        title, (Sentence(judged["verdict"], "verdict"), Items(tuple(judged["findings"])), *tables), detail=True
    )


def verdict_sections(judged: Facts, name: str = "") -> Blocks:
    """Sections of the verdict, with a `name` in front where there are several, and of what it rests on."""
    passed = all(criterion["passed"] for criterion in judged["criteria"])
    tone = "verdict" if passed else "bad"
    title = f"{name}: {judged['verdict']}" if name else sentence(judged["verdict"])
    yield Section(title, (Items(tuple(judged["findings"])),), titled=True, folded="Verdict in words", tone=tone)
    lines = (Items(tuple(judged["lines"])),)
    yield Section("What the verdict rests on", lines, titled=True, folded="In detail", verbose=True)


def _criteria(judged: Facts) -> Block:
    """Table of the limits of acceptance with their values, and of the limits that need a response."""

    def limit(criterion: Facts) -> Value:
        if "limit" not in criterion:
            return None
        bounds = tuple(criterion["limit"]) if isinstance(criterion["limit"], list) else criterion["limit"]
        return RULES[criterion["name"]].limit_written(bounds).removeprefix("limit ")

    def verdict(criterion: Facts) -> Value:
        if "limit" not in criterion:
            return "needs the response: gbeam run"
        words = {True: ("kept", "good"), False: ("not kept", "bad"), None: ("not known", "bad")}
        return Cell(*words[criterion["passed"]])

    cells: Columns = {
        "limit on": lambda criterion: criterion["name"].replace("_", " "),
        "value": lambda criterion: (
            RULES[criterion["name"]].write(float_of(criterion["value"])) if "limit" in criterion else None
        ),
        "where": "where",
        "limit": limit,
        "": verdict,
    }
    rows = [*judged["criteria"], *({"name": name} for name in judged["not_judged"])]
    return table(rows, cells, "Accepted if every limit is kept", optional=("where",))


def _peaks(judged: Facts, names: tuple[str, str]) -> Block:
    """Table of the largest sizes in flight and on the machine, over the flight. Loads are over the
    machine's whole run.
    """

    def size(key: str) -> Column:
        return lambda pair: factor(QUANTITIES[pair["name"]][2]) * float_of(pair[key])

    cells: Columns = {
        "largest": lambda pair: "{}, {}".format(*QUANTITIES[pair["name"]][::2]),
        names[0]: size("flight"),
        names[1]: size("machine"),
        "change": _changed,
        "in flight at, s": "time_flight",
        "on the machine at, s": "time_machine",
        "where": lambda pair: pair.get("place_machine", "").removeprefix("the "),
    }
    rows = [pair for pair in name_rows(judged["peaks"]) if pair["flight"] is not None]
    caption = "Largest over the whole flight; loads over the machine's whole run"
    return table(rows, cells, caption, optional=("where",))


def _load_peaks(judged: Facts) -> Block:
    """Table of the peaks of the flight's load, with the machine's load at each."""
    cells: Columns = {
        "at, s": "time",
        "flight, g": "load",
        "at, s ": "time_machine",
        "machine, g": "reproduced",
        "change": _changed,
        "as a vector": lambda peak: _percent(peak["error"]),
        "at the same instant": lambda peak: _percent(peak["instant_error"]),
        "": lambda peak: Cell(f"not reproduced: {peak['reason']}", "bad") if peak["reason"] else "",
    }
    return table(judged["accounting"]["peaks"], cells, "Peaks of the load at the control point")


def _missed_stretches(judged: Facts) -> Block:
    """Table of the stretches that are not followed. A page folds it if they are many."""
    accounting = judged["accounting"]
    rows, share = accounting["not_followed"], float_of(accounting["followed_share"])
    reference = "load at the time" if accounting["tolerance_of"] == "instant" else "largest load"
    tolerance = f"within {share_of(accounting['tolerance'])} of the {reference}"
    caption = f"Not followed: {_percent(1 - share)} of the flight's time ({_percent(share)} is followed, {tolerance})"
    cells = {"from, s": "start:.3f", "to, s": "end:.3f", "flight up to, g": "flight_peak", "why": "reason"}
    stretches = table(rows, cells, caption)
    title = f"{len(rows)} stretches that are not followed"
    return Section(title, (stretches,), folded=title) if len(rows) > _MANY else stretches


def _changed(pair: Facts) -> Value:
    return change(float_of(pair["ratio"])) if math.isfinite(float_of(pair["ratio"])) else "–"


def _percent(value: float | None) -> str:
    share = float_of(value)
    if not math.isfinite(share):
        return "–"
    return share_of(share if abs(share) > _NONE else 0.0)
