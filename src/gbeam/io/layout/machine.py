"""Files of a centrifuge, its plan, and how an imitation is judged."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gbeam.io.groups import AXIS, Group, Variable, coordinate, flags, known, variable, whole_flight, words
from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.criteria import Criterion, Judged
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.machine import AxesResult, LimitUse, Shortfall

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


UNITS = {"rate": "rad s-1", "acceleration": "rad s-2", "jerk": "rad s-3", "power": "W"}
MACHINE_AXIS = coordinate("machine_axis", [1, 2, 3], "1", "axis of the centrifuge")


def plan_group(plan: MachinePlan) -> Group:
    """Return what a file holds of a plan."""
    of_axes = machine_variables(plan.axes)
    # Where the target is held, and where the load is not the flight's, are two things.
    judged = {f"load_{name}" if name in of_axes else name: each for name, each in judged_variables(plan).items()}
    return Group(
        of_axes | judged,
        coordinate("time", plan.time, "s", "time") | AXIS | MACHINE_AXIS,
        {
            "title": plan.title,
            "name": plan.name,
            "tracks": plan.tracks,
            "arm": plan.arm,
            "gravity": plan.gravity,
            "mounting": plan.mounting,
            "outcome": plan.outcome,
            "message": plan.message,
            **judged_attrs(plan),
            "warnings": "\n".join(plan.warnings),
        },
    )


def machine_variables(axes: AxesResult) -> dict[str, Variable]:
    """Variables of a centrifuge over the dimensions time, axis, machine_axis, episode and shortfall."""
    v, t, ta, tm = variable, ("time",), ("time", "axis"), ("time", "machine_axis")
    return {
        "axis_angle": v(tm, axes.angle, "rad", "angle of the centrifuge's axes"),
        "axis_rate": v(tm, axes.rate, "rad s-1", "rate of the centrifuge's axes"),
        "axis_acceleration": v(tm, axes.acceleration, "rad s-2", "acceleration of the centrifuge's axes"),
        **({} if axes.jerk is None else {"axis_jerk": v(tm, axes.jerk, "rad s-3", "jerk of the centrifuge's axes")}),
        "load_reference": v(ta, axes.reference, "m s-2", "load of the target at the control point"),
        "load_actual": v(ta, axes.actual, "m s-2", "load that the axes make at the control point"),
        **({} if axes.flight is None else {"load_flight": v(ta, axes.flight, "m s-2", "load of the flight itself")}),
        "not_followed": flags(
            t, axes.not_followed, "whether the target is held instead of the flight's load", "follows_flight", "held"
        ),
        "idle": v((), axes.idle, "m s-2", "least load that the target is held up to; 0 where there is none"),
        "flight_from": v((), axes.span[0], "s", "first time of the flight, after the spin-up"),
        "flight_to": v((), axes.span[1], "s", "last time of the flight, before the spin-down"),
        "control_point": v((), axes.control_point, "m", "control point, from the root along the beam"),
        **_limits(axes.limits),
        **_episodes(axes.episodes),
        **_shortfalls(axes.shortfalls),
    }


def _limits(uses: tuple[LimitUse, ...]) -> dict[str, Variable]:
    """Used, allowed and when, per quantity: of the three axes, and of the arm its power."""
    made = {}
    for quantity, unit in UNITS.items():
        rows = [use for use in uses if use.quantity == quantity]
        if not rows:
            continue
        whose, dims = ("of the arm", ()) if quantity == "power" else ("of each axis of the machine", ("machine_axis",))
        columns = (np.array([getattr(use, name) for use in rows]) for name in ("used", "allowed", "time"))
        used, allowed, time = (column if dims else column[0] for column in columns)
        limit = f"limit of that {quantity}; infinite where none is given"
        made[f"{quantity}_used"] = variable(dims, used, unit, f"largest {quantity} {whose}, without sign")
        made[f"{quantity}_allowed"] = variable(dims, allowed, unit, limit)
        made[f"{quantity}_time"] = variable(dims, time, "s", f"when the largest {quantity} is used")
    return made


def _episodes(episodes: tuple[tuple[float, float, str], ...]) -> dict[str, Variable]:
    if not episodes:  # netCDF takes a dimension of length zero for an unlimited one
        return {}
    (first, last, reason), e = zip(*episodes, strict=True), ("episode",)
    return {
        "not_followed_from": variable(e, first, "s", "start of a stretch in which the target is held"),
        "not_followed_to": variable(e, last, "s", "its end"),
        "not_followed_reason": words(e, reason, "why it is held"),
    }


def _shortfalls(shortfalls: tuple[Shortfall, ...]) -> dict[str, Variable]:
    """Stretches in which the flight's load cannot be made."""
    if not shortfalls:
        return {}
    s, own = ("shortfall",), "as shortfall_unit says"
    numbers = {
        "from": ("start", "s", "start of a stretch in which the flight's load cannot be made"),
        "to": ("end", "s", "its end"),
        "time": ("time", "s", "when it is worst"),
        "reference": ("reference", own, "load of the flight then"),
        "possible": ("possible", own, "the nearest that the machine can make then"),
    }
    texts = {
        "reason": "why it cannot",
        "unit": "unit of reference and possible",
        "remedy": "smallest change that would help",
    }
    made = {
        f"shortfall_{name}": variable(s, [getattr(each, field) for each in shortfalls], unit, long_name)
        for name, (field, unit, long_name) in numbers.items()
    }
    for name, long_name in texts.items():
        made[f"shortfall_{name}"] = words(s, [getattr(each, name) for each in shortfalls], long_name)
    return made
