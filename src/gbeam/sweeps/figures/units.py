"""The SI unit of every figure, declared at its place in a verb's facts.

The names that a scenario chooses, such as those of its motions, stand under :data:`ANY`: none of them decides a unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gbeam.results.declared import units_of
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.modal import Modes

ANY = "*"  # any key that has no entry of its own
NUMBER = ""  # a share, a ratio, a count, true or false
_NAMED = "unit"  # the unit is the one that the facts name beside the figure

# A text is the unit of all that stands below; that under "" is a figure's that is no mapping. Indices of lists are
# left out.
Tree = Mapping[str, Any]


def _all(unit: str, keys: str) -> Tree:
    return dict.fromkeys(keys.split(), unit)


def _peak(unit: str) -> Tree:
    """Units of the largest size of a history; a deflection, which has no history, is a figure itself."""
    return {"": unit, "max_abs": unit, "residual_amplitude": unit, "time_of_max": "s"}


def _vector(unit: str) -> Tree:
    return {ANY: _peak(unit)}


def _extreme(unit: str) -> Tree:
    return {"": unit, "max": unit, "min": unit, "station": "m", "time_of_max": "s", "time_of_min": "s"}


def _pair(unit: str) -> Tree:
    return {**_all(unit, "flight machine"), "ratio": NUMBER, **_all("s", "time_flight time_machine")}


_USE = {**_all(_NAMED, "used allowed"), **_all(NUMBER, "share exceeded"), "time": "s"}
_STRETCH = _all("s", "start end time")
_SPANS = {"span": _STRETCH, "whole": _STRETCH}
_SECTION = {"at": "m", "force": _vector("N"), "moment": _vector("N m"), **_all("Pa", "tension compression")}
_LOADS = {
    "root_force": _vector("N"),
    "root_moment": _vector("N m"),
    "beam_torque": _peak("N m"),
    "sections": {**_SECTION, "margin": NUMBER},
    "stress": {**_extreme("Pa"), "tension": _extreme("Pa"), "compression": _extreme("Pa")},
    "margin": _extreme(NUMBER),
    **{"stations": "m", "section_force": "N", "section_moment": "N m"},
    **_all("Pa", "yield_strength stress_tension stress_compression"),
}
_LOAD_PEAK = {**_all("s", "time time_machine"), **_all("m/s^2", "load reproduced")}
_ACCOUNTING = {
    "peaks": {**_LOAD_PEAK, **_all(NUMBER, "ratio error instant_error spread spread_flight")},
    "not_followed": {**_STRETCH, "flight_peak": "m/s^2"},
    "preload": {**_STRETCH, **_all("m/s^2", "load flight")},
    **_all("m/s^2", "tolerance_load idle"),
    **_all(NUMBER, "tolerance followed_share not_followed_share"),
}
_PEAKS = {
    "largest_load": _pair("m/s^2"),
    "tip": _pair("m"),
    "root_force": _pair("N"),
    "root_moment": _pair("N m"),
    "stress": _pair("Pa"),
}
_JUDGED = {"peaks": _PEAKS, "accounting": _ACCOUNTING, **_all(NUMBER, "verdict accepted criteria")}
_ERROR = {"max": "m/s^2", "fraction": NUMBER, "time_of_max": "s"}
_MOTION = {
    **_JUDGED,
    **_SPANS,
    **units_of(Deflection),
    "tip": _vector("m"),
    "stations": {"": "m", "at": "m", **_vector("m")},
    "loads": _LOADS,
    "hub": {"angle_end": "rad", **_all("rad/s", "rate_end rate_max")},
    "axes": {ANY: {"rate": _peak("rad/s"), "acceleration": _peak("rad/s^2")}},
    "limits": {ANY: {ANY: _USE}},
    **dict.fromkeys(("tracking_error", "flight_error"), _ERROR),
    "not_followed": _STRETCH,
    "shortfalls": {**_STRETCH, **_all(_NAMED, "reference possible")},
    "histories": {"samples": NUMBER},
    "gravity": "m/s^2",
    **_all("m", "arm control_point"),
    **_all("s", "time step spin_up spin_down"),
    **_all(NUMBER, "error_estimate steps damping_ratio"),
}
_CYCLES = {"cycles": NUMBER, **_all("Pa", "largest_range equivalent_range")}
_MISMATCH = {"max_gradient": "1/s^2", "max_acceleration": "m/s^2", "force_bound": "N", "moment_bound": "N m"}
_COMPARISON = {
    **_JUDGED,
    **_SPANS,
    "mismatch": {**_MISMATCH, **_all("m", "control_point tip_bound")},
    "root": {"force": "N", "moment": "N m", "stress": "Pa"},
    "fatigue": {**_all(NUMBER, "exponent damage_ratio"), "flight": _CYCLES, "machine": _CYCLES},
    "shock": {
        **{"quality": NUMBER, "frequency": "Hz", **_all("m/s^2", "flight centrifuge")},
        "extremes": {"ratio": NUMBER, "frequency": "Hz"},
    },
    "cutoff": "Hz",
    **_all("m", "stations max_difference rms_difference peak_flight peak_centrifuge"),
    **_all(NUMBER, "margin covered relative"),
}
_CANDIDATE = {
    "most_used": _USE,
    "exceeded": _USE,
    "largest_load": _pair("m/s^2"),
    "accelerations": "rad/s^2",
    "control_point": "m",
    "smoothing": "s",
    **_all(NUMBER, "share mismatch total_error tracking"),
}
# Of all verbs: no two have one place for different things.
_FIGURES: Tree = {
    "motions": {ANY: _MOTION},
    "comparisons": {ANY: _COMPARISON},
    **units_of(Modes),
    "options": _CANDIDATE,
    "before": _CANDIDATE,
    **_all("m", "control_point current_control_point"),
    **_all("s", "smoothing smoothing_range"),
    **_all("rad/s", "critical_speed searched_to"),
    **_all(NUMBER, "error_estimate errors"),
    **_all(NUMBER, "measure mismatch total_error fraction_of_length vibration_gain_over_middle"),
}


def declared(facts: Any, keys: tuple[str | int, ...]) -> str | None:
    """Unit of the figure at `keys`, empty where it has none; None where no unit is declared for its place."""
    tree: Any = _FIGURES
    for word in (key for key in keys if isinstance(key, str)):
        tree = tree if isinstance(tree, str) else tree.get(word, tree.get(ANY))
        if tree is None:
            return None
    unit = tree if isinstance(tree, str) else tree.get("")
    if unit != _NAMED:
        return unit
    for key in keys[:-1]:
        facts = facts[key]
    return str(facts[_NAMED])
