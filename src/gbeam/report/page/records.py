"""Results read back from JSON and the variables of a file, as far as their figures and the viewer need them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any, TypeVar

import numpy as np

from gbeam.figures import Describe, figures_of, of_deflections
from gbeam.report.page.parts import known
from gbeam.results.cases import BOUNDS, ORDERS, Indices, Parameter, Sensitivity, Statistics, Sweep
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.errors import ErrorEstimate, Errors, FrequencyErrors
from gbeam.results.imitation import measures
from gbeam.results.imitation.accounting import Accounting, NotFollowed
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.machine import AxesResult, LimitUse
from gbeam.results.modal import Campbell, Crossing, Modes
from gbeam.results.parts import Loads, Peaks
from gbeam.results.response import BaseMotion, HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.searches import CommandRun, Fit, FittedColumn, Optimum, ShapedCommand
from gbeam.results.study import Study

Facts = Mapping[str, Any]
_NONE = np.empty(0)
_R = TypeVar("_R")
_ERRORS = ("displacement", "loads", "stress")


def figures_in(kind: str, facts: Facts, variables: Facts) -> dict[str, Describe]:
    """Return what describes the figures of a result of a kind, from its JSON and, of histories, its variables."""
    match kind:
        case "run":
            study = _study(facts, variables)
            return figures_of(study) if study.responses else {}
        case "plan":
            return of_plans(_plans(facts, variables))
        case "static":
            return of_deflections([_deflection(name, each) for name, each in facts["motions"].items()])
        case "fit" | "optimize" | "shape":
            needed, read = _SEARCHES[kind]
            return figures_of(read(facts, variables)) if needed in variables else {}
        case "sweep":
            return figures_of(_sweep(facts, variables))
    return figures_of(_ALONE[kind](facts)) if kind in _ALONE else {}


def of_plans(plans: Mapping[str, MachinePlan]) -> dict[str, Describe]:
    """Return what describes the figures of several machines' plans, by name."""
    every = {name: figures_of(plan) for name, plan in plans.items()}
    return {f"{what} {name}": each for name, figures in every.items() for what, each in figures.items()}


def _partly(kind: type[_R], facts: Facts, /, *same: str, **more: Any) -> _R:
    """A record with the facts of the `same` names and what is given; the rest, which no figure reads, is empty."""
    values = {name: facts[name] for name in same} | more
    needed = [each for each in fields(kind) if each.default is MISSING and each.default_factory is MISSING]  # type: ignore[arg-type]
    return kind(**{each.name: _NONE for each in needed if each.name not in values}, **values)


def _under(place: str, variables: Facts) -> dict[str, Any]:
    return {name.removeprefix(place): each for name, each in variables.items() if name.startswith(place)}


def _array(values: Any) -> Floats:
    """Numbers of JSON, NaN for null."""
    return np.array(values, dtype=float)


def _column(rows: Any, key: str) -> Floats:
    return _array([each.get(key) for each in rows])


def _words(rows: Any, key: str) -> tuple[str, ...]:
    return tuple(each[key] for each in rows)


def _vectors(values: Facts) -> Floats:
    return np.stack([_array(values[axis]) for axis in "xyz"], axis=-1)


def _errors(facts: Facts) -> Errors:
    totals = {of: ErrorEstimate(total=known(facts["errors"][of]["total"])) for of in _ERRORS}
    return _partly(Errors, {}, **totals)


def _study(facts: Facts, variables: Facts) -> Study:
    responses = {}
    for name, each in facts["motions"].items():
        v = _under(f"motions/{name}/", variables)
        if "environment" in each and "time" in v:
            responses[name] = _response(name, each, v)
    comparisons = []
    for each in facts["comparisons"]:
        v = _under(f"comparisons/{each['centrifuge']}/", variables)
        if "time" in v and each["flight"] in responses:
            comparisons.append(_comparison(each, v, float(responses[each["flight"]].stations[-1])))
    return Study("", responses, tuple(comparisons))


def _response(name: str, facts: Facts, v: Facts) -> Response:
    hub = None
    if "hub_angle" in v:
        torque = v.get("drive_torque")
        hub = HubResult(v["hub_angle"], v["hub_rate"], v["hub_acceleration"], torque)
    return _partly(
        Response, facts, "environment", "model", "outcome", name=name, time=v["time"], stations=v["station"],
        displacement=v["displacement"],
        base=BaseMotion(v["root_acceleration"], v["angular_velocity"], v["angular_acceleration"]),
        peaks=_partly(Peaks, {}, max_abs=_column([facts["tip"][axis] for axis in "xyz"], "max_abs")),
        error_estimate=known(facts["error_estimate"]), hub=hub, errors=_errors(facts),
        axes=_axes(facts, v) if "axis_rate" in v else None,
        loads=_loads(facts.get("loads", {}), v, v["section"]) if "section_force" in v else None,
    )  # fmt: skip


def _loads(facts: Facts, v: Facts, stations: Floats) -> Loads:
    unknown = np.full(v["section_force"].shape[:-1], np.nan)
    return _partly(
        Loads, v, "section_force", "section_moment", stations=stations,
        stress_tension=v.get("stress_tension", unknown), stress_compression=v.get("stress_compression", unknown),
        beam_torque=v.get("beam_torque"), drive_torque=v.get("drive_torque"),
        yield_strength=facts.get("yield_strength"),
    )  # fmt: skip


def _axes(facts: Facts, v: Facts) -> AxesResult:
    names = ("axis", "quantity", "unit", "used", "allowed", "time")
    uses = [{name: np.inf if each[name] is None else each[name] for name in names} for each in facts["limits"]]
    return _partly(
        AxesResult, {}, angle=v["axis_angle"], rate=v["axis_rate"], acceleration=v["axis_acceleration"],
        jerk=v.get("axis_jerk"), reference=v["load_reference"], actual=v["load_actual"], idle=float(v["idle"]),
        not_followed=v["not_followed"].astype(bool), limits=tuple(_partly(LimitUse, use, *names) for use in uses),
        episodes=tuple((each["start"], each["end"], each["reason"]) for each in facts["not_followed"]),
        span=(float(v["flight_from"]), float(v["flight_to"])),
    )  # fmt: skip


def _accounting(facts: Facts) -> Accounting:
    runs = [_partly(NotFollowed, each, "start", "end", "reason") for each in facts["accounting"]["not_followed"]]
    return _partly(Accounting, {}, not_followed=tuple(runs))


def _comparison(facts: Facts, v: Facts, length: float) -> Comparison:
    more: dict[str, Any] = {key: _vectors(facts[key]) for key in ("peak_flight", "peak_centrifuge")}
    if "trend_flight" in v:
        names = [f"{part}_{place}" for part in ("trend", "vibration") for place in ("flight", "centrifuge")]
        more["stations"] = _partly(measures.Statistics, v, *names, cutoff=facts["cutoff"])
    if "mismatch_gradient" in v:
        each = facts["mismatch"]
        most = {name: _vectors(each[name]) for name in ("max_gradient", "tip_bound")}
        place = {"control_point": each["control_point"], "length": length}
        more["mismatch"] = _partly(measures.Mismatch, {}, gradient=v["mismatch_gradient"], **place, **most)
    if "root_force_flight" in v:
        names = [f"{kind}_{place}" for kind in ("force", "moment") for place in ("flight", "centrifuge")]
        history = measures.RootHistory(**{name: v[f"root_{name}"] for name in names})
        more["root"] = _partly(measures.RootLoads, {}, history=history)
    if facts.get("shock"):
        spectra = {key: _array(facts["shock"][key]) for key in ("frequency", "flight", "centrifuge")}
        more["shock"] = measures.Shock(facts["shock"]["quality"], **spectra)
    more |= {"time": v["time"], "difference": v["difference"], "covered": v["covered"].astype(bool)}
    return _partly(Comparison, facts, "flight", "centrifuge", accounting=_accounting(facts), **more)


def _plans(facts: Facts, variables: Facts) -> dict[str, MachinePlan]:
    """The machines' plans, by motion."""
    every = {}
    for name, each in facts["motions"].items():
        v = _under(f"motions/{name}/", variables)
        if "time" in v:
            every[name] = _partly(MachinePlan, each, "outcome", name=name, time=v["time"], axes=_axes(each, v))
    return every


def _deflection(name: str, facts: Facts) -> Deflection:
    loads = facts.get("loads")
    if loads is not None:
        v: dict[str, Any] = {key: _vectors(loads[key])[None] for key in ("section_force", "section_moment")}
        v |= {key: _array(loads[key])[None] for key in ("stress_tension", "stress_compression")}
        loads = _loads(loads, v, _array(loads["stations"]))
    return _partly(
        Deflection, facts, "model", "time", motion=name, stations=_array(facts["stations"]),
        displacement=_vectors(facts["displacement"]), loads=loads, errors=_errors(facts),
    )  # fmt: skip


def modes_in(facts: Facts) -> Modes:
    """Modes from their JSON."""
    rows, stations, section = facts["modes"], _array(facts["stations"]), facts.get("section", {})
    ratio, size = _column(rows, "damping_ratio"), 2 * np.pi * _column(rows, "frequency")
    real, imaginary = (
        np.array([_vectors(each[key]) for each in rows]).reshape(-1, len(stations), 3)
        for key in ("shape", "shape_imaginary")
    )
    return _partly(
        Modes, facts, "motion", "model", "time", eigenvalue=size * (-ratio + 1j * np.sqrt(1 - ratio**2)),
        direction=_words(rows, "direction"), stations=stations, shape=real + 1j * imaginary,
        errors=_frequency_errors(rows), width=_array(section.get("width") or []),
        thickness=_array(section.get("thickness") or []), round=bool(section.get("round")),
    )  # fmt: skip


def _frequency_errors(rows: Any) -> FrequencyErrors:
    return _partly(FrequencyErrors, {}, total=_column(rows, "error_estimate"))


def _campbell(facts: Facts) -> Campbell:
    rows, value = facts["tracks"], facts["critical_speed"]
    crossings = [_partly(Crossing, each, "track", "order", "speed", "frequency") for each in facts["crossings"]]
    return _partly(
        Campbell, facts, "motion", "model", speed=_array(facts["speed"]), orders=tuple(facts["orders"]),
        frequency=_array([each["frequency"] for each in rows]).T, direction=_words(rows, "direction"),
        crossings=tuple(crossings), errors=_frequency_errors(rows),
        critical=None if value is None else _partly(Critical, {}, value=value, kind="equilibrium lost"),
    )  # fmt: skip


def _critical_map(facts: Facts) -> CriticalMap:
    speed = _array(facts["critical_speed"])
    arrays = {key: _array(facts[key]) for key in ("mass", "position")}
    return _partly(CriticalMap, facts, "motion", "model", "searched_to", speed=speed, **arrays)


def _sensitivity(facts: Facts) -> Sensitivity:
    every = facts["measures"].values()
    rows = {each["path"]: each for each in next(iter(every))["parameters"]}
    by_path = [{one["path"]: one["derivative"] for one in each["parameters"]} for each in every]
    return _partly(
        Sensitivity, facts, measures=tuple(facts["measures"]), units=_words(every, "unit"),
        figures=_column(every, "value"), parameters=tuple(rows), parameter_units=_words(rows.values(), "unit"),
        values=_column(rows.values(), "value"), derivatives=_array([[one[path] for path in rows] for one in by_path]),
    )  # fmt: skip


def _sweep(facts: Facts, variables: Facts) -> Sweep:
    named = {key: facts.get(key, {}) for key in ("measures", "histories")}
    parameters = [
        Parameter(each["path"], np.array(each["values"]), each["unit"], each["distribution"] or "")
        for each in facts["parameters"]
    ]
    histories = {name: variables.get(f"{name} history") for name in named["histories"]}
    return _partly(
        Sweep, facts, "verb", parameters=tuple(parameters), outcome=np.array(facts["outcomes"], dtype=object),
        measures={name: _array(each["values"]) for name, each in named["measures"].items()},
        units={name: each["unit"] for key in named for name, each in named[key].items()},
        histories={name: each for name, each in histories.items() if each is not None},
        statistics={name: _statistics(each) for name, each in facts["statistics"].items()},
        indices={name: _indices(each) for name, each in facts["indices"].items()},
        time=_array(facts.get("time", [])), title="",
    )  # fmt: skip


def _bounds(facts: Facts) -> Floats:
    """Estimate, low and high along the last dimension."""
    return np.stack([_array(facts[bound]) for bound in BOUNDS], axis=-1)


def _statistics(facts: Facts) -> Statistics:
    names = tuple(name for name in facts if name != "draws")
    values = np.stack([_bounds(facts[name]) for name in names], axis=-2)
    return _partly(Statistics, {}, names=names, values=values)


def _indices(facts: Facts) -> Indices:
    values = np.stack([np.stack([_bounds(each[order]) for order in ORDERS], axis=-2) for each in facts.values()], -3)
    return _partly(Indices, {}, parameters=tuple(facts), values=values)


def _fit(facts: Facts, v: Facts) -> Fit:
    at, rows = "time" if "time" in v else "mode", facts["parameters"]
    columns = [
        _partly(
            FittedColumn, each, "unit", name=name, noise=known(each["noise"]), measured=v["measured"][k],
            fitted=v["fitted"][k], before=v["computed_before"][k],
        )
        for k, (name, each) in enumerate(facts["columns"].items())
    ]  # fmt: skip
    return _partly(
        Fit, {}, title="", parameters=tuple(rows), units=_words(rows.values(), "unit"),
        values=_column(rows.values(), "value"), columns=tuple(columns), at=v[at], modal=at == "mode",
    )  # fmt: skip


def _optimum(facts: Facts, v: Facts) -> Optimum:
    goal, rows = facts["minimise"], facts["parameters"]
    return _partly(
        Optimum, {**facts, **v}, "outcome", "path", "history", title="", minimise=goal["name"], unit=goal["unit"],
        parameters=tuple(rows), units=_words(rows.values(), "unit"), values=_column(rows.values(), "value"),
        bounds=_array(_words(rows.values(), "bounds")), figure_before=known(goal["before"]),
        figure=known(goal["value"]),
    )  # fmt: skip


def _shaped(facts: Facts, v: Facts) -> ShapedCommand:
    ((goal, size),) = facts["goal"].items()
    runs = [
        _partly(
            CommandRun, {}, name=name, command=v["command"][k], by_ratio=v["by_ratio"][k], time=v["run_time"],
            tip=v["tip"][k], residual=known(each["residual_amplitude"]),
        )
        for k, (name, each) in enumerate(facts["commands"].items())
    ]  # fmt: skip
    return _partly(
        ShapedCommand, {**facts, **v}, "kind", "duration", "robust", "design", "check", "time", "ratio", goal=size,
        to_rate=goal == "rate", runs=tuple(runs),
    )  # fmt: skip


_ALONE = {
    "modes": modes_in,
    "campbell": _campbell,
    "critical-speed --masses": _critical_map,
    "sensitivity": _sensitivity,
}
# By verb: a variable without which there are no histories, and what reads the record.
_SEARCHES = {"fit": ("measured", _fit), "optimize": ("history", _optimum), "shape": ("command", _shaped)}
