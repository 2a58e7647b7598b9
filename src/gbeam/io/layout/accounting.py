"""What a file holds of how an imitation is judged: what is accepted, largest sizes, every part of the flight."""

from __future__ import annotations

from collections.abc import Mapping

from gbeam.io.groups import Variable, known, variable, whole_flight, words
from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Criterion, Judged

_LARGEST = {
    "largest_load": ("m s-2", "load of the base anywhere on the specimen; of the machine over all of its run"),
    "tip": ("m", "displacement of the tip"),
    "root_force": ("N", "force at the root"),
    "root_moment": ("N m", "moment at the root"),
    "stress": ("Pa", "normal stress"),
}


def judged_attrs(judged: Judged) -> dict[str, str]:
    """The sentence, and whether every limit is kept: true, false, or empty where there is none."""
    return {"verdict": judged.verdict, "accepted": {None: "", True: "true", False: "false"}[judged.accepted]}


def judged_variables(judged: Judged) -> dict[str, Variable]:
    """Variables over the dimensions criterion, load_peak and stretch."""
    return known(
        _criteria(judged.criteria) | _largest(judged.peaks) | _accounting(judged.accounting)
        | whole_flight(judged.whole or judged.accounting.span)
    )  # fmt: skip


def _criteria(criteria: tuple[Criterion, ...]) -> dict[str, Variable]:
    if not criteria:  # netCDF takes a dimension of length zero for an unlimited one
        return {}
    c, least_most = ("criterion",), [each.bounds for each in criteria]
    return {
        "criterion_name": words(c, [each.name for each in criteria], "what a limit of acceptance is on"),
        "criterion_value": variable(c, [each.value for each in criteria], "1", "its value"),
        "criterion_where": words(c, [each.where for each in criteria], "where and when that is"),
        "criterion_least_allowed": variable(c, [low for low, _ in least_most], "1", "least value that is accepted"),
        "criterion_most_allowed": variable(
            c, [high for _, high in least_most], "1", "largest value that is accepted; infinite where any is"
        ),
    }


def _largest(peaks: Mapping[str, PeakPair]) -> dict[str, Variable]:
    data = {}
    for name, pair in peaks.items():
        unit, what = _LARGEST[name]
        for place in ("flight", "machine"):
            where = getattr(pair, f"place_{place}")
            at = {"place": where} if where else {}
            data[f"{name}_{place}"] = variable((), getattr(pair, place), unit, f"largest {what}, {place}", **at)
            data[f"{name}_time_{place}"] = variable((), getattr(pair, f"time_{place}"), "s", f"when that is, {place}")
    return data


def _accounting(accounting: Accounting) -> dict[str, Variable]:
    v = variable
    data = {
        "flight_from": v((), accounting.span[0], "s", "first time of the flight that is judged"),
        "flight_to": v((), accounting.span[1], "s", "last time of the flight that is judged"),
        "tolerance_load": v(
            (), accounting.allowed, "m s-2", "error of the load that counts as following", of=accounting.tolerance_of
        ),
        "followed_share": v((), accounting.followed_share, "1", "share of the flight's time that is followed"),
    }  # fmt: skip
    if accounting.peaks:  # netCDF takes a dimension of length zero for an unlimited one
        p, rows = ("load_peak",), accounting.peaks
        data |= {
            "load_peak_time": v(p, [each.time for each in rows], "s", "peak of the flight's load above idle"),
            "load_peak_flight": v(p, [each.load for each in rows], "m s-2", "its size"),
            "load_peak_machine": v(p, [each.reproduced for each in rows], "m s-2", "what the machine makes of it"),
            "load_peak_time_machine": v(p, [each.time_machine for each in rows], "s", "when the machine makes that"),
            "load_peak_error": v(p, [each.error for each in rows], "1", "difference as vectors over its size"),
            "load_peak_instant_error": v(
                p,
                [each.instant_error for each in rows],
                "1",
                "difference at the time of the flight's peak over its size",
            ),
            "load_peak_spread": v(
                ("load_peak", "end"), [each.spread for each in rows], "1", "load at root and tip over that, less one"
            ),
            "load_peak_reason": words(p, [each.reason for each in rows], "why it is not reproduced; empty where it is"),
        }
    if accounting.not_followed:
        n, runs = ("stretch",), accounting.not_followed
        data |= {
            "not_followed_from": v(n, [each.start for each in runs], "s", "start of a stretch that is not followed"),
            "not_followed_to": v(n, [each.end for each in runs], "s", "its end"),
            "not_followed_reason": words(n, [each.reason for each in runs], "why it is not followed"),
            "not_followed_peak": v(n, [each.flight_peak for each in runs], "m s-2", "largest load of the flight in it"),
        }
    return data
