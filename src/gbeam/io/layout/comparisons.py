"""What a file holds of a comparison of flight and centrifuge."""

from __future__ import annotations

from gbeam.io.groups import AXIS, Group, Variable, coordinate, flags, known, variable
from gbeam.io.layout.machine import judged_attrs, judged_variables
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.measures import Fatigue, RootHistory, Shock, Statistics

_A, _TA = ("axis",), ("time", "axis")
_SECTION_AXES = "S: axes of the deformed root section"


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
    data |= judged_variables(comparison)
    return Group(known(data), coordinates, {"flight": flight, "centrifuge": centrifuge, **judged_attrs(comparison)})


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
