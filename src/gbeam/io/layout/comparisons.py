"""What a file holds of a comparison of flight and centrifuge."""

from __future__ import annotations

from collections.abc import Mapping

from gbeam.io.groups import AXIS, Group, Variable, coordinate, flags, known, variable, words
from gbeam.results.imitation.accounting import Accounting, PeakPair
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.fatigue import Fatigue
from gbeam.results.imitation.measures import RootHistory, Shock, Statistics

_A, _TA = ("axis",), ("time", "axis")
_SECTION_AXES = "S: axes of the deformed root section"
_LARGEST = {
    "tip": ("m", "displacement of the tip"),
    "root_force": ("N", "force at the root"),
    "root_moment": ("N m", "moment at the root"),
    "stress": ("Pa", "normal stress"),
}


def comparison_group(comparison: Comparison) -> Group:
    """Return what a file holds of a comparison."""
    v, flight, centrifuge = variable, comparison.flight, comparison.centrifuge
    across = "over the times at which the target was not held"
    data = {
        "difference": v(_TA, comparison.difference, "m", f"tip displacement, {centrifuge} less {flight}"),
        "covered": flags(("time",), comparison.covered, "whether the time is compared", "held", "compared"),
        "max_difference": v(_A, comparison.max_difference, "m", f"largest difference {across}"),
        "rms_difference": v(_A, comparison.rms_difference, "m", f"root mean square difference {across}"),
        "peak_flight": v(_A, comparison.peak_flight, "m", f"largest displacement in {flight} {across}"),
        "peak_centrifuge": v(_A, comparison.peak_centrifuge, "m", f"largest displacement on {centrifuge} {across}"),
    }
    coordinates = coordinate("time", comparison.time, "s", "time") | AXIS
    if comparison.stations is not None:
        data |= _statistics(comparison, comparison.stations)
        where = comparison.stations.stations
        coordinates |= coordinate("station", where, "m", "position along the beam from the root")
    if comparison.mismatch is not None:
        data["mismatch_gradient"] = v(
            _TA, comparison.mismatch.gradient, "s-2", "mismatch acceleration per distance from the control point"
        )
    if comparison.root is not None:
        data |= _root(comparison.root.history)
    if comparison.shock is not None:
        data |= _shock(comparison.shock)
        coordinates |= coordinate("frequency", comparison.shock.frequency, "Hz", "frequency of the oscillators")
    if comparison.fatigue is not None:
        data |= _fatigue(comparison.fatigue)
    data |= _whole_flight(comparison.peaks) | _accounting(comparison.accounting)
    accepted = {None: "", True: "true", False: "false"}[comparison.accepted]
    attrs = {"flight": flight, "centrifuge": centrifuge, "verdict": comparison.verdict, "accepted": accepted}
    return Group(known(data), coordinates, attrs)


def _fatigue(fatigue: Fatigue) -> dict[str, Variable]:
    exponent = {"exponent": fatigue.exponent}
    data = {"damage_ratio": variable((), fatigue.damage_ratio, "1", "damage of the machine over flight's", **exponent)}
    for place in ("flight", "machine"):
        cycles, dims = getattr(fatigue, place), (f"cycle_{place}",)
        if not cycles.total:  # netCDF takes a dimension of length zero for an unlimited one
            continue
        data[f"stress_range_{place}"] = variable(dims, cycles.range, "Pa", f"range of the root's stress cycle, {place}")
        data[f"stress_mean_{place}"] = variable(dims, cycles.mean, "Pa", "its mean")
        data[f"stress_count_{place}"] = variable(dims, cycles.count, "1", "1 of a full cycle, 0.5 of a half")
    return data


def _whole_flight(peaks: Mapping[str, PeakPair]) -> dict[str, Variable]:
    data = {}
    for name, pair in peaks.items():
        unit, what = _LARGEST[name]
        for place in ("flight", "machine"):
            data[f"{name}_{place}"] = variable((), getattr(pair, place), unit, f"largest {what}, {place}")
            data[f"{name}_time_{place}"] = variable((), getattr(pair, f"time_{place}"), "s", f"when that is, {place}")
    return data


def _accounting(accounting: Accounting) -> dict[str, Variable]:
    v = variable
    data = {
        "tolerance_load": v((), accounting.allowed, "m s-2", "error of the load that counts as following"),
        "followed_share": v((), accounting.followed_share, "1", "share of the flight's time that is followed"),
    }
    if accounting.peaks:  # netCDF takes a dimension of length zero for an unlimited one
        p, rows = ("load_peak",), accounting.peaks
        data |= {
            "load_peak_time": v(p, [each.time for each in rows], "s", "peak of the flight's load above idle"),
            "load_peak_flight": v(p, [each.load for each in rows], "m s-2", "its size"),
            "load_peak_machine": v(p, [each.reproduced for each in rows], "m s-2", "what the machine makes of it"),
            "load_peak_error": v(p, [each.error for each in rows], "1", "difference as vectors over its size"),
            "load_peak_spread": v(
                ("load_peak", "end"), [each.spread for each in rows], "1", "load at root and tip over that, less one"
            ),
            "load_peak_reason": words(p, [each.reason for each in rows], "why it is not reproduced; empty where it is"),
        }
    if accounting.not_followed:
        n, runs = ("not_followed",), accounting.not_followed
        data |= {
            "not_followed_from": v(n, [each.start for each in runs], "s", "start of a stretch that is not followed"),
            "not_followed_to": v(n, [each.end for each in runs], "s", "its end"),
            "not_followed_reason": words(n, [each.reason for each in runs], "why it is not followed"),
            "not_followed_peak": v(n, [each.flight_peak for each in runs], "m s-2", "largest load of the flight in it"),
        }
    return data


def _statistics(comparison: Comparison, parts: Statistics) -> dict[str, Variable]:
    how = f"Butterworth 4th order, zero phase, {parts.cutoff:.6g} Hz"
    data = {}
    for place, name in (("flight", comparison.flight), ("centrifuge", comparison.centrifuge)):
        for part, side in (("trend", "below"), ("vibration", "above")):
            values = getattr(parts, f"{part}_{place}")
            long_name = f"tip displacement in {name} {side} the cut-off"
            data[f"{part}_{place}"] = variable(_TA, values, "m", long_name, method=how)
    kinds = {"peak": "largest", "rms": "root mean square", "residual": "residual vibration"}
    for place in ("flight", "centrifuge", "difference"):
        for kind, long_name in kinds.items():
            values = getattr(getattr(parts, place), kind)
            data[f"station_{kind}_{place}"] = variable(
                ("station", "axis"), values, "m", f"{long_name} displacement, {place}"
            )
    return data


def _root(history: RootHistory) -> dict[str, Variable]:
    data = {}
    for place in ("flight", "centrifuge"):
        for kind, unit, long_name in (
            ("force", "N", "axial force and shear at the root"),
            ("moment", "N m", "torque and bending moments at the root"),
        ):
            values = getattr(history, f"{kind}_{place}")
            data[f"root_{kind}_{place}"] = variable(_TA, values, unit, f"{long_name}, {place}", frame=_SECTION_AXES)
    return data


def _shock(shock: Shock) -> dict[str, Variable]:
    name = f"shock response spectrum of the tip, Q = {shock.quality:g}"
    return {
        f"shock_{place}": variable(("frequency", "axis"), getattr(shock, place), "m s-2", name)
        for place in ("flight", "centrifuge")
    }
