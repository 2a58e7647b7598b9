"""Figures of a case, named by the end of their path in a verb's JSON, with their units; and histories over time."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.errors import InputError
from gbeam.results.declared import units_of
from gbeam.results.equilibrium import Deflection
from gbeam.results.result import Floats
from gbeam.scenario.schema import Centrifuge
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.values.paths import advise, closest, path_text
from gbeam.studies.answers import DECLARED, Facts

if TYPE_CHECKING:
    from gbeam.results.study import Study


OPTION = "--measure"
Keys = tuple[str | int, ...]
_MANY = 12  # figures that a message lists


def find(facts: Facts, name: str) -> Keys:
    """Return the keys of the figure whose path in the facts of a case ends in `name`, such as ``tip.z.max_abs``."""
    every = {path_text(keys): keys for keys, _ in _figures(facts)}
    wanted = f".{name}"
    fits = [path for path in every if f".{path}".endswith(wanted)]
    if not fits:
        ends = {path[at:] for path in every for at in _starts(path)}
        near = closest(name, sorted(ends, key=lambda end: (abs(end.count(".") - name.count(".")), end)))
        fix = f"did you mean {near!r}?" if near else "take one from what the verb prints with --json"
        if name.endswith("verdict.accepted"):
            fix = "a verdict is accepted or not by limits: set them in [motion.NAME.accept]"
        raise InputError(OPTION, f"{name!r} is no figure of this", fix)
    if len(fits) > 1 and name not in fits:
        shown = ", ".join(fits[:_MANY]) + (", …" if len(fits) > _MANY else "")
        raise InputError(OPTION, f"{name!r} could be any of {len(fits)} figures", f"name one of {shown}")
    return every[name if name in fits else fits[0]]


def usual(scenario: Scenario, verb: str) -> tuple[str, ...]:
    """Figures of ``run`` that are meant where none is named: of every motion the largest of tip and root moment."""
    if verb != "run":
        return ()
    ends = ("tip.size.max_abs", "loads.root_moment.size.max_abs")
    return tuple(f"motions.{name}.{end}" for name in scenario.motion for end in ends)


def judged(scenario: Scenario, verb: str) -> tuple[str, ...]:
    """Further ones, of every centrifuge: the share of the flight that is followed, and whether limits accept it."""
    machines = {name: each for name, each in scenario.motion.items() if isinstance(each, Centrifuge) and each.tracks}
    limited = [name for name, each in machines.items() if each.limits_of_acceptance]
    figures = [f"comparisons.{name}.verdict.followed" for name in machines]
    return tuple(figures + [f"comparisons.{name}.verdict.accepted" for name in limited]) if verb == "run" else ()


def value_at(facts: Facts, keys: Keys) -> float:
    """The figure there; NaN where this case has none."""
    node: Any = facts
    for key in keys:
        try:
            node = node[key]
        except (KeyError, IndexError, TypeError):
            return math.nan
    return float(node) if _is_figure(node) else math.nan


def is_truth(facts: Facts, keys: Keys) -> bool:
    """Whether the figure there is true or false."""
    node: Any = facts
    for key in keys:
        node = node[key]
    return isinstance(node, bool)


def unit_at(facts: Facts, keys: Keys) -> str:
    """SI unit of the figure there; empty where it has none."""
    return declared(facts, keys) or ""


def own_keys(keys: Keys) -> Keys:
    """Keys of a figure without the name of a motion, which the scenario chose."""
    return keys[:1] + keys[2:] if keys[0] in ("motions", "comparisons") else keys


def _figures(node: Any, keys: Keys = ()) -> Iterator[tuple[Keys, float]]:
    """Every number in the facts, with its keys."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _figures(value, (*keys, str(key)))
    elif isinstance(node, (list, tuple)):
        for index, value in enumerate(node):
            yield from _figures(value, (*keys, index))
    elif _is_figure(node) or node is None:
        yield keys, node


def _is_figure(value: Any) -> bool:
    # A truth is a figure too: 1 where accepted.
    return isinstance(value, (int, float)) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0)


def _starts(path: str) -> list[int]:
    return [0, *(match.end() for match in re.finditer(r"\.", path))]


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
    tree: Any = facts.get(DECLARED, _FIGURES)
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


HISTORY = "--history"
TIMES = 501  # by default
UNITS = {"tip": "m", "root_force": "N", "root_moment": "N m"}


@dataclass(frozen=True)
class History:
    """One component over time: of `quantity` along `axis` (0, 1, 2) of base axes, in the motion of that name."""

    name: str
    motion: str
    quantity: str
    axis: int

    @property
    def unit(self) -> str:
        """SI."""
        return UNITS[self.quantity]

    def at(self, study: Study, times: Floats) -> Floats:
        """Values at times (t,); NaN where the response has none."""
        response = study.responses.get(self.motion)
        nothing = np.full(len(times), math.nan)
        if response is None:
            return nothing
        loads = response.loads
        if self.quantity == "tip":
            values = response.tip
        elif loads is None:
            return nothing
        else:
            values = (loads.force if self.quantity == "root_force" else loads.moment)[:, 0]
        from scipy.interpolate import CubicSpline

        # Twenty steps to the shortest period: straight lines between them would be off by 1 % of a vibration.
        spline = CubicSpline(response.time, values[:, self.axis])
        slack = 1e-9 * float(response.time[-1] - response.time[0])
        inside = (times >= response.time[0] - slack) & (times <= response.time[-1] + slack)
        return np.where(inside, spline(times), math.nan)


def read_history(text: str, motions: Collection[str]) -> History:
    """Read ``flight.tip.z``; the motion may be left out where there is one."""
    *before, quantity, axis = ["", "", *text.split(".")]
    motion = ".".join(part for part in before if part)
    if axis not in ("x", "y", "z") or quantity not in UNITS:
        raise InputError(HISTORY, f"{text!r} is no history", f"write MOTION.QUANTITY.AXIS of {', '.join(UNITS)}")
    if not motion:
        if len(motions) > 1:
            raise InputError(HISTORY, f"{text!r} leaves the motion out", f"write {next(iter(motions))}.{text}")
        motion = next(iter(motions))
    if motion not in motions:
        raise InputError(HISTORY, f"{text!r} names no motion", advise(motion, motions))
    return History(text, motion, quantity, "xyz".index(axis))
