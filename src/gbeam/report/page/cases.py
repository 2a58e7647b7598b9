"""The pages of a placement and of a sweep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.machine import largest
from gbeam.report.page.parts import Cell, Value, heading, known, listed, paragraph, section, table, verbatim
from gbeam.report.words import number
from gbeam.results.cases import BOUNDS
from gbeam.results.imitation.accounting import PeakPair

Facts = Mapping[str, Any]
_PLACES = {"current": "now", "best": "placed", "middle": "at mid-span"}
_CASES = 400  # listed


def placement_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Best place of the specimen, its effect, and the other options."""
    best = f"{1e3 * facts['control_point']:.2f} mm from the root, {facts['fraction_of_length']:.4f} of the length"
    now = f"{1e3 * facts['current_control_point']:.2f} mm"
    rows = [
        ("control point", f"{best} (now {now})"),
        ("largest load", largest(_pair(facts["options"][0]), facts["before"] and _pair(facts["before"]))),
        ("mounting", facts["mounting"]),
        ("smoothing", f"{number(1e3 * facts['smoothing'])} ms"),
    ]
    parts = [heading("Placement"), table(("", ""), rows, words=(0, 1))]
    if facts["message"]:
        parts.append(paragraph(facts["message"], "" if facts["outcome"] == "done" else "bad"))
    if facts["set"]:
        flags = " ".join(f'--set "{each}"' for each in facts["set"])
        parts += [paragraph("to apply it, add to the command line:"), verbatim(flags)]
    for title, key in (("Mismatch field alone", "mismatch"), ("With smoothing and tracking", "total_error")):
        if facts[key]:
            names = list(facts[key]["best"])
            shares = [[name, *(_percent(facts[key][place].get(name)) for place in _PLACES)] for name in names]
            parts.append(table(("of flight's peak", *_PLACES.values()), shares, title))
    if facts["verifications"]:
        checks = [
            [word, *(facts["verifications"][place][key] * scale for key, scale in _CHECKS.values())]
            for place, word in _PLACES.items()
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
        point = 1e3 * each["control_point"]
        largest = each["largest_load"]
        load = [known(largest["machine"]) / STANDARD_GRAVITY, largest.get("place_machine", "").removeprefix("the ")]
        return [each["mounting"], 1e3 * each["smoothing"], point, _percent(each["total_error"]), *load, limits]

    head = ("mounting", "smoothing, ms", "control point, mm", "error", "largest load, g", "at", "limits")
    return table(head, map(row, options), "Best first; those that break limits last", words=(0, 5, 6))


def _use(use: Facts) -> str:
    return f"{use['axis']} {use['quantity']} {number(use['used'])} of {number(use['allowed'])} {use['unit']}"


def sweep_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Counts of outcomes, a plot or a map of each measure, and every case."""
    counts = ", ".join(f"{count} {name}" for name, count in facts["counts"].items())
    outcomes = np.array(facts["outcomes"], dtype=object)
    kind = "" if facts["outcome"] == "done" else "bad"
    parts = [paragraph(f"figures of gbeam {facts['verb']}: {outcomes.size} cases: {counts}", kind), _varied(facts)]
    parts += [_estimates(facts)]
    values = {name: np.array(each["values"], dtype=float) for name, each in facts["measures"].items()}
    return "".join(
        [
            *parts,
            section("Figures", drawn),
            heading("Cases"),
            _cases(facts, values, outcomes),
            _failures(facts, outcomes),
        ]
    )


def _estimates(facts: Facts) -> str:
    """Statistics of each measure, where no grid makes many of it, with bounds of 95 % confidence."""
    rows: list[list[Value]] = []
    for name, estimates in facts["statistics"].items():
        if name in facts["measures"] and isinstance(estimates["draws"], int):
            label = _labelled(name, facts["measures"][name]["unit"])
            named = {each: bounds for each, bounds in estimates.items() if each != "draws"}
            rows += [[label, each, *(bounds[bound] for bound in BOUNDS)] for each, bounds in named.items()]
            shares = facts["indices"].get(name, {})
            rows += [
                [label, f"share of the variance, {order}: {path}", *(each[order][bound] for bound in BOUNDS)]
                for path, each in shares.items()
                for order in each
            ]
    return table(("measure", "estimate of", *BOUNDS), rows, "bounds of 95 % confidence", words=(0, 1)) if rows else ""


def _varied(facts: Facts) -> str:
    rows = [
        [each["path"], each["unit"], each["distribution"] or f"{len(each['values'])} values, {_ends(each['values'])}"]
        for each in facts["parameters"]
    ]
    return table(("varies", "unit", "values"), rows, words=(0, 1, 2))


def _cases(facts: Facts, values: Mapping[str, Any], outcomes: Any) -> str:
    parameters, dimensions = facts["parameters"], facts["dimensions"]
    rows: list[list[Value]] = []
    for at in np.ndindex(outcomes.shape):
        place = dict(zip(dimensions, at, strict=True))
        coordinates = [each["values"][place["sample" if each["distribution"] else each["path"]]] for each in parameters]
        done = outcomes[at] == "done"
        figures = [float(each[at]) for each in values.values()]
        rows.append([*map(_tick, coordinates), *figures, Cell(str(outcomes[at]), "" if done else "bad")])
        if len(rows) == _CASES:
            break
    head = [_labelled(each["path"], each["unit"]) for each in parameters]
    head += [_labelled(name, facts["measures"][name]["unit"]) for name in values]
    more = f"the first {_CASES} of {outcomes.size}" if outcomes.size > _CASES else ""
    return table([*head, "outcome"], rows, more, words=(len(head),))


def _failures(facts: Facts, outcomes: Any) -> str:
    messages = np.array(facts["messages"], dtype=object).ravel()
    lost = {f"{outcome}: {said}": None for outcome, said in zip(outcomes.ravel(), messages, strict=True) if said}
    return listed(list(lost)[:10], "bad")


def _labelled(name: str, unit: str) -> str:
    return f"{name}, {unit}" if unit else name


def _tick(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else str(value)


def _ends(values: list[Any]) -> str:
    return f"{_tick(values[0])} to {_tick(values[-1])}" if len(values) > 3 else ", ".join(map(_tick, values))


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.3g} %" if share > 1e-8 else "0 %"
