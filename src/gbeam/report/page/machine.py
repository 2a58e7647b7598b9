"""The inside of pages of a machine: the verdict, its axes, what they use of their limits, the place of the specimen."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gbeam.constants import STANDARD_GRAVITY
from gbeam.figures.description import raised
from gbeam.report.machine import followed, largest, of_peak, place_words, places_of, turned
from gbeam.report.page.parts import Cell, Value, folded, heading, known, listed, paragraph, section, table, verbatim
from gbeam.report.words import number
from gbeam.results.imitation.accounting import PeakPair
from gbeam.results.imitation.criteria import RULES
from gbeam.results.imitation.verdict import change, percent

Facts = Mapping[str, Any]

_QUANTITIES = {
    "largest_load": ("load anywhere on the specimen, g", 1 / STANDARD_GRAVITY),
    "tip": ("tip displacement, mm", 1e3),
    "root_force": ("root force, N", 1.0),
    "root_moment": ("root moment, N m", 1.0),
    "stress": ("stress, MPa", 1e-6),
}


def verdict(judged: Facts, names: tuple[str, str]) -> str:
    """The verdict on an imitation; `names` are those of flight and machine."""
    tables = _criteria(judged), _peaks(judged, names), _load_peaks(judged), _not_followed(judged)
    shown = paragraph(judged["verdict"], "verdict") + f'<div class="gbeam-tables">{"".join(tables)}</div>'
    return shown + folded("In words", listed(judged["lines"]))


def _criteria(judged: Facts) -> str:
    def row(each: Facts) -> list[Value]:
        rule, limit, passed = RULES[each["name"]], each["limit"], each["passed"]
        written = rule.limit_written(tuple(limit) if isinstance(limit, list) else limit).removeprefix("limit ")
        cell = Cell("kept" if passed else "not kept", "good" if passed else "bad")
        return [each["name"].replace("_", " "), rule.written(known(each["value"])), each["where"], written, cell]

    rows = [row(each) for each in judged["criteria"]]
    rows += [[name.replace("_", " "), "–", "", "–", "needs the response: gbeam run"] for name in judged["not_judged"]]
    return table(("limit on", "value", "", "limit", ""), rows, "Accepted if every limit is kept", words=(0, 2, 4))


def _peaks(judged: Facts, names: tuple[str, str]) -> str:
    """Largest sizes over the whole flight, and of the load over all of the machine's run."""
    rows: list[list[Value]] = []
    for key, pair in judged["peaks"].items():
        label, scale = _QUANTITIES[key]
        flight, machine, ratio = (known(pair[name]) for name in ("flight", "machine", "ratio"))
        if math.isfinite(flight):
            where = pair.get("place_machine", "").removeprefix("the ")
            times = pair["time_flight"], pair["time_machine"]
            rows.append([label, scale * flight, scale * machine, _change(ratio), *times, where])
    head, caption = (
        ("largest", *names, "change", "in flight at, s", "on the machine at, s", ""),
        "Largest over the whole",
    )
    return table(head, rows, f"{caption} flight; loads over the machine's whole run", words=(0, 6), optional=(6,))


def _load_peaks(judged: Facts) -> str:
    def row(peak: Facts) -> list[Value]:
        failed = peak["reason"]
        return [
            peak["time"],
            peak["load"] / STANDARD_GRAVITY,
            peak["time_machine"],
            peak["reproduced"] / STANDARD_GRAVITY,
            _change(peak["ratio"]),
            _percent(peak["error"]),
            _percent(peak["instant_error"]),
            Cell(f"not reproduced: {failed}", "bad") if failed else "",
        ]

    head = ("at, s", "flight, g", "at, s", "machine, g", "change", "as a vector", "at the same instant", "")
    rows = map(row, judged["accounting"]["peaks"])
    return table(head, rows, "Peaks of the load at the control point", words=(7,))


def _not_followed(judged: Facts) -> str:
    accounting = judged["accounting"]
    rows = [
        [f"{each['start']:.3f}", f"{each['end']:.3f}", each["flight_peak"] / STANDARD_GRAVITY, each["reason"]]
        for each in accounting["not_followed"]
    ]
    of = "load at the time" if accounting["tolerance_of"] == "instant" else "largest load"
    within = f"within {percent(accounting['tolerance'])} of the {of}"
    head = ("from, s", "to, s", "flight up to, g", "why")
    followed = known(accounting["followed_share"])
    shares = f"{_percent(1 - followed)} of the flight's time ({_percent(followed)} is followed, {within})"
    shown = table(head, rows, f"Not followed: {shares}", words=(3,))
    return shown if len(rows) <= 12 else folded(f"{len(rows)} stretches that are not followed", shown)


def _change(ratio: float | None) -> str:
    return change(known(ratio)) if math.isfinite(known(ratio)) else "–"


def _percent(value: float | None) -> str:
    share = known(value)
    return percent(share if abs(share) > 5e-5 else 0.0) if math.isfinite(share) else "–"


def comparison_body(facts: Facts, viewer: str, drawn: str) -> str:
    """The verdict on a centrifuge's imitation of a flight."""
    return verdict(facts, (facts["flight"], facts["centrifuge"])) + section("Histories", drawn)


def plan_body(facts: Facts, viewer: str, drawn: str) -> str:
    """The verdict, what the axes do, what that uses of the limits, and where the target is held."""
    parts = []
    for name, each in facts["motions"].items():
        if each["outcome"] != "done":
            parts.append(paragraph(f"motion {name} {each['outcome']}: {each['message']}", "bad"))
        parts += [heading("Verdict"), verdict(each, (each["tracks"] or "flight", name))]
        parts.append(machine_section(name, each))
        rows = [[f"{part['start']:.3f}", f"{part['end']:.3f}", part["reason"]] for part in each["not_followed"]]
        held = table(("from, s", "to, s", "why"), rows, "The target is held", words=(2,))
        parts.append(held if len(rows) <= 12 else folded(f"{len(rows)} stretches in which the target is held", held))
        lacks = [f"{part['reason']} at {part['time']:.3f} s: {part['remedy']}" for part in each["shortfalls"]]
        parts.append(listed(lacks[:12], "warning"))
    return "".join([*parts, section("Histories", drawn)])


def machine_section(name: str, motion: Facts) -> str:
    """Use of every limit, and how well the load is followed."""

    def row(use: Facts) -> list[Value]:
        limited = use["allowed"] is not None and math.isfinite(use["allowed"])
        kind = "bad" if use["exceeded"] else ""
        share = Cell(f"{use['share']:.0%}".replace("%", " %"), kind, use["share"]) if limited else "no limit"
        what = f"{use['axis']} {use['quantity']}"
        return [
            what,
            use["used"],
            use["allowed"],
            raised(use["unit"]),
            share,
            f"{use['time']:.3f}" if use["used"] else "–",
        ]

    head = ("", "used", "allowed", "unit", "share", "at, s")
    rows = map(row, motion["limits"])
    return heading(f"Machine: {name}") + table(head, rows, "Limits used", words=(0, 3)) + paragraph(followed(motion))


def placement_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Best place of the specimen, its effect, and the other options."""
    share = facts["fraction_of_length"]
    best = f"{_point(facts)} from the root" + (f", {share:.4f} of the length" if share else "")
    now = _point(facts["before"]) if facts["before"] else f"{1e3 * facts['current_control_point']:.2f} mm"
    rows = [
        ("control point", f"{best} (now {now})"),
        ("largest load", largest(_pair(facts["options"][0]), facts["before"] and _pair(facts["before"]))),
        ("mounting", facts["mounting"] + _turned(facts)),
        ("smoothing", f"{number(1e3 * facts['smoothing'])} ms"),
    ]
    parts = [heading("Placement"), table(("", ""), rows, words=(0, 1))]
    if facts["message"]:
        parts.append(paragraph(facts["message"], "" if facts["outcome"] == "done" else "bad"))
    if facts["set"]:
        flags = " ".join(f'--set "{each}"' for each in facts["set"])
        parts += [paragraph("to apply it, add to the command line:"), verbatim(flags)]
    places = places_of(straight=bool(share))
    for title, key in (("Mismatch field alone", "mismatch"), ("With smoothing and tracking", "total_error")):
        if facts[key]:
            names = list(facts[key]["best"])
            shares = [[name, *(_of_peak(facts[key][place].get(name)) for place in places)] for name in names]
            parts.append(table(("of flight's peak", *places.values()), shares, title))
    if facts["verifications"]:
        checks = [
            [word, *(facts["verifications"][place][key] * scale for key, scale in _CHECKS.values())]
            for place, word in places.items()
            if place in facts["verifications"]
        ]
        parts.append(table(("", *_CHECKS), checks, "By simulation, largest difference from flight"))
    return "".join([*parts, heading("Options"), _options(facts["options"]), listed(facts["refused"])])


_CHECKS = {
    "tip, mm": ("tip_difference", 1e3),
    "vibration, mm": ("vibration", 1e3),
    "root shear, N": ("force_difference", 1.0),
    "root moment, N m": ("moment_difference", 1.0),
}


def _pair(candidate: Facts) -> PeakPair:
    """A candidate's largest load, from its JSON."""
    load = candidate["largest_load"]
    return PeakPair(known(load["flight"]), known(load["machine"]), place_machine=load.get("place_machine", ""))


def _options(options: list[Facts]) -> str:
    def row(each: Facts) -> list[Value]:
        words = "; ".join(map(_use, each["exceeded"]))
        share = f"{100 * each['share']:.0f} % of a limit" if each["share"] else ""
        limits = Cell(f"exceeds {words}", "bad") if words else share
        largest = each["largest_load"]
        load = [known(largest["machine"]) / STANDARD_GRAVITY, largest.get("place_machine", "").removeprefix("the ")]
        mounted = each["mounting"] + _turned(each)
        return [
            mounted,
            1e3 * each["smoothing"],
            _point(each).removesuffix(" mm"),
            _of_peak(each["total_error"]),
            *load,
            limits,
        ]

    head = ("mounting", "smoothing, ms", "control point, mm", "error", "largest load, g", "at", "limits")
    return table(head, map(row, options), "Best first; those that break limits last", words=(0, 5, 6))


def _point(facts: Facts) -> str:
    return place_words([*facts["place"].values()])


def _turned(facts: Facts) -> str:
    return turned([*facts["turn"].values()])


def _use(use: Facts) -> str:
    return f"{use['axis']} {use['quantity']} {number(use['used'])} of {number(use['allowed'])} {use['unit']}"


def _of_peak(share: float | None) -> str:
    return "–" if share is None else of_peak(share)
