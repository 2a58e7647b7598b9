"""What a file holds of a centrifuge: its axes, what they use of their limits, where it cannot follow; its plan."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import AXIS, Group, Variable, coordinate, flags, variable, words
from gbeam.io.layout.accounting import judged_attrs, judged_variables
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.machine import AxesResult, LimitUse, Shortfall

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
