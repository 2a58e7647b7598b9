"""What a result file holds of a centrifuge: its axes, what they use of their limits, where it cannot follow."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.results.response import AxesResult, LimitUse, Shortfall

BASE_AXES = "B: base axes at the root, x along the beam, y along its width, z through its thickness"
UNITS = {"rate": "rad s-1", "acceleration": "rad s-2", "jerk": "rad s-3", "power": "W"}

Variable = tuple[tuple[str, ...], Any, dict[str, Any]]


def variable(dims: tuple[str, ...], values: Any, units: str, long_name: str, **more: Any) -> Variable:
    """Return what xarray makes a variable of."""
    # Numbers of vectors mean nothing without their axes: whatever has an axis has a frame.
    frame = {"frame": BASE_AXES} if "axis" in dims else {}
    return dims, values, {"units": units, "long_name": long_name} | frame | more


def words(dims: tuple[str, ...], values: list[str], long_name: str) -> Variable:
    """Return the same for text."""
    return dims, np.array(values, dtype=object), {"long_name": long_name}


def machine_variables(it: AxesResult) -> dict[str, Variable]:
    """Variables of a centrifuge over the dimensions time, axis, machine_axis, episode and shortfall."""
    v, t, ta, tm = variable, ("time",), ("time", "axis"), ("time", "machine_axis")
    return {
        "axis_angle": v(tm, it.angle, "rad", "angle of the centrifuge's axes"),
        "axis_rate": v(tm, it.rate, "rad s-1", "rate of the centrifuge's axes"),
        "axis_acceleration": v(tm, it.acceleration, "rad s-2", "acceleration of the centrifuge's axes"),
        "load_reference": v(ta, it.reference, "m s-2", "load wanted at the control point"),
        "load_actual": v(ta, it.actual, "m s-2", "load that the axes make at the control point"),
        "not_followed": v(
            t, it.not_followed.astype(np.int8), "1", "whether the target is held instead of the flight's load",
            flag_values=np.array([0, 1], dtype=np.int8), flag_meanings="follows_flight held",
        ),
        "control_point": v((), it.control_point, "m", "control point, from the root along the beam"),
        **_limits(it.limits),
        **_episodes(it.episodes),
        **_shortfalls(it.shortfalls),
    }  # fmt: skip


def _limits(uses: tuple[LimitUse, ...]) -> dict[str, Variable]:
    """Used, allowed and when, per quantity: of the three axes, and of the arm its power."""
    found = {}
    for quantity, unit in UNITS.items():
        rows = [use for use in uses if use.quantity == quantity]
        if not rows:
            continue
        whose, dims = ("of the arm", ()) if quantity == "power" else ("of each axis of the machine", ("machine_axis",))
        columns = (np.array([getattr(use, name) for use in rows]) for name in ("used", "allowed", "time"))
        used, allowed, time = (column if dims else column[0] for column in columns)
        limit = f"limit of that {quantity}; infinite where none is given"
        found[f"{quantity}_used"] = variable(dims, used, unit, f"largest {quantity} {whose}, without sign")
        found[f"{quantity}_allowed"] = variable(dims, allowed, unit, limit)
        found[f"{quantity}_time"] = variable(dims, time, "s", f"when the largest {quantity} is used")
    return found


def _episodes(episodes: tuple[tuple[float, float, str], ...]) -> dict[str, Variable]:
    if not episodes:  # netCDF takes a dimension of length zero for an unlimited one
        return {}
    (first, last, reason), e = zip(*episodes, strict=True), ("episode",)
    return {
        "not_followed_from": variable(e, np.array(first), "s", "start of a stretch in which the target is held"),
        "not_followed_to": variable(e, np.array(last), "s", "its end"),
        "not_followed_reason": words(e, list(reason), "why it is held"),
    }


def _shortfalls(found: tuple[Shortfall, ...]) -> dict[str, Variable]:
    """Stretches in which the flight's load cannot be made."""
    if not found:
        return {}
    s, own = ("shortfall",), "as shortfall_unit says"
    numbers = {
        "from": ("start", "s", "start of a stretch in which the flight's load cannot be made"),
        "to": ("end", "s", "its end"),
        "time": ("time", "s", "when it is worst"),
        "reference": ("reference", own, "what the flight asks for then"),
        "possible": ("possible", own, "the nearest that the machine can make then"),
    }
    texts = {
        "reason": "why it cannot",
        "unit": "unit of reference and possible",
        "remedy": "smallest change that would help",
    }
    return {
        **{f"shortfall_{name}": variable(s, np.array([getattr(it, field) for it in found]), unit, told)
           for name, (field, unit, told) in numbers.items()},
        **{f"shortfall_{name}": words(s, [getattr(it, name) for it in found], told) for name, told in texts.items()},
    }  # fmt: skip
